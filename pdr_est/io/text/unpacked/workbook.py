"""Open an Excel workbook as a folder of tables, one for each sheet, so that every format can be in it."""

import csv
import io
from collections.abc import Iterable
from datetime import date, datetime, time
from typing import Any

from pdr_est.errors import RecordingError
from pdr_est.io.text.container import ZIP_MAGICS, Source, SourceKind
from pdr_est.io.text.unpacked.tables_source import source_of_tables

_XLS_MAGIC = b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1"
_XLSX_PARTS = (b"[Content_Types].xml", b"xl/")


def unpack_workbook(source: Source) -> Source:
    """Return the sheets of a workbook as a source of tables; any other source as it is.

    Raises
    ------
    RecordingError
        When the package that reads workbooks is not installed, or the workbook is damaged.
    """
    if len(source.members) != 1 and source.kind is not SourceKind.ZIP:
        return source
    data = _workbook_bytes(source)
    if data is None:
        return source
    sheets = dict(_read_sheets(data, str(source.path)))
    if not sheets:
        raise RecordingError(f"{source.path}: the workbook has no cells; export the recording again")
    return source_of_tables(source, sheets, "sheet")


def _workbook_bytes(source: Source) -> bytes | None:
    """Read the workbook that a source is or holds; None when it is something else."""
    if source.kind is SourceKind.ZIP and source.path.is_file():
        with source.path.open("rb") as stream:
            head = stream.read(2048)
        if not is_xlsx(head):
            return None
        for part in source.members:
            source.read(part)  # a part that is larger than it claims would fill the memory
        return source.path.read_bytes()
    member = source.members[0]
    head = source.head(member, 2048)
    return source.read(member) if head.startswith(_XLS_MAGIC) or is_xlsx(head) else None


def is_xlsx(head: bytes) -> bool:
    """Tell whether a file is a workbook, which is a zip archive, too, by its first 2048 bytes."""
    return head.startswith(ZIP_MAGICS) and any(part in head for part in _XLSX_PARTS)


def _read_sheets(data: bytes, place: str) -> Iterable[tuple[str, bytes]]:
    try:
        import python_calamine
    except ImportError as error:
        raise RecordingError(
            f"{place}: an Excel workbook, which needs python-calamine: `pip install pdr-est[xls]`, or export the "
            "recording as CSV"
        ) from error
    try:
        workbook = python_calamine.CalamineWorkbook.from_filelike(io.BytesIO(data))
        tables = [(name, workbook.get_sheet_by_name(name).to_python()) for name in workbook.sheet_names]
    except (python_calamine.CalamineError, OSError) as error:
        raise RecordingError(f"{place}: damaged Excel workbook ({error}); export it again") from error
    return [(name, _as_csv(rows)) for name, rows in tables if rows]


def _as_csv(rows: Iterable[Iterable[Any]]) -> bytes:
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows([_cell(value) for value in row] for row in rows)
    return text.getvalue().encode()


def _cell(value: Any) -> Any:
    """Write dates with a fraction of a second, which a recording needs."""
    if isinstance(value, datetime):
        return value.isoformat(" ", "microseconds")
    return value.isoformat() if isinstance(value, date | time) else value
