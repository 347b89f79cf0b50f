"""Find the recordings in a folder that holds several."""

import os
import re
from collections.abc import Sequence
from pathlib import Path, PurePosixPath

from pdr_est.errors import RecordingError, SeveralWalksError
from pdr_est.io.formats.registry import format_of, read
from pdr_est.io.tables.mapping import TableMapping
from pdr_est.io.text.container import Source, SourceKind

_NOTE = re.compile(r"(?:read_?me|licen[cs]e|copying|changelog|index|notes?)\b.*", re.IGNORECASE)
_OF_NOTES_TOO = ".json"  # recordings are rarer in it than facts about them
_NONE = re.compile(r"(?!)")
_ANNOTATION = ".xml"  # files that stand for a walk and hold none of its samples


def walks_in_folder(folder: Path, mapping: TableMapping | None = None) -> tuple[Path, ...]:
    """List the recordings in a folder, at any depth; the folder itself if it is one recording.

    Files of the same kind that cannot be read are in the list, too, so that whoever reads it says why; the files
    that a format reads beside a walk are not, nor notes and pictures.

    Parameters
    ----------
    folder
        The folder.
    mapping
        What the columns of the tables mean; None to find it out.

    Raises
    ------
    RecordingError
        If the folder holds no recording, or a single one that cannot be read.
    """
    try:
        read(folder, mapping)
    except SeveralWalksError as error:
        source = Source.open(folder)
        if source.kind is not SourceKind.FOLDER or error.by_device:
            raise
        walks = _paths(source, error.walks)
        return walks if mapping is not None else (*walks, *_others(source, walks))
    return (folder,) if mapping is not None else _with_other_formats(folder)


def _with_other_formats(folder: Path) -> tuple[Path, ...]:
    """List the walk of a folder that is one recording, with recordings of other formats that lie beside it."""
    source = Source.open(folder)
    known, _ = format_of(source)
    own = [member for member in source.members if known is not None and known.sniff(source.with_only(member))]
    if source.kind is not SourceKind.FOLDER or not own or len(source.members) == 1:
        return (folder,)
    files = [source.path / source.stored[member] for member in own]
    walk = files[0] if len(own) == 1 else Path(os.path.commonpath([file.parent for file in files]))
    others = [] if walk == source.path else _others(source, (walk,))
    return (walk, *others) if any(_is_readable(path) for path in others) else (folder,)


def _is_readable(path: Path) -> bool:
    return format_of(Source.open(path))[0] is not None


def _paths(source: Source, walks: tuple[str, ...]) -> tuple[Path, ...]:
    """Find the files or folders of walks by their names; the single files where a walk is named otherwise."""
    found = {walk: _path(source, walk) for walk in walks}
    if None not in found.values():
        return tuple(path for path in found.values() if path is not None)
    tables = [member for member in source.members if not member.lower().endswith(_ANNOTATION)]
    files = [source.path / source.stored[member] for member in tables if _is_recording(source, member)]
    if not files:
        raise RecordingError(f"{source.path}: none of its files is a recording by itself: give them one by one")
    return tuple(files)


def _path(source: Source, walk: str) -> Path | None:
    if walk in source.stored:
        return source.path / source.stored[walk]
    inside = [stored for member, stored in source.stored.items() if member.startswith(f"{walk}/")]
    if not inside:
        return None
    depth = len(PurePosixPath(walk).parts)
    member = next(member for member in source.members if member.startswith(f"{walk}/"))
    below = len(PurePosixPath(member).parts) - depth
    return source.path / Path(*PurePosixPath(source.stored[member]).parts[:-below])


def _others(source: Source, walks: Sequence[Path]) -> list[Path]:
    """List the files outside the walks that are recordings of another format, or should be and cannot be read."""
    folders = {walk for walk in walks if walk.is_dir()}
    beside = _names_beside(walks[0])
    outside = [
        (source.path / stored, member)
        for member, stored in source.stored.items()
        if not _NOTE.fullmatch(PurePosixPath(member).name) and not beside.fullmatch(PurePosixPath(stored).name)
    ]
    outside = [(path, m) for path, m in outside if path not in walks and not folders & set(path.parents)]
    found = _joined(source, walks, [path for path, member in outside if _is_recording(source, member)])
    outside = [(path, m) for path, m in outside if not set(found) & {path, *path.parents}]
    extensions = {_extension(walk) for walk in (*walks, *found) if walk.is_file()} - {_OF_NOTES_TOO}
    stems = {(walk.parent, _stem(walk)) for walk in (*walks, *found)}
    broken = [path for path, _ in outside if _extension(path) in extensions]
    return [*found, *(path for path in broken if (path.parent, _stem(path)) not in stems)]


def _joined(source: Source, walks: Sequence[Path], files: Sequence[Path]) -> list[Path]:
    """Replace recordings that are the files of one walk by their folder."""
    found: dict[Path, None] = {}
    for path in files:
        folder = path.parent
        alone = folder != source.path and not any(folder in walk.parents for walk in walks)
        for walk in _walks_of(folder, path) if alone else (path,):
            found.setdefault(walk)
    return list(found)


def _walks_of(folder: Path, path: Path) -> tuple[Path, ...]:
    """List the walks in a folder with a recording; that alone where the folder cannot be read."""
    try:
        return walks_in_folder(folder)
    except RecordingError:
        return (path,)


def _stem(path: Path) -> str:
    return path.name.removesuffix(_extension(path)).casefold()


def _extension(path: Path) -> str:
    packed = path.suffix.casefold() == ".gz"
    return "".join(path.suffixes[-2:] if packed else path.suffixes[-1:])


def _names_beside(walk: Path) -> re.Pattern[str]:
    """Return the names of files that the format of a walk reads beside it."""
    alone = Source.open(walk)
    known, _ = format_of(alone)
    names: re.Pattern[str] = getattr(known, "BESIDE", _NONE)
    return names


def _is_recording(source: Source, member: str) -> bool:
    try:
        alone = Source.open(source.path / source.stored[member])
        return format_of(alone)[0] is not None
    except RecordingError:  # such as a damaged archive
        return False
