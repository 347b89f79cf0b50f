"""Find the recordings in a folder that holds several."""

from pathlib import Path, PurePosixPath

from pdr_est.errors import RecordingError, SeveralWalksError
from pdr_est.io.formats.registry import FORMATS, read
from pdr_est.io.tables.mapping import TableMapping
from pdr_est.io.text.container import Source, SourceKind

_ANNOTATION = ".xml"  # files that stand for a walk and hold none of its samples


def walks_in_folder(folder: Path, mapping: TableMapping | None = None) -> tuple[Path, ...]:
    """List the recordings in a folder, at any depth; the folder itself if it is one recording.

    All are of one format: that which `read` recognises first.

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
        if source.kind is not SourceKind.FOLDER:
            raise
        return _paths(source, error.walks)
    return (folder,)


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


def _is_recording(source: Source, member: str) -> bool:
    alone = Source.open(source.path / source.stored[member])
    return any(known.sniff(alone) for known in FORMATS)
