"""Write results that appear completely or not at all: a folder, or a single file."""

import errno
import json
import os
import shutil
import uuid
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from pdr_est.errors import OutputError

MANIFEST = ".pdr_est-files.json"
"""Hidden file in every result folder that lists what was written; anything else in the folder is foreign."""

_DISK_FULL = (errno.ENOSPC, errno.EDQUOT)


@contextmanager
def staged_folder(target: Path, overwrite: bool) -> Iterator[Path]:
    """Provide a temporary folder beside `target` that takes its place when the block ends without an error.

    When the block raises, Ctrl-C included, the temporary folder is removed and an existing target stays as it was. An
    existing target is replaced as a whole when it is empty, or when `overwrite` is set and it contains nothing but
    files of an earlier run (listed in its manifest).

    Parameters
    ----------
    target
        Folder of the results.
    overwrite
        True when results of an earlier run may be replaced.

    Raises
    ------
    OutputError
        Before the block runs, when the target is a file, contains other files or is the current folder, or when its
        parent is missing or not writable; afterwards, when the disk is full or the target has been changed meanwhile.
    """
    target = Path(target).expanduser()
    resolved = _resolved(target)
    _check_target(target, overwrite)
    staging = _sibling(resolved, "partial")
    try:
        _create(staging, resolved)  # within the block that removes it: Ctrl-C may come at any moment
        yield staging
        (staging / MANIFEST).write_text(manifest(_files_in(staging)), encoding="utf-8")
        _check_target(target, overwrite)
        _publish(staging, resolved)
    except OSError as error:
        if error.errno in _DISK_FULL:
            raise OutputError(f"{target}: the disk is full: free some space or choose another folder") from error
        raise
    finally:
        shutil.rmtree(staging, ignore_errors=True)


@contextmanager
def staged_file(target: Path, overwrite: bool, inputs: Sequence[Path] = ()) -> Iterator[Path]:
    """Provide an empty file beside `target` that takes its place when the block ends without an error.

    Parameters
    ----------
    target
        File of the result.
    overwrite
        True when an existing file may be replaced.
    inputs
        Files and folders that are read, which are never overwritten.

    Raises
    ------
    OutputError
        Before the block runs, when the target is a folder or a device, is one of the inputs or lies inside one,
        exists and may not be replaced, or when no file can be made beside it.
    """
    resolved = _resolved(Path(target).expanduser())
    if resolved.exists() and not resolved.is_file():
        raise OutputError(f"{target}: not a regular file: choose another file name")
    for source in inputs:
        if resolved.is_relative_to(_resolved(source)) or (resolved.exists() and _same_file(resolved, source)):
            raise OutputError(f"{target}: is the input {source} or lies inside it: choose a file elsewhere")
    if resolved.exists() and not overwrite:
        raise OutputError(f"{target}: exists already: allow overwriting (--overwrite) or choose another file")
    staging = _sibling(resolved, "partial")
    try:
        try:
            staging.touch()
        except OSError as error:
            raise OutputError(f"{target}: cannot be written ({error.strerror}): choose a file elsewhere") from error
        yield staging
        _to_disk(staging)
        staging.replace(resolved)
    finally:
        staging.unlink(missing_ok=True)


def written_files(folder: Path) -> set[str]:
    """List the files that earlier runs wrote into a folder; none when it has no readable manifest."""
    try:
        names = json.loads((folder / MANIFEST).read_text(encoding="utf-8"))["files"]
        return {*(str(name) for name in names), MANIFEST}
    except (OSError, ValueError, KeyError, TypeError):
        return set()


def _to_disk(path: Path) -> None:
    """Wait until a file is on the disk, so that after a power failure its name stands for all of it or nothing."""
    with path.open("rb") as file:
        os.fsync(file.fileno())


def _same_file(a: Path, b: Path) -> bool:
    """Tell whether two names, perhaps hard links, refer to one file."""
    return b.exists() and a.samefile(b)


def _resolved(target: Path) -> Path:
    """Follow symbolic links; raise OutputError for a path that cannot exist."""
    try:
        resolved = target.resolve()
        resolved.exists()
    except (OSError, RuntimeError, ValueError) as error:  # too long a name, a loop of links, a null character
        raise OutputError(f"{target}: not a usable path ({error}): choose another one") from error
    return resolved


def _check_target(target: Path, overwrite: bool) -> None:
    """Raise OutputError unless results may be put at `target`."""
    resolved = target.resolve()
    if not resolved.parent.is_dir():
        raise OutputError(f"{target}: the folder {target.parent} does not exist: create it or choose another one")
    if not resolved.exists():
        return
    if not resolved.is_dir():
        raise OutputError(f"{target}: is a file, not a folder: choose another output folder")
    if Path.cwd().is_relative_to(resolved):
        raise OutputError(f"{target}: is the current folder and cannot be replaced: choose a folder inside it")
    present = _files_in(target)
    foreign = sorted(present - written_files(target))
    if foreign:
        others = f" and {len(foreign) - 1} more" if len(foreign) > 1 else ""
        raise OutputError(
            f"{target}: contains files of other origin ({foreign[0]}{others}): choose a new or an empty folder"
        )
    if present and not overwrite:
        raise OutputError(
            f"{target}: contains the results of an earlier run: allow overwriting (--overwrite) or choose "
            "another folder"
        )


def _files_in(folder: Path) -> set[str]:
    """List everything below `folder` except folders with content, as paths relative to it."""
    try:
        return {
            path.relative_to(folder).as_posix()
            for path in folder.rglob("*")
            if path.is_symlink() or not path.is_dir() or not any(path.iterdir())
        }
    except OSError as error:
        raise OutputError(f"{folder}: cannot be listed ({error.strerror}): choose another output folder") from error


def manifest(files: Iterable[str]) -> str:
    """Make the content of a manifest."""
    content = {"note": "Files written by pdr-est; a later run may replace them.", "files": sorted(files)}
    return json.dumps(content, indent=1, ensure_ascii=False) + "\n"


def _sibling(target: Path, purpose: str) -> Path:
    """Make a new hidden name beside `target`, on the same disk, so that it can be renamed into place."""
    return target.with_name(f".{target.name}.{uuid.uuid4().hex[:8]}.{purpose}")


def _create(folder: Path, target: Path) -> None:
    try:
        folder.mkdir()
    except OSError as error:
        raise OutputError(
            f"{target}: the folder {target.parent} is not writable ({error.strerror}): choose another output folder"
        ) from error


def _publish(staging: Path, target: Path) -> None:
    """Rename `staging` to `target`; put an existing target back if that fails."""
    if not target.exists():
        staging.rename(target)
        return
    shutil.copymode(target, staging)
    old = _sibling(target, "old")
    try:
        _create(old, target)
        try:
            target.rename(old / target.name)
        except OSError as error:
            raise OutputError(
                f"{target}: cannot be replaced ({error.strerror}): choose a new folder inside it or beside it"
            ) from error
        staging.rename(target)
    except BaseException:
        if not target.exists() and (old / target.name).exists():
            (old / target.name).rename(target)
        raise
    finally:
        if target.exists():
            shutil.rmtree(old, ignore_errors=True)
