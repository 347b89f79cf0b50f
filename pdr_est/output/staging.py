"""Hidden folders beside a result, in which it is made, and what killed programs left of them.

The folder is locked while its program lives. The system releases the lock when the program dies, so that the next run
knows which folders nobody works in any more.
"""

import os
import re
import shutil
import sys
import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

PARTIAL, OLD = "partial", "old"
"""Endings of the folders in which a result is made, and in which its predecessor waits to be removed."""

_LONGEST = 40  # characters of the name: a file system allows 255 bytes
_active: set[Path] = set()

if sys.platform == "win32":  # a folder cannot be locked, and leftovers are not removed

    def _hold(folder: Path) -> int | None:
        folder.mkdir()
        return None

    def _is_left(_path: Path) -> bool:
        return False
else:
    import fcntl

    def _hold(folder: Path) -> int | None:
        """Make a folder and lock it; None if the file system knows no locks."""
        while True:
            folder.mkdir()
            held = os.open(folder, os.O_RDONLY)
            try:
                fcntl.flock(held, fcntl.LOCK_EX)
                if os.path.samestat(folder.stat(), os.fstat(held)):
                    return held
                os.close(held)
            except FileNotFoundError:  # another run has taken it for a leftover before it was locked
                os.close(held)
            except OSError:
                os.close(held)
                return None

    def _is_left(path: Path) -> bool:
        """Tell whether no living program holds a folder, or a file of earlier versions."""
        if path.is_symlink():
            return False
        try:
            opened = os.open(path, os.O_RDONLY)
        except OSError:
            return False
        try:
            fcntl.flock(opened, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            return False
        finally:
            os.close(opened)
        return True


@contextmanager
def staging_folder(target: Path, purpose: str = PARTIAL) -> Iterator[Path]:
    """Provide a new hidden folder beside a target, which is removed when the block ends.

    Parameters
    ----------
    target
        File or folder that will appear; symbolic links resolved.
    purpose
        Ending of the name.

    Raises
    ------
    OSError
        If the folder cannot be made.
    """
    folder = target.with_name(f".{target.name[:_LONGEST]}.{uuid.uuid4().hex[:8]}.{purpose}")
    held: int | None = None
    try:  # from here on: Ctrl-C may come at any moment
        held = _hold(folder)
        _active.add(folder)
        yield folder
    finally:
        _active.discard(folder)
        if purpose == PARTIAL or target.exists():  # else it holds the only result that there is
            shutil.rmtree(folder, ignore_errors=True)
        if held is not None:
            os.close(held)


def is_staged(path: Path) -> bool:
    """Tell whether a file lies in a folder in which a result is being made by this process."""
    return any(path.is_relative_to(folder) for folder in _active)


def leftovers(folder: Path, name: str | None = None, purpose: str = PARTIAL) -> list[Path]:
    """List what killed programs left in a folder.

    Parameters
    ----------
    folder
        Folder of the results.
    name
        Name of the result; None for any.
    purpose
        Ending of the names.
    """
    start = r".*" if name is None else re.escape(name[:_LONGEST])
    pattern = re.compile(rf"\.{start}\.[0-9a-f]{{8}}\.{purpose}", re.DOTALL)
    try:
        with os.scandir(folder) as entries:
            found = [Path(entry.path) for entry in entries if pattern.fullmatch(entry.name)]
    except OSError:
        return []
    return sorted(path for path in found if _is_left(path))


def remove_leftovers(folder: Path, name: str | None = None) -> None:
    """Remove what killed programs left of a result, or of all results in a folder."""
    for path in leftovers(folder, name):
        if path.is_dir():
            shutil.rmtree(path, ignore_errors=True)
        else:
            path.unlink(missing_ok=True)


def is_staging_name(name: str) -> bool:
    """Tell whether a file or folder of that name holds a result that is being made, or was left of one."""
    return re.fullmatch(rf"\..*\.[0-9a-f]{{8}}\.({PARTIAL}|{OLD})", name, re.DOTALL) is not None
