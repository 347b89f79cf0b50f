"""Open a recording that lies in a zip archive in a folder of its own, as apps that share files leave it."""

from pathlib import Path

from pdr_est.errors import RecordingError
from pdr_est.io.text.container import Source, SourceKind

_ZIP_MAGIC = b"PK\x03\x04"
_SPREADSHEET = b"[Content_Types].xml"  # the first member of an xlsx file, which is a zip archive, too
_NAMED_IN_MESSAGE = 3


def open_recording(path: str | Path) -> Source:
    """Open a file, a folder or an archive; a folder with nothing but one archive is that archive.

    Raises
    ------
    RecordingError
        For a folder of several archives, some of which it names, and whatever `Source.open` refuses.
    """
    source = Source.open(path)
    if source.kind is not SourceKind.FOLDER:
        return source
    archives = [member for member in source.members if _is_archive(source, member)]
    if len(archives) < len(source.members):
        return source
    if len(archives) > 1:
        named = ", ".join(archives[:_NAMED_IN_MESSAGE]) + (", …" if len(archives) > _NAMED_IN_MESSAGE else "")
        raise RecordingError(f"{source.path}: contains {len(archives)} zip archives ({named}); choose one of them")
    return Source.open(source.path / source.stored[archives[0]])


def _is_archive(source: Source, member: str) -> bool:
    head = source.head(member, 64)
    return head.startswith(_ZIP_MAGIC) and _SPREADSHEET not in head
