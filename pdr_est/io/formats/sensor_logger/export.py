"""The tables of a Sensor Logger export: a folder or zip with a CSV file a sensor, or one JSON file."""

import json
import re
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from pdr_est.errors import RecordingError
from pdr_est.io.text.container import Source
from pdr_est.io.text.number_table import NumberTable, discard_huge_values, read_table

CLOCK_COLUMNS = ("time", "seconds_elapsed")
_JSON_START = re.compile(rb'^\s*\[\s*\{[^{}]*"sensor"\s*:')
_SENSOR_HEADER = frozenset(("time", "x", "y", "z"))


class Export(Protocol):
    """An export, whatever its layout. empty: sensors that are in it without a single row."""

    @property
    def place(self) -> str: ...

    @property
    def sensors(self) -> tuple[str, ...]: ...

    @property
    def empty(self) -> tuple[str, ...]: ...

    def table(self, sensor: str, columns: Sequence[str], texts: Sequence[str] = ()) -> NumberTable | None:
        """The clock columns and the named ones; None for a sensor without rows.

        Raises RecordingError when a column is absent or holds something else than numbers.
        """


@dataclass(frozen=True)
class FolderExport:
    """CSV files in a folder or zip. members: sensor -> member."""

    source: Source
    members: Mapping[str, str]

    @classmethod
    def from_folder(cls, source: Source, folder: str) -> "FolderExport":
        """The CSV files directly in a folder of the source ("" is its top)."""
        inside = [member for member in source.members if member.rpartition("/")[0] == folder]
        return cls(source, {_stem(member): member for member in inside if member.lower().endswith(".csv")})

    @property
    def place(self) -> str:
        return str(self.source.path)

    @property
    def sensors(self) -> tuple[str, ...]:
        return tuple(self.members)

    @property
    def empty(self) -> tuple[str, ...]:
        return tuple(sensor for sensor, member in self.members.items() if not _has_rows(self.source.head(member)))

    def table(self, sensor: str, columns: Sequence[str], texts: Sequence[str] = ()) -> NumberTable | None:
        member = self.members.get(sensor)
        if member is None or not _has_rows(self.source.head(member)):
            return None
        wanted = (*CLOCK_COLUMNS, *columns)
        return read_table(self.source.read(member), self.source.place(member), columns=wanted, text_columns=texts)


@dataclass(frozen=True)
class JsonExport:
    """One JSON array of readings, each with its sensor's name. rows: sensor -> its readings."""

    place: str
    rows: Mapping[str, Sequence[Mapping[str, Any]]]
    empty: tuple[str, ...] = field(default=())

    @classmethod
    def parse(cls, data: bytes, place: str) -> "JsonExport":
        """Raises RecordingError for damaged JSON and for readings without a sensor."""
        try:
            readings = json.loads(data)
        except ValueError as error:
            raise RecordingError(f"{place}: damaged JSON ({error}); export the recording again") from error
        if not isinstance(readings, list):
            raise RecordingError(f"{place}: not a list of readings; export the recording again")
        rows: dict[str, list[Mapping[str, Any]]] = defaultdict(list)
        for number, reading in enumerate(readings, start=1):
            if not isinstance(reading, dict) or not isinstance(reading.get("sensor"), str):
                raise RecordingError(f"{place}, reading {number}: no sensor name; export the recording again")
            rows[reading["sensor"]].append(reading)
        return cls(place, rows)

    @property
    def sensors(self) -> tuple[str, ...]:
        return tuple(self.rows)

    def table(self, sensor: str, columns: Sequence[str], texts: Sequence[str] = ()) -> NumberTable | None:
        if sensor not in self.rows:
            return None
        rows = self.rows[sensor]
        place = f"{self.place}, sensor {sensor}"
        present = [name for name in (*CLOCK_COLUMNS, *columns) if any(name in row for row in rows)]
        parsed: dict[str, NDArray[Any]] = {name: _json_numbers(rows, name, place) for name in present}
        for name in texts:
            parsed[name] = np.array([str(row.get(name, "")) for row in rows])
        return NumberTable(place, parsed)


def looks_like_json(head: bytes) -> bool:
    """Whether a member begins like the JSON export."""
    return _JSON_START.match(head) is not None


def looks_like_sensor(head: bytes) -> bool:
    """Whether a member begins like the CSV file of a three-axis sensor: Unix nanoseconds and x, y, z."""
    lines = head.decode("utf-8", "replace").lstrip("\ufeff").splitlines()
    if not lines:
        return False
    names = [name.strip().strip('"') for name in lines[0].split(",")]
    if not set(names) >= _SENSOR_HEADER:
        return False
    if len(lines) == 1:
        return True
    cells = lines[1].split(",")
    return len(cells) == len(names) and re.fullmatch(r'"?\d{18,19}"?', cells[names.index("time")]) is not None


def _stem(member: str) -> str:
    return member.rpartition("/")[2].rsplit(".", 1)[0]


def _has_rows(head: bytes) -> bool:
    """Whether anything follows the header line."""
    return b"\n" in head.strip()


def _json_numbers(rows: Sequence[Mapping[str, Any]], name: str, place: str) -> NDArray[Any]:
    """A column of numbers written as strings: int64 if all are integers (clocks), else float64 with NaN."""
    cells = [row.get(name) for row in rows]
    texts = ["" if cell is None else str(cell).strip() for cell in cells]
    try:
        return np.array([int(text) for text in texts], dtype=np.int64)
    except (ValueError, OverflowError):
        pass
    try:
        return discard_huge_values(np.array([float(text) if text else np.nan for text in texts]))
    except ValueError:
        number = next(i for i, text in enumerate(texts) if text and not _is_number(text))
        raise RecordingError(
            f"{place}, reading {number + 1}, {name!r}: {texts[number]!r} is not a number; correct or remove it"
        ) from None


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
