"""Recordings of a suite on disk."""

import re
from pathlib import Path

from pdr_est.errors import RecordingError


def suite_folder(data: Path, folder: str) -> Path:
    """Return the folder of a suite: the one of that name inside `data`, else `data` itself.

    Raises
    ------
    RecordingError
        If `data` is not a folder.
    """
    if not data.is_dir():
        raise RecordingError(f"{data}: no such folder: give the folder that holds {folder_content(folder)}")
    inside = data / folder
    return inside if inside.is_dir() else data


def folder_content(folder: str) -> str:
    """Say what the data folder must contain for the suite of that folder; "." is a suite of several data sets."""
    return "its data sets" if folder == "." else f"{folder}/"


def recordings(folder: Path, pattern: str) -> list[tuple[str, Path]]:
    """List the names and paths of the files that match a pattern, plain or `.gz`, at any depth.

    A file that exists plain and gzipped is one recording.

    Parameters
    ----------
    folder : Path
        Folder that is searched.
    pattern : str
        Pattern such as `imu*.csv`.

    Returns
    -------
    list of (str, Path)
        Name (path relative to the folder, without extensions) and path, sorted by name, numbers by value.
    """
    found: dict[str, Path] = {}
    for path in (*folder.rglob(f"{pattern}.gz"), *folder.rglob(pattern)):
        found[_name(path.relative_to(folder))] = path
    return sorted(found.items(), key=lambda item: _natural_key(item[0]))


def _name(path: Path) -> str:
    plain = path.with_suffix("") if path.suffix == ".gz" else path
    return plain.with_suffix("").as_posix()


def _natural_key(name: str) -> list[tuple[int, str]]:
    """Make a sort key that puts imu2 before imu10."""
    return [(int(part), "") if part.isdigit() else (-1, part) for part in re.split(r"(\d+)", name)]
