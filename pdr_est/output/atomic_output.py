"""Write results that appear completely or not at all: a folder, or a single file."""

import json
import os
import shutil
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TextIO

from pdr_est.errors import OutputError
from pdr_est.output.call_inputs import refuse_inputs_in_file, refuse_inputs_in_folder, refuse_remembered
from pdr_est.output.staging import OLD, is_staged, leftovers, remove_leftovers, staging_folder
from pdr_est.output.write_errors import output_errors

MANIFEST = ".pdr_est-files.json"
"""Hidden file in every result folder that lists what was written; anything else in the folder is foreign."""


@contextmanager
def staged_folder(target: Path, overwrite: bool, inputs: Sequence[Path]) -> Iterator[Path]:
    """Provide a temporary folder beside `target` that takes its place when the block ends without an error.

    When the block raises, Ctrl-C included, the temporary folder is removed and an existing target stays as it was. An
    existing target is replaced as a whole when it is empty, or when `overwrite` is set and it contains nothing but
    files of an earlier run (listed in its manifest). What a killed run has left is put right first.

    Parameters
    ----------
    target
        Folder of the results.
    overwrite
        True when results of an earlier run may be replaced.
    inputs
        Files and folders that are read, which are never replaced.

    Raises
    ------
    OutputError
        Before the block runs, when the target is a file, is or holds an input, contains other files or is the current
        folder, or when its parent is missing or not writable; afterwards, when the disk is full or the target has
        been changed meanwhile.
    """
    target = Path(target).expanduser()
    resolved = _resolved(target)
    refuse_inputs_in_folder(target, resolved, inputs)
    with output_errors(target):
        _undo_unfinished(resolved)
        _check_target(target, overwrite)
        with staging_folder(resolved) as staging, _named(staging, target):
            yield staging
            (staging / MANIFEST).write_text(manifest(_files_in(staging)), encoding="utf-8")
            _check_target(target, overwrite)
            if resolved.exists():
                refuse_remembered((resolved / name for name in _files_in(resolved)), target)
            _publish(staging, resolved)


@contextmanager
def staged_file(target: Path, overwrite: bool, inputs: Sequence[Path] = ()) -> Iterator[Path]:
    """Provide an empty file beside `target` that takes its place when the block ends without an error.

    In a folder that takes its place as a whole, it is the file itself.

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
        exists and may not be replaced, or when no file can be made beside it; afterwards, when the disk is full or
        the target is a file that was read meanwhile.
    """
    if is_staged(_resolved(Path(target).expanduser())):
        yield Path(target)  # whoever makes the folder words the errors
        return
    resolved = place_of_file(target, overwrite, inputs)
    with output_errors(target), staging_folder(resolved) as folder, _named(folder / resolved.name, target):
        staging = folder / resolved.name
        staging.touch()
        if resolved.exists():
            shutil.copymode(resolved, staging)
        yield staging
        publish_file(staging, resolved, overwrite, target)


def place_of_file(target: Path, overwrite: bool, inputs: Sequence[Path]) -> Path:
    """Return the path, links resolved, at which a file may be written, and remove what killed runs left beside it.

    Raises
    ------
    OutputError
        If the target is a folder or a device, is one of the inputs or lies inside one, or exists and may not be
        replaced.
    """
    resolved = _resolved(Path(target).expanduser())
    if resolved.exists() and not resolved.is_file():
        raise OutputError(f"{target}: not a regular file: choose another file name")
    refuse_inputs_in_file(target, resolved, inputs)
    if resolved.exists() and not overwrite:
        raise OutputError(f"{target}: exists already: allow overwriting (--overwrite) or choose another file")
    remove_leftovers(resolved.parent, resolved.name)
    return resolved


def publish_file(staging: Path, resolved: Path, overwrite: bool, target: Path) -> None:
    """Give a file that has been written its name.

    Raises
    ------
    OutputError
        If the target was read meanwhile, or has appeared and may not be replaced.
    """
    _to_disk(staging)
    refuse_remembered([resolved], target)
    if not overwrite and resolved.exists():
        raise OutputError(f"{target}: has appeared meanwhile: choose another file")
    staging.replace(resolved)


@contextmanager
def text_output(target: Path | str) -> Iterator[TextIO]:
    """Provide a stream of UTF-8 text that becomes a file when the block ends without an error.

    Line ends are written as they are. Bytes of file names that are no text are escaped.

    Raises
    ------
    OutputError
        If the file cannot be written.
    """
    with (
        staged_file(Path(target), overwrite=True) as staging,
        staging.open("w", newline="", encoding="utf-8", errors="backslashreplace") as stream,
    ):
        yield stream


def write_text(target: Path | str, text: str) -> None:
    """Write a file of UTF-8 text. Raises OutputError as `text_output` does."""
    with text_output(target) as stream:
        stream.write(text)


@contextmanager
def _named(staging: Path, target: Path) -> Iterator[None]:
    """Have errors of the block name the target, which the user knows, in place of the hidden file or folder."""
    try:
        yield
    except OutputError as error:
        if str(staging) not in str(error):
            raise
        raise OutputError(str(error).replace(str(staging), str(target))) from error


def written_files(folder: Path) -> set[str]:
    """List the files that earlier runs wrote into a folder; none when it has no readable manifest."""
    try:
        names = json.loads((folder / MANIFEST).read_text(encoding="utf-8"))["files"]
        return {*(str(name) for name in names), MANIFEST}
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return set()


def _to_disk(path: Path) -> None:
    """Wait until a file is on the disk, so that after a power failure its name stands for all of it or nothing."""
    if path.is_file():
        with path.open("rb") as file:
            os.fsync(file.fileno())


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


def _undo_unfinished(target: Path) -> None:
    """Remove what killed runs have left, and put an earlier result back that one of them had moved away."""
    remove_leftovers(target.parent, target.name)
    for old in leftovers(target.parent, target.name, OLD):
        if (old / target.name).exists() and not target.exists():
            (old / target.name).rename(target)
        shutil.rmtree(old, ignore_errors=True)


def _publish(staging: Path, target: Path) -> None:
    """Rename `staging` to `target`; put an existing target back if that fails."""
    if not target.exists():
        staging.rename(target)
        return
    for name in _files_in(staging):  # before the earlier result is given up
        _to_disk(staging / name)
    shutil.copymode(target, staging)
    with staging_folder(target, OLD) as old:
        try:
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
