"""Find out how a table is written, from its first lines: separator, decimal mark, header, units, first row.

A header may stand below blank lines, comments, `sep=,` and prose, may be marked as a comment itself, or may be
absent (`header_rows`). Where commas separate cells and decimals alike, two cells are one number.
"""

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from pdr_est.io.text.cells import BLANKS, Cell, has_decimal_comma, kind_of_cell, split_line
from pdr_est.io.text.encoding import as_utf8, repair_signs
from pdr_est.io.text.header_rows import SEPARATORS, SplitLines, find_header, is_row

_LINES_LOOKED_AT = 200
_LINES_SCORED = 40
_TEXT_PENALTY = 2.0
_FEWEST_VALUES = 2.0  # numbers or dates in a row, on average


@dataclass(frozen=True)
class TableLayout:
    """Way in which a table is written.

    Attributes
    ----------
    separator
        Character between two cells; a blank stands for runs of blanks and tabs.
    decimal_comma
        True when a comma is the decimal mark.
    titles
        Titles of the columns, made distinct; "column 1" … where there is no header.
    units
        Unit of each column from a row of its own; empty when there is none.
    has_header
        True when the titles stand in the file.
    first_line
        Number of lines before the first row.
    sample
        Cells of the first row.
    preamble
        Lines before the header.
    header_line
        Number of lines before the header; -1 where there is none.
    split_decimals
        True where a comma stands between the cells and in the numbers, so that two cells of a row are one number.
    """

    separator: str
    decimal_comma: bool
    titles: tuple[str, ...]
    units: tuple[str, ...]
    has_header: bool
    first_line: int
    sample: tuple[str, ...]
    preamble: tuple[str, ...] = ()
    header_line: int = -1
    split_decimals: bool = False


@dataclass(frozen=True)
class _Scored:
    """Lines split by one separator. score: how well it fits; values: numbers and dates in a row."""

    lines: SplitLines
    score: float
    values: float

    @property
    def holds_values(self) -> bool:
        """Tell whether the rows are of a table of numbers."""
        return self.values >= _FEWEST_VALUES or self.score > 0.0


def detect_layout(head: bytes, is_unit: Callable[[str], bool] = lambda cell: False) -> TableLayout | None:
    """Detect the layout of a table from its first bytes.

    The separator is the one by which most cells of the rows become numbers or dates, and the fewest become text.

    Parameters
    ----------
    head
        Beginning of the file, at least some rows.
    is_unit
        Tells whether a cell is the name of a unit, to recognise a row of units.

    Returns
    -------
    TableLayout or None
        None when the text does not contain rows of numbers in at least two columns.
    """
    lines = _first_lines(head)
    split = _best_split(lines)
    if split is None:
        return None
    decimals = _with_whole_numbers(split, lines)
    split = decimals or split
    first = _first_row(split)
    if first is None:
        return None
    rows = [cells for cells in split.cells[first : first + _LINES_SCORED] if len(cells) == split.width]
    header = find_header(lines, split, first, is_unit)
    titles = header.titles or [f"column {i + 1}" for i in range(split.width)]
    return TableLayout(
        separator=split.separator,
        decimal_comma=_decimal_comma(rows),
        titles=_distinct([repair_signs(title).strip() for title in titles]),
        units=tuple(repair_signs(unit).strip() for unit in header.units),
        has_header=header.titles is not None,
        first_line=first,
        sample=tuple(cell.strip() for cell in split.cells[first]),
        preamble=tuple(line for line in lines[: header.above] if line.strip()),
        header_line=-1 if header.titles is None else header.above,
        split_decimals=decimals is not None,
    )


def detect_header(head: bytes) -> TableLayout | None:
    """Detect the layout of a table that has titles, also where no row stands below them.

    Returns
    -------
    TableLayout or None
        None when the text is no table or has no titles.
    """
    layout = detect_layout(head)
    if layout is not None and layout.has_header:
        return layout
    top = next((line for line in _first_lines(head) if line.strip()), "")
    separator = max(SEPARATORS[:-1], key=top.count)
    titles = [title.strip() for title in split_line(top, separator)]
    if len(titles) < 2 or not all(kind_of_cell(title) in (Cell.TEXT, Cell.MISSING) for title in titles):
        return None
    return TableLayout(separator, False, _distinct(titles), (), True, 1, (), header_line=0)


def has_split_decimals(head: bytes) -> bool:
    """Tell whether a comma stands between the cells and in the numbers of a table, so that neither can be known."""
    lines = [line for line in _first_lines(head) if line.strip()]
    if len(lines) < 2:
        return False
    titles, rows = lines[0].split(","), [line.split(",") for line in lines[1 : 1 + _LINES_SCORED]]
    named = len(titles) > 1 and not any(kind_of_cell(title) is Cell.NUMBER for title in titles)
    return named and all(
        len(titles) < len(row) <= 2 * len(titles) and all(cell.strip().lstrip("+-").isdigit() for cell in row)
        for row in rows
    )


def _first_lines(head: bytes) -> list[str]:
    text = as_utf8(head).decode("utf-8", "replace")
    lines = text.split("\n")[:_LINES_LOOKED_AT]
    cut = len(lines) > 1 and not text.endswith("\n") and len(head) > 4000
    return lines[:-1] if cut else lines


def _with_whole_numbers(split: SplitLines, lines: Sequence[str]) -> SplitLines | None:
    """Join two cells to one number where all decimals are cut off at their comma; None for other tables.

    That is certain where each row has twice as many cells as the header and every second cell has the same number of
    digits, which a sign never precedes.
    """
    titles = next((line.split(",") for line in lines if line.strip()), [])
    if split.separator != "," or split.width != 2 * len(titles) or any(map(str.isdigit, titles)):
        return None
    rows = [row for row in split.cells if len(row) == split.width and is_row(row)]
    decimals = {len(cell) for row in rows for cell in row[1::2] if cell.isdigit()}
    whole = all(cell.lstrip("+-").isdigit() for row in rows for cell in row[::2])
    if not whole or len(decimals) != 1 or any(not cell.isdigit() for row in rows for cell in row[1::2]):
        return None
    joined = [
        [f"{a}.{b}" for a, b in zip(row[::2], row[1::2], strict=True)] if len(row) == split.width else row
        for row in split.cells
    ]
    return replace(split, cells=joined, width=len(titles))


def _best_split(lines: Sequence[str]) -> SplitLines | None:
    """Find the separator that gives the most numbers and dates and the least text."""
    candidates: list[_Scored] = []
    for separator in SEPARATORS:
        if separator == BLANKS and any(split.holds_values for split in candidates):
            break  # a blank inside a date or a title must not decide
        if separator != BLANKS and not any(separator in line for line in lines):
            continue
        cells = [split_line(line, separator) if line.strip() else [] for line in lines]
        likely = [row for row in cells[-_LINES_SCORED:] if len(row) > 1 and is_row(row)]
        widths = Counter(map(len, likely))
        if not widths:
            continue
        width = max(widths, key=lambda n: (widths[n], n))
        rows = [row for row in likely if len(row) == width]
        score, values = (sum(map(rate, rows)) / len(rows) for rate in (_score, _count_values))
        candidates.append(_Scored(SplitLines(separator, cells, width), score, values))
    if not candidates:
        return None
    best = max(candidates, key=lambda split: split.score)
    return best.lines if best.holds_values else None


def _count_values(cells: Sequence[str]) -> int:
    return sum(kind_of_cell(cell) in (Cell.NUMBER, Cell.DATE) for cell in cells)


def _score(cells: Sequence[str]) -> float:
    kinds = Counter(kind_of_cell(cell) for cell in cells)
    return kinds[Cell.NUMBER] + kinds[Cell.DATE] + 0.5 * kinds[Cell.MISSING] - _TEXT_PENALTY * kinds[Cell.TEXT]


def _first_row(split: SplitLines) -> int | None:
    """Find the first row of values of the usual width, which others follow unless the table ends."""
    for i, cells in enumerate(split.cells):
        if len(cells) != split.width or not is_row(cells):
            continue
        following = [row for row in split.cells[i + 1 : i + 4] if row]
        alike = sum(len(row) == split.width for row in following)
        if 2 * alike >= len(following):
            return i
    return None


def _decimal_comma(rows: Sequence[Sequence[str]]) -> bool:
    """Tell whether numbers have commas, and none a point."""
    cells = [cell for row in rows for cell in row if kind_of_cell(cell) is Cell.NUMBER]
    return any(map(has_decimal_comma, cells)) and not any("." in cell for cell in cells)


def _distinct(titles: Sequence[str]) -> tuple[str, ...]:
    """Append numbers to repeated titles, so that each names one column."""
    seen: Counter[str] = Counter()
    result = []
    for title in titles:
        seen[title] += 1
        result.append(title if seen[title] == 1 else f"{title} ({seen[title]})")
    return tuple(result)
