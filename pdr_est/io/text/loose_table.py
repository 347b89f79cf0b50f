"""Parse a table whose layout was detected: fast where it is clean, and with damaged rows left out where it is not.

The ordinary way is one pass of polars over the wanted columns. Only where that fails, the cells are read as text:
words for a missing value, decimal commas, blanks and quotes are then understood, and rows that are cut, too long or
hold text where the others hold numbers are left out and told with their line numbers.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import polars as pl
from numpy.typing import NDArray

from pdr_est.errors import RecordingError
from pdr_est.io.text.cells import BLANKS, MISSING_SPELLINGS
from pdr_est.io.text.finite_values import discard_huge_values
from pdr_est.io.text.number_table import NumberTable
from pdr_est.io.text.table_layout import TableLayout
from pdr_est.io.text.text_columns import ParsedColumn, parse_text_column
from pdr_est.io.text.whole_rows import WholeRows, pieces_of_lines

_LARGEST_DAMAGED_SHARE = 0.05
_LINES_NAMED = 3
_LAYOUT_ROWS = 100


@dataclass(frozen=True)
class LooseTable:
    """Table with what was noticed while it was read.

    Attributes
    ----------
    table
        The wanted columns: numbers, or text where a column that may hold times has dates.
    text_columns
        Titles of the columns that are text.
    warnings
        Rows that were left out, in words.
    """

    table: NumberTable
    text_columns: frozenset[str]
    warnings: tuple[str, ...] = ()

    def only(self, rows: NDArray[np.bool_] | slice, place: str = "") -> "LooseTable":
        """Return the table with some of its rows, as that of another place if one is given."""
        table = NumberTable(
            place or self.table.place,
            {title: column[rows] for title, column in self.table.columns.items()},
            {title: cells[rows] for title, cells in self.table.empty.items()},
        )
        return LooseTable(table, self.text_columns, self.warnings)


def read_loose_table(
    data: bytes, place: str, layout: TableLayout, numbers: Sequence[str], times: Sequence[str] = ()
) -> LooseTable:
    """Read the wanted columns of a table.

    Parameters
    ----------
    data
        Whole content in UTF-8 (`encoding.as_utf8`).
    place
        Name of the file, for messages.
    layout
        How the table is written.
    numbers
        Titles of the columns that hold numbers.
    times
        Titles of the columns that hold numbers or, if not, text such as dates.

    Raises
    ------
    RecordingError
        When there are no rows, or more than 5 % of them are damaged.
    """
    body = _body(data, layout)
    if not len(body):
        raise RecordingError(f"{place}: the table has no rows below its header; record again")
    wanted = [title for title in layout.titles if title in set(numbers) | set(times)]
    frame = _fast(_in_place(data, body, layout), body, layout, wanted, set(times))
    if frame is not None:
        table, texts = _from_frame(frame, place, wanted)
        return LooseTable(table, texts)
    return _piece_by_piece(body, place, layout, wanted, set(times))


def _body(data: bytes, layout: TableLayout) -> memoryview:
    """Cut off what stands above the first row and the blank end, and bring runs of blanks to one."""
    start = 0
    for _ in range(layout.first_line):
        start = data.find(b"\n", start) + 1
    end = _end_of_rows(data, start)
    if layout.separator == BLANKS:
        body = data[start:end].replace(b"\t", b" ")
        while b"  " in body:
            body = body.replace(b"  ", b" ")
        return memoryview(body.replace(b"\n ", b"\n").replace(b" \n", b"\n").lstrip(b" "))
    if layout.split_decimals:
        return memoryview(_with_points(data[start:end], len(layout.titles)))
    return memoryview(data)[start:end]


def _end_of_rows(data: bytes, start: int) -> int:
    """Find the end of the last line that is not blank: tabs at its end are empty cells."""
    end = len(data)
    while end > start and data[end - 1] in b"\n \t":
        end -= 1
    line_end = data.find(b"\n", end)
    return len(data) if line_end < 0 else line_end


def _with_points(body: bytes, width: int) -> bytes:
    """Put a point where a comma cuts the decimals off; rows of another length stay as they are, to be reported."""
    lines = []
    for line in body.split(b"\n"):
        cells = line.split(b",")
        whole = len(cells) == 2 * width
        lines.append(b",".join(map(b".".join, zip(cells[::2], cells[1::2], strict=True))) if whole else line)
    return b"\n".join(lines)


def _names(layout: TableLayout) -> list[str]:
    return [f"c{i}" for i in range(len(layout.titles))]


def _in_place(data: bytes, body: memoryview, layout: TableLayout) -> tuple[bytes, list[str]]:
    """Return what polars parses and its names of the columns: the file as it is if possible, to copy nothing."""
    top = data.find(b"\n") + 1
    plain = (
        layout.header_line == 0
        and layout.first_line == 1
        and layout.separator != BLANKS
        and not layout.split_decimals
    )
    if plain and len(data) - top <= len(body) + 1:
        names = pl.read_csv(data[:top], separator=layout.separator, n_rows=0).columns
        if len(names) == len(layout.titles):
            return data, names
    return _with_plain_header(body, layout), _names(layout)


def _with_plain_header(body: memoryview, layout: TableLayout) -> bytes:
    return b"".join((layout.separator.join(_names(layout)).encode(), b"\n", body))


def _fast(
    source: tuple[bytes, list[str]], body: memoryview, layout: TableLayout, wanted: Sequence[str], times: set[str]
) -> pl.DataFrame | None:
    """Parse the wanted columns in one pass; None where a cell is no number or a row has another length."""
    if layout.decimal_comma and layout.separator == ",":
        return None
    content, in_file = source
    # A quote that is not closed would make one cell of all that follows; to find none is faster than to count them.
    if b'"' in content and content.count(b'"') % 2 == 1:
        return None
    names = dict(zip(layout.titles, in_file, strict=True))
    last = in_file[-1]
    types: dict[str, Any] = {names[title]: pl.Float64 for title in wanted if title not in times}
    if all(names[title] != last for title in wanted):
        types[last] = pl.String
    try:
        frame = pl.read_csv(
            content,
            separator=layout.separator,
            columns=list(dict.fromkeys([*(names[title] for title in wanted), last])),
            schema_overrides=types,
            decimal_comma=layout.decimal_comma,
            infer_schema_length=_LAYOUT_ROWS,
        )
    except (pl.exceptions.PolarsError, ValueError):
        return None
    if frame[last].null_count() and _has_short_rows(body, layout, frame[last]):
        return None
    return frame.select(names[title] for title in wanted)


def _has_short_rows(body: memoryview, layout: TableLayout, last: pl.Series) -> bool:
    """Tell whether rows whose last cell is empty lack separators, too, or whether rows are blank."""
    lines = bytes(body).split(b"\n")
    if len(lines) != len(last):
        return True
    separator = layout.separator.encode()
    fewest = len(layout.titles) - 1
    return any(lines[i].count(separator) < fewest for i in np.flatnonzero(last.is_null().to_numpy()))


def _from_frame(frame: pl.DataFrame, place: str, wanted: Sequence[str]) -> tuple[NumberTable, frozenset[str]]:
    arrays: dict[str, NDArray[Any]] = {}
    empty: dict[str, NDArray[np.bool_]] = {}
    texts = set()
    for title, column in zip(wanted, frame.get_columns(), strict=True):
        if column.dtype == pl.String:
            parsed = parse_text_column(column, may_be_text=True)
            arrays[title] = parsed.values
            if parsed.is_text:
                texts.add(title)
            cells = parsed.empty
        else:
            nulls = column.is_null() if column.null_count() else None
            arrays[title] = _as_array(column)
            cells = np.zeros(0, dtype=np.bool_) if nulls is None else nulls.to_numpy()
        if cells.any():
            empty[title] = cells
    return NumberTable(place, arrays, empty), frozenset(texts)


def _as_array(column: pl.Series) -> NDArray[Any]:
    """Return int64 where all values are integers that fit, else float64 with NaN for missing values."""
    if column.dtype.is_integer() and not column.null_count():
        integers = column.cast(pl.Int64, strict=False)
        if not integers.null_count():
            return integers.to_numpy()
    return discard_huge_values(column.cast(pl.Float64).to_numpy().astype(np.float64, copy=False))


def _as_text(body: memoryview, layout: TableLayout, wanted: Sequence[str]) -> dict[str, pl.Series] | None:
    """Read the wanted columns as text; None where rows differ in length, are blank or are comments."""
    text = bytes(body)
    if text.startswith(b"#") or b"\n#" in text:
        return None
    names = dict(zip(layout.titles, _names(layout), strict=True))
    last = _names(layout)[-1]
    columns = list(dict.fromkeys([*(names[title] for title in wanted), last]))
    try:
        frame = pl.read_csv(
            _with_plain_header(body, layout),
            separator=layout.separator,
            columns=columns,
            infer_schema=False,
            null_values=list(MISSING_SPELLINGS),
        )
    except (pl.exceptions.PolarsError, ValueError):
        return None
    if len(frame) != text.count(b"\n") + 1 or (
        frame[last].null_count() and _has_short_rows(body, layout, frame[last])
    ):
        return None
    return {title: frame[names[title]] for title in wanted}


def _assembled(parsed: Mapping[str, ParsedColumn], place: str, warnings: tuple[str, ...]) -> LooseTable:
    arrays = {title: one.values for title, one in parsed.items()}
    empty = {title: one.empty for title, one in parsed.items() if one.empty.any()}
    texts = frozenset(title for title, one in parsed.items() if one.is_text)
    return LooseTable(NumberTable(place, arrays, empty), texts, warnings)


def _piece_by_piece(
    body: memoryview, place: str, layout: TableLayout, wanted: Sequence[str], times: set[str]
) -> LooseTable:
    """Read the table piece by piece and leave out the damaged rows."""
    rows = WholeRows(layout, [title for title in wanted if title not in times], [t for t in wanted if t in times])
    for piece in pieces_of_lines(body):
        columns = _as_text(piece, layout, wanted)
        if columns is None:
            rows.add_lines(piece)
        else:
            rows.add_columns(columns)
    parsed, lines, faults = rows.parsed()
    wrong = np.any([one.wrong for one in parsed.values()], axis=0) if parsed else np.zeros(len(lines), dtype=np.bool_)
    damaged = rows.damaged | faults
    number = int(wrong.sum()) + len(rows.damaged)
    total = number + int((~wrong).sum())
    named = ", ".join(f"line {line}: {fault}" for line, fault in sorted(damaged.items())[:_LINES_NAMED])
    if number > max(1.0, _LARGEST_DAMAGED_SHARE * total):
        raise RecordingError(f"{place}: {number} of {total} rows are damaged ({named}); export the recording again")
    kept = ~wrong
    clean = {
        title: ParsedColumn(one.values[kept], one.empty[kept], one.wrong[kept], one.is_text)
        for title, one in parsed.items()
    }
    warnings = (f"{number} of {total} rows are damaged and left out ({named})",) if number else ()
    return _assembled(clean, place, warnings)
