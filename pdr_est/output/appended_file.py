"""Write a file that grows by whole pieces of text, each of which outlives the program as soon as it is written."""

import os
from pathlib import Path
from types import TracebackType

from pdr_est.errors import OutputError
from pdr_est.output.write_errors import output_errors


class AppendedFile:
    """New file of UTF-8 text without a buffer: the system holds a piece of text before `append` returns.

    What was appended is kept if the program is killed. `sync` makes it survive a power failure, too.

    Parameters
    ----------
    path
        File to make; it must not exist.

    Raises
    ------
    OutputError
        If the file exists or cannot be made.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._unsynced = False
        self.size_bytes = 0
        if path.exists():
            raise OutputError(f"{path}: exists already: choose another place")
        with output_errors(path):
            self._file = path.open("xb", buffering=0)

    def append(self, text: str) -> None:
        """Write a piece of text.

        Raises
        ------
        OutputError
            If it cannot be written, because the disk is full, for example.
        """
        rest = memoryview(text.encode())
        with output_errors(self._path):
            while rest:
                written = self._file.write(rest) or 0
                self.size_bytes += written
                rest = rest[written:]
        self._unsynced = True

    def sync(self) -> None:
        """Wait until the disk holds everything that was appended.

        Raises
        ------
        OutputError
            If the disk refuses it.
        """
        if self._unsynced and not self._file.closed:
            self._unsynced = False
            with output_errors(self._path):
                os.fsync(self._file.fileno())

    def close(self) -> None:
        """Sync and close the file; nothing can be appended afterwards."""
        self.sync()
        self._file.close()

    def __enter__(self) -> "AppendedFile":
        """Return the file itself."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()
