"""Read the tables of a Sensor Logger export: a folder or zip with a CSV file for each sensor, or one JSON file."""

import json
import re
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from pdr_est.errors import RecordingError
from pdr_est.io.formats.phone_apps.sensor_logger.sensor_names import KNOWN_SENSORS, sensor_of_name
from pdr_est.io.tables.split.owners import names_owners
from pdr_est.io.text.container import Source
from pdr_est.io.text.finite_values import discard_huge_values
from pdr_est.io.text.members import member_stem
from pdr_est.io.text.number_table import NumberTable, read_table
from pdr_est.io.text.table_layout import detect_header

CLOCK_COLUMN = "time"
_JSON_OWN = re.compile(rb'"seconds_elapsed"|"sensor"\s*:\s*"Metadata"')  # other recorders name sensors, too
_JSON_START = re.compile(rb'^\s*\[\s*\{[^{}]*"sensor"\s*:')
_SENSOR_HEADERS = (frozenset(("time", "x", "y", "z")), frozenset(("time", "rotationRateX", "accelerationX")))
_NO_NUMBER = ("", "null", "None", "nan", "NaN")


class Export(Protocol):
    """Interface of an export, whatever its layout."""

    @property
    def place(self) -> str:
        """Return the name of the export, for messages."""

    @property
    def sensors(self) -> tuple[str, ...]:
        """Return the names of all sensors."""

    @property
    def empty(self) -> tuple[str, ...]:
        """Return the names of the sensors that are in the export without a single row."""

    def titles(self, sensor: str) -> tuple[str, ...]:
        """Return the titles of all columns of a sensor."""

    def table(self, sensor: str, columns: Sequence[str], texts: Sequence[str] = ()) -> NumberTable | None:
        """Read the clock column and the named columns of a sensor, and columns that stay text.

        Returns
        -------
        NumberTable or None
            None for a sensor without rows.

        Raises
        ------
        RecordingError
            When a column is absent or has something else than numbers.
        """


@dataclass(frozen=True)
class FolderExport:
    """Export as CSV files in a folder or zip.

    Attributes
    ----------
    source
        The folder or zip.
    members
        Sensor -> member of the source.
    """

    source: Source
    members: Mapping[str, str]

    @classmethod
    def from_folder(cls, source: Source, folder: str) -> "FolderExport":
        """Collect the CSV files directly in a folder of the source ("" is its top).

        Raises
        ------
        RecordingError
            When two files hold the same sensor.
        """
        inside = [member for member in source.members if member.rpartition("/")[0] == folder]
        found: dict[str, str] = {}
        for member in inside:
            if not member.lower().endswith(".csv"):
                continue
            other = found.setdefault(sensor_of_name(member_stem(member)), member)
            if other != member:
                raise RecordingError(
                    f"{source.path}: {other} and {member} hold the same sensor; "
                    "put each walk into a folder of its own"
                )
        return cls(source, found)

    @property
    def place(self) -> str:
        """Return the path of the export, for messages."""
        return str(self.source.path)

    @property
    def sensors(self) -> tuple[str, ...]:
        """Return the names of all sensors."""
        return tuple(self.members)

    @property
    def empty(self) -> tuple[str, ...]:
        """Return the names of the sensors whose file has no rows."""
        return tuple(sensor for sensor, member in self.members.items() if not _has_rows(self.source.head(member)))

    def titles(self, sensor: str) -> tuple[str, ...]:
        """Return the titles of all columns of a sensor."""
        dialect = detect_header(self.source.head(self.members[sensor]))
        return () if dialect is None else dialect.titles

    def table(self, sensor: str, columns: Sequence[str], texts: Sequence[str] = ()) -> NumberTable | None:
        """Read columns of a sensor (see `Export.table`)."""
        member = self.members.get(sensor)
        if member is None or not _has_rows(self.source.head(member)):
            return None
        wanted = (CLOCK_COLUMN, *columns)
        return read_table(self.source.read(member), self.source.place(member), columns=wanted, text_columns=texts)


@dataclass(frozen=True)
class JsonExport:
    """Export as one JSON array of readings, each with the name of its sensor.

    Attributes
    ----------
    place
        Name of the export, for messages.
    rows
        Sensor -> its readings.
    empty
        Always (): a sensor without readings is not in the array.
    """

    place: str
    rows: Mapping[str, Sequence[Mapping[str, Any]]]
    empty: tuple[str, ...] = field(default=())

    @classmethod
    def parse(cls, data: bytes, place: str) -> "JsonExport":
        """Parse the array.

        Raises
        ------
        RecordingError
            For damaged JSON and for readings without a sensor.
        """
        try:
            readings = json.loads(data)
        except ValueError as error:
            raise RecordingError(f"{place}: damaged JSON ({error}); export the recording again") from error
        if not isinstance(readings, list):
            raise RecordingError(f"{place}: the JSON is not a list of readings; export the recording again")
        rows: dict[str, list[Mapping[str, Any]]] = defaultdict(list)
        for number, reading in enumerate(readings, start=1):
            if not isinstance(reading, dict) or not isinstance(reading.get("sensor"), str):
                raise RecordingError(f"{place}, reading {number} has no sensor name; export the recording again")
            rows[sensor_of_name(reading["sensor"])].append(reading)
        return cls(place, rows)

    @property
    def sensors(self) -> tuple[str, ...]:
        """Return the names of all sensors."""
        return tuple(self.rows)

    def titles(self, sensor: str) -> tuple[str, ...]:
        """Return the names of the values in the first reading of a sensor."""
        return tuple(name for name in self.rows[sensor][0] if name != "sensor")

    def table(self, sensor: str, columns: Sequence[str], texts: Sequence[str] = ()) -> NumberTable | None:
        """Read columns of a sensor (see `Export.table`)."""
        if sensor not in self.rows:
            return None
        rows = self.rows[sensor]
        place = f"{self.place}, sensor {sensor}"
        present = [name for name in (CLOCK_COLUMN, *columns) if any(name in row for row in rows)]
        parsed: dict[str, NDArray[Any]] = {
            name: numbers_of_cells([row.get(name) for row in rows], name, place) for name in present
        }
        for name in texts:
            parsed[name] = np.array([str(row.get(name, "")) for row in rows])
        return NumberTable(place, parsed)


def looks_like_json(head: bytes) -> bool:
    """Tell whether a member begins like the JSON export."""
    return _JSON_START.match(head) is not None and _JSON_OWN.search(head) is not None


def looks_like_sensor(head: bytes, name: str) -> bool:
    """Tell whether a member is the CSV file of a motion sensor of phone or watch, in Unix nanoseconds.

    Many programs write `time,x,y,z`. This app also writes `seconds_elapsed`, which its first versions did not, and
    its files have the names of its sensors.

    Parameters
    ----------
    head
        Beginning of the file.
    name
        Its name without extension.
    """
    lines = head.decode("utf-8", "replace").lstrip("\ufeff").splitlines()
    if not lines:
        return False
    titles = [title.strip().strip('"') for title in lines[0].split(",")]
    if not any(set(titles) >= header for header in _SENSOR_HEADERS) or names_owners(titles):
        return False
    if "seconds_elapsed" not in titles and (len(lines) == 1 or name not in KNOWN_SENSORS):
        return False
    if len(lines) == 1:
        return True
    cells = lines[1].split(",")
    return len(cells) == len(titles) and re.fullmatch(r'"?\d{18,19}"?', cells[titles.index("time")]) is not None


def _has_rows(head: bytes) -> bool:
    """Tell whether anything follows the header line."""
    return b"\n" in head.strip()


def numbers_of_cells(cells: Sequence[Any], name: str, place: str) -> NDArray[Any]:
    """Convert numbers, or numbers written as strings, to int64 if all are integers, else to float64 with NaN.

    Raises
    ------
    RecordingError
        For anything else, naming the reading.
    """
    texts = ["" if cell is None else str(cell).strip() for cell in cells]
    try:
        return np.array([int(text) for text in texts], dtype=np.int64)
    except (ValueError, OverflowError):
        pass
    try:
        return discard_huge_values(np.array([np.nan if text in _NO_NUMBER else float(text) for text in texts]))
    except ValueError:
        number = next(i for i, text in enumerate(texts) if text not in _NO_NUMBER and not _is_number(text))
        raise RecordingError(
            f"{place}, reading {number + 1}, {name!r}: {texts[number]!r} is not a number; correct or remove it"
        ) from None


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
