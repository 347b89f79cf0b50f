"""Read the SQLite export of Sensor Logger: one database with a table for each sensor."""

import sqlite3
from collections.abc import Sequence
from contextlib import closing
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from pdr_est.errors import RecordingError
from pdr_est.io.formats.phone_apps.sensor_logger.export import CLOCK_COLUMN, numbers_of_cells
from pdr_est.io.formats.phone_apps.sensor_logger.sensor_names import KNOWN_SENSORS, sensor_of_name
from pdr_est.io.text.number_table import NumberTable

_MAGIC = b"SQLite format 3\0"
_VERSION_BYTES = slice(18, 20)  # 2 2 for write-ahead logging, which a database in memory cannot have
_ROLLBACK_JOURNAL = b"\x01\x01"


def looks_like_database(head: bytes) -> bool:
    """Tell whether a member begins like an SQLite database."""
    return head.startswith(_MAGIC)


@dataclass(frozen=True)
class DatabaseExport:
    """Export as one SQLite database.

    Attributes
    ----------
    place
        Name of the export, for messages.
    data
        Content of the database file.
    """

    place: str
    data: bytes

    @cached_property
    def _tables(self) -> dict[str, str]:
        """Find sensor -> table."""
        names = [row[0] for row in self._fetch("SELECT name FROM sqlite_master WHERE type = 'table'")]
        tables = {sensor_of_name(name): name for name in names if not name.startswith("sqlite_")}
        if not tables.keys() & set(KNOWN_SENSORS):
            listed = ", ".join(sorted(tables)) or "none"
            raise RecordingError(
                f"{self.place}: an SQLite database without tables of Sensor Logger (its tables: {listed}); "
                "export the recording as CSV"
            )
        return tables

    @property
    def sensors(self) -> tuple[str, ...]:
        """Return the names of all sensors."""
        return tuple(self._tables)

    @property
    def empty(self) -> tuple[str, ...]:
        """Return the names of the sensors whose table has no rows."""
        query = "SELECT 1 FROM {} LIMIT 1"
        return tuple(s for s, table in self._tables.items() if not self._fetch(query.format(_quoted(table))))

    def titles(self, sensor: str) -> tuple[str, ...]:
        """Return the titles of all columns of a sensor."""
        return tuple(row[1] for row in self._fetch(f"PRAGMA table_info({_quoted(self._tables[sensor])})"))

    def table(self, sensor: str, columns: Sequence[str], texts: Sequence[str] = ()) -> NumberTable | None:
        """Read columns of a sensor (see `Export.table`)."""
        if sensor not in self._tables:
            return None
        present = [name for name in (CLOCK_COLUMN, *columns, *texts) if name in self.titles(sensor)]
        if not present:
            return None
        wanted = ", ".join(_quoted(name) for name in present)
        rows = self._fetch(f"SELECT {wanted} FROM {_quoted(self._tables[sensor])}")
        if not rows:
            return None
        place = f"{self.place}, table {self._tables[sensor]}"
        parsed: dict[str, Any] = {}
        for name, cells in zip(present, zip(*rows, strict=True), strict=True):
            if name in texts:
                parsed[name] = np.array(["" if cell is None else str(cell) for cell in cells])
            else:
                parsed[name] = numbers_of_cells(cells, name, place)
        return NumberTable(place, parsed)

    def _fetch(self, query: str) -> list[tuple[Any, ...]]:
        content = bytearray(self.data)
        content[_VERSION_BYTES] = _ROLLBACK_JOURNAL
        try:
            with closing(sqlite3.connect(":memory:")) as database:
                database.text_factory = lambda text: text.decode("utf-8", "replace")
                database.deserialize(bytes(content))
                return database.execute(query).fetchall()
        except (sqlite3.Error, UnicodeDecodeError) as error:
            raise RecordingError(f"{self.place}: damaged SQLite database ({error}); export it again") from error


def _quoted(name: str) -> str:
    """Quote the name of a table or column; SQL has no parameters for names."""
    return '"' + name.replace('"', '""') + '"'
