"""The recordings of a suite on disk."""

import re
from pathlib import Path

from pdr_est.errors import RecordingError


def suite_folder(data: Path, folder: str) -> Path:
    """The suite's own folder: the one of that name inside `data`, else `data` itself.

    Raises RecordingError when `data` is no folder.
    """
    if not data.is_dir():
        raise RecordingError(f"{data}: no such folder: give the folder that holds {in_words(folder)}")
    inside = data / folder
    return inside if inside.is_dir() else data


def in_words(folder: str) -> str:
    """What the data folder must hold for a suite of that folder; "." is a suite of several data sets."""
    return "its data sets" if folder == "." else f"{folder}/"


def recordings(folder: Path, pattern: str) -> list[tuple[str, Path]]:
    """Names and paths of the files that match a pattern such as `imu*.csv`, plain or `.gz`, at any depth.

    The name is the path relative to the folder without extensions. In order of name, numbers by value. A file that is
    there plain and gzipped is one recording.
    """
    found: dict[str, Path] = {}
    for path in (*folder.rglob(f"{pattern}.gz"), *folder.rglob(pattern)):
        found[_name(path.relative_to(folder))] = path
    return sorted(found.items(), key=lambda item: _natural(item[0]))


def _name(path: Path) -> str:
    plain = path.with_suffix("") if path.suffix == ".gz" else path
    return plain.with_suffix("").as_posix()


def _natural(name: str) -> list[tuple[int, str]]:
    """Sort key that puts imu2 before imu10."""
    return [(int(part), "") if part.isdigit() else (-1, part) for part in re.split(r"(\d+)", name)]
