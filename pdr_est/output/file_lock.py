"""Lock a file that several programs change, so that each of them sees what the one before has written."""

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

from pdr_est.errors import OutputError

if sys.platform == "win32":
    import msvcrt

    def _wait_for(stream: IO[bytes]) -> None:
        msvcrt.locking(stream.fileno(), msvcrt.LK_LOCK, 1)
else:
    import fcntl

    def _wait_for(stream: IO[bytes]) -> None:
        fcntl.flock(stream, fcntl.LOCK_EX)


@contextmanager
def locked(target: Path) -> Iterator[None]:
    """Wait until no other program is in such a block for the same file, and keep others waiting during the block.

    The lock is on a hidden file beside the target, which is removed at the end. The system releases it when a program
    dies.

    Raises
    ------
    OutputError
        If no file can be made beside the target.
    """
    resolved = target.expanduser().resolve()
    path = resolved.with_name(f".{resolved.name}.lock")
    while True:
        try:
            stream = path.open("ab")
        except OSError as error:
            raise OutputError(f"{target}: cannot be locked ({error.strerror}): choose a file elsewhere") from error
        with stream:
            _wait_for(stream)
            # Whoever held the lock before has removed the file: only the one that has the name now counts.
            if not _is_current(path, stream):
                continue
            try:
                yield
            finally:
                if sys.platform != "win32":  # where an open file cannot be removed
                    path.unlink(missing_ok=True)
            return


def _is_current(path: Path, stream: IO[bytes]) -> bool:
    try:
        return os.path.samestat(path.stat(), os.fstat(stream.fileno()))
    except FileNotFoundError:
        return False
