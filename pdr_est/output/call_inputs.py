"""Inputs of a call, which it never replaces."""

import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

from pdr_est.errors import OutputError

_remembered: set[tuple[int, int]] | None = None


@contextmanager
def inputs_remembered() -> Iterator[None]:
    """Remember what is read until the block ends: a table may lie beside the recording that was named."""
    global _remembered
    before, _remembered = _remembered, set()
    try:
        yield
    finally:
        _remembered = before


def remember_input(path: Path) -> None:
    """Take note that a file is read."""
    if _remembered is not None:
        identity = _identity(path)
        if identity is not None:
            _remembered.add(identity)


def refuse_remembered(paths: Iterable[Path], target: Path) -> None:
    """Raise OutputError if any of some files that will be replaced has been read, under whatever name."""
    for path in paths:
        if _remembered and _identity(path) in _remembered:
            raise OutputError(f"{target}: {path} has been read by this call: choose another place")


def refuse_inputs_in_file(target: Path, resolved: Path, inputs: Iterable[Path]) -> None:
    """Raise OutputError if a file to write is an input, is part of one or lies inside one.

    Parameters
    ----------
    target
        The file as the user named it.
    resolved
        The same without symbolic links.
    inputs
        Files and folders that are read.
    """
    identity = _identity(resolved)
    for source in inputs:
        place = _real(source)
        if resolved.is_relative_to(place) or (identity is not None and identity in _identities(place, resolved)):
            raise OutputError(f"{target}: is the input {source} or lies inside it: choose a file elsewhere")


def refuse_inputs_in_folder(target: Path, resolved: Path, inputs: Iterable[Path]) -> None:
    """Raise OutputError if a folder that is replaced as a whole is an input or holds one."""
    for source in inputs:
        if _real(source).is_relative_to(resolved):
            raise OutputError(f"{target}: is or holds the input {source}: choose a folder elsewhere")


def _identities(source: Path, target: Path) -> Iterator[tuple[int, int] | None]:
    """Yield what identifies the file or the files of a folder; a link to a folder that holds the target does, too."""
    yield _identity(source)
    for folder, folders, files in os.walk(source):
        yield from (_identity(Path(folder, name)) for name in files)
        links = [Path(folder, name) for name in folders if Path(folder, name).is_symlink()]
        yield from (_identity(target) for link in links if target.is_relative_to(_real(link)))


def _identity(path: Path) -> tuple[int, int] | None:
    """Return what two names of one file have in common; None if there is no such file."""
    try:
        found = path.stat()
    except (OSError, ValueError):
        return None
    return found.st_dev, found.st_ino


def _real(path: Path) -> Path:
    """Follow symbolic links as far as there are any."""
    try:
        return path.expanduser().resolve()
    except (OSError, RuntimeError, ValueError):  # reading it says so
        return path.absolute()
