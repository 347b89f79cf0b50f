"""Read the combined CSV of Sensor Logger: one table with the columns of all sensors, such as `accelerometer_x`."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from pdr_est.io.formats.phone_apps.sensor_logger.export import CLOCK_COLUMN
from pdr_est.io.formats.phone_apps.sensor_logger.sensor_names import MOTION_SENSORS, WATCH_SENSORS, column_of_title
from pdr_est.io.tables.split.owners import names_owners
from pdr_est.io.text.container import Source
from pdr_est.io.text.number_table import NumberTable, read_table
from pdr_est.io.text.table_layout import detect_header

_CLOCK = (CLOCK_COLUMN, "seconds_elapsed")
_UNIX_NS = re.compile(r'"?\d{18,19}(\.0*)?"?')


@dataclass(frozen=True)
class CombinedExport:
    """Export as one table.

    Attributes
    ----------
    source, member
        Source and member of the table.
    columns
        Sensor -> name of a column -> title in the file.
    clock
        Titles of the clock columns that all sensors share, `time` and perhaps `seconds_elapsed`.
    separator
        Character between two cells.
    """

    source: Source
    member: str
    columns: Mapping[str, Mapping[str, str]]
    clock: tuple[str, ...]
    separator: str

    @classmethod
    def open(cls, source: Source, member: str) -> "CombinedExport":
        """Sort the titles of a table by sensor."""
        dialect = detect_header(source.head(member, 8192))
        titles = () if dialect is None else dialect.titles
        clock = tuple(title for title in titles if title in _CLOCK)
        return cls(source, member, _columns(titles), clock, "," if dialect is None else dialect.separator)

    @property
    def place(self) -> str:
        """Return the file, for messages."""
        return self.source.place(self.member)

    @property
    def sensors(self) -> tuple[str, ...]:
        """Return the names of all sensors."""
        return tuple(self.columns)

    @property
    def empty(self) -> tuple[str, ...]:
        """Return (): which sensors have no values is not known before reading."""
        return ()

    def titles(self, sensor: str) -> tuple[str, ...]:
        """Return the names of the columns of a sensor."""
        return tuple(self.columns[sensor])

    def table(self, sensor: str, columns: Sequence[str], texts: Sequence[str] = ()) -> NumberTable | None:
        """Read columns of a sensor, in the rows where it has values (see `Export.table`)."""
        known = self.columns.get(sensor, {})
        wanted = {name: known[name] for name in (CLOCK_COLUMN, *columns, *texts) if name in known}
        wanted |= {name: name for name in self.clock if name in (CLOCK_COLUMN, *columns)}
        if not known.keys() & {*columns, *texts} and (columns or texts or sensor not in self.columns):
            return None
        table = read_table(
            self.source.read(self.member),
            self.place,
            separator=self.separator,
            columns=[title for name, title in wanted.items() if name not in texts],
            text_columns=[title for name, title in wanted.items() if name in texts],
        )
        values = [known[name] for name in columns if name in known]
        rows = table.has_values(values) if values else slice(None)
        arrays: dict[str, Any] = {name: table.columns[title][rows] for name, title in wanted.items()}
        return NumberTable(self.place, arrays) if len(arrays[next(iter(arrays))]) else None


def looks_combined(head: bytes) -> bool:
    """Tell whether a member begins like the combined table: Unix ns and the axes of a motion sensor."""
    dialect = detect_header(head)
    if dialect is None or "time" not in dialect.titles or names_owners(dialect.titles):
        return False
    columns = _columns(dialect.titles)
    motion = [columns[name] for name in (*MOTION_SENSORS, *WATCH_SENSORS) if name in columns]
    if not any({"x", "y", "z"} <= set(of_sensor) or "rotationRateX" in of_sensor for of_sensor in motion):
        return False
    lines = head.decode("utf-8", "replace").splitlines()
    cells = lines[1].split(dialect.separator) if len(lines) > 1 else []
    at = dialect.titles.index("time")
    return at < len(cells) and _UNIX_NS.fullmatch(cells[at].strip()) is not None


def _columns(titles: Sequence[str]) -> dict[str, dict[str, str]]:
    columns: dict[str, dict[str, str]] = {}
    for title in titles:
        split = column_of_title(title)
        if split is not None:
            columns.setdefault(split[0], {})[split[1]] = title
    return columns
