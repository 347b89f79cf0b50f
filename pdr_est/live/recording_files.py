"""Recording of a live walk: tables that grow while samples arrive, and that every command reads afterwards.

Each phone has a table in the project's own plain format, one row a sample with empty cells for the other sensors. A
row reaches the system as soon as its sample does, so that a program that is killed loses nothing that had arrived.
The numbers are written in full: a reader gets the very samples that the filter got.
"""

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from pdr_est.errors import OutputError
from pdr_est.io.tables.quantities import CANONICAL, Quantity
from pdr_est.output.appended_file import AppendedFile
from pdr_est.output.write_errors import output_errors
from pdr_est.types.measurements import PositionFix
from pdr_est.types.sensors import Channel, SensorBlock

FIXES_FILE = "fixes.csv"
"""Table of the positions that the walker stated, or that a phone sent."""

MESSAGES_FILE = "messages.jsonl"
"""Messages of recorder apps as they came, one a line."""

_QUANTITIES = {
    Channel.SPECIFIC_FORCE: Quantity.FORCE,
    Channel.ROTATION_RATE: Quantity.RATE,
    Channel.MAGNETIC_FIELD: Quantity.FIELD,
    Channel.ATTITUDE: Quantity.ATTITUDE,
    Channel.PRESSURE: Quantity.PRESSURE,
}
_TITLES = [title for quantity in (Quantity.TIME, *_QUANTITIES.values()) for title in CANONICAL[quantity]]
_FIRST = {channel: _TITLES.index(CANONICAL[quantity][0]) for channel, quantity in _QUANTITIES.items()}


class LiveRecording:
    """Folder of one walk, which must be new.

    Parameters
    ----------
    folder
        Folder to make.

    Raises
    ------
    OutputError
        If the folder exists or cannot be made.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._tables: dict[str, AppendedFile] = {}
        self._other: dict[str, AppendedFile] = {}
        if folder.exists():
            raise OutputError(f"{folder}: exists already: choose another folder for the walk")
        with output_errors(folder):
            folder.mkdir()

    @property
    def tables(self) -> tuple[Path, ...]:
        """Return the tables of the phones."""
        return tuple(self._path_of(device) for device in self._tables)

    @property
    def fixes(self) -> Path | None:
        """Return the table of known positions; None without any."""
        return self.folder / FIXES_FILE if FIXES_FILE in self._other else None

    @property
    def size_bytes(self) -> int:
        """Return the size of all files, bytes."""
        return sum(file.size_bytes for file in (*self._tables.values(), *self._other.values()))

    def add(self, device: str, blocks: Sequence[SensorBlock]) -> None:
        """Append samples of a device.

        Raises
        ------
        OutputError
            If they cannot be written.
        """
        if device not in self._tables:
            self._tables[device] = AppendedFile(self._path_of(device))
            self._tables[device].append(",".join(_TITLES) + "\n")
        text = "".join(_rows(block) for block in blocks)
        if text:
            self._tables[device].append(text)

    def add_fix(self, fix: PositionFix) -> None:
        """Append a known position. Raises OutputError if it cannot be written."""
        x_m, y_m = fix.position_m.tolist()
        sigma_m = float(np.sqrt(0.5 * np.trace(fix.covariance_m2)))
        file = self._file(FIXES_FILE, "time_s,x_m,y_m,sigma_m,robust,source\n")
        file.append(f"{float(fix.time_s)!r},{x_m!r},{y_m!r},{sigma_m!r},{int(fix.robust)},{fix.source}\n")

    def add_message(self, text: str) -> None:
        """Append a message of an app as it came. Raises OutputError if it cannot be written."""
        self._file(MESSAGES_FILE, "").append(re.sub(r"[\r\n]+", " ", text) + "\n")

    def sync(self) -> None:
        """Wait until the disk holds everything. Raises OutputError if it refuses."""
        for file in (*list(self._tables.values()), *list(self._other.values())):  # others may be added meanwhile
            file.sync()

    def close(self) -> None:
        """Close the files."""
        for file in (*self._tables.values(), *self._other.values()):
            file.close()

    def _path_of(self, device: str) -> Path:
        return self.folder / f"{re.sub(r'[^A-Za-z0-9-]+', '_', device)}.csv"

    def _file(self, name: str, head: str) -> AppendedFile:
        if name not in self._other:
            self._other[name] = AppendedFile(self.folder / name)
            self._other[name].append(head)
        return self._other[name]


def _rows(block: SensorBlock) -> str:
    """Write samples as rows; numbers are as short as they can be without losing a bit."""
    before = "," * _FIRST[block.channel]
    after = "," * (len(_TITLES) - _FIRST[block.channel] - block.channel.width) + "\n"
    samples = zip(block.time_s.tolist(), block.values.tolist(), strict=True)
    return "".join(f"{time_s!r}{before}{','.join(map(repr, values))}{after}" for time_s, values in samples)
