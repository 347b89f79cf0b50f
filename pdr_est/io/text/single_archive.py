"""Open a recording that lies in a zip archive in a folder of its own, as apps that share files leave it."""

from pathlib import Path

from pdr_est.errors import RecordingError, SeveralWalksError
from pdr_est.io.text.container import ZIP_MAGICS, Source, SourceKind
from pdr_est.io.text.table_layout import detect_layout
from pdr_est.io.text.unpacked.workbook import is_xlsx

_NAMED_IN_MESSAGE = 3
_HEAD_BYTES = 2048
_NOTES = (".txt", ".md", ".pdf", ".jpg", ".jpeg", ".png", ".mp4", ".mov", ".html", ".docx", ".rtf", "")


def open_recording(path: str | Path) -> Source:
    """Open a file, a folder or an archive; a folder with one archive, and at most notes beside it, is that archive.

    Raises
    ------
    SeveralWalksError
        For a folder of several archives, some of which it names.
    RecordingError
        For an archive of archives, and whatever `Source.open` refuses.
    """
    source = Source.open(path)
    if source.kind is SourceKind.FILE:
        return source
    archives = [member for member in source.members if _is_archive(source, member)]
    if not archives or not all(member in archives or _is_note(source, member) for member in source.members):
        return source
    named = ", ".join(archives[:_NAMED_IN_MESSAGE]) + (", …" if len(archives) > _NAMED_IN_MESSAGE else "")
    if source.kind is SourceKind.ZIP:
        raise RecordingError(f"{source.path}: contains zip archives ({named}); unpack it and give one of them")
    if len(archives) > 1:
        raise SeveralWalksError(
            f"{source.path}: contains {len(archives)} zip archives ({named}); choose one of them", tuple(archives)
        )
    return Source.open(source.path / source.stored[archives[0]])


def _is_archive(source: Source, member: str) -> bool:
    head = source.head(member, _HEAD_BYTES)
    return head.startswith(ZIP_MAGICS) and not is_xlsx(head)


def _is_note(source: Source, member: str) -> bool:
    """Tell whether a member is text or a picture, but no table."""
    extension = Path(member).suffix.casefold()
    if extension == ".json":
        return source.head(member, 1) == b"{"  # a list may be an export
    return extension in _NOTES and (extension != ".txt" or detect_layout(source.head(member, _HEAD_BYTES)) is None)
