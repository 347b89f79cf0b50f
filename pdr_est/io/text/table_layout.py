"""Find out how a table is written, from its first lines: separator, decimal mark, header, units, first row.

A header may stand below blank lines, comments, `sep=,` and prose, may be marked as a comment itself, or may be
absent. Rows of units below it are recognised where every cell is a unit.
"""

import csv
import re
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from pdr_est.io.text.cells import Cell, has_decimal_comma, kind_of_cell
from pdr_est.io.text.encoding import as_utf8, repair_signs

BLANKS = " "
"""Separator of a table whose cells are separated by runs of blanks or tabs."""

_SEPARATORS = ("\t", ";", ",", "|", BLANKS)
_RUNS = re.compile(r"[ \t]+")
_SEP_LINE = re.compile(r'"?sep=(.)"?', re.IGNORECASE)
_COMMENT = re.compile(r"^\s*(#|%|//)+\s*")
_LINES_LOOKED_AT = 200
_LINES_SCORED = 40
_HEADER_SEARCH_LINES = 6
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


@dataclass(frozen=True)
class _Split:
    """Lines split by one separator, with the usual number of cells; `values`: numbers and dates in a row."""

    separator: str
    cells: Sequence[list[str]]
    width: int
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
    text = as_utf8(head).decode("utf-8", "replace")
    lines = text.split("\n")[:_LINES_LOOKED_AT]
    if len(lines) > 1 and not text.endswith("\n") and len(head) > 4000:
        lines = lines[:-1]  # cut in the middle
    split = _best_split(lines)
    if split is None:
        return None
    first = _first_row(split)
    if first is None:
        return None
    rows = [cells for cells in split.cells[first : first + _LINES_SCORED] if len(cells) == split.width]
    header, units, above = _find_header(lines, split, first, is_unit)
    titles = header or [f"column {i + 1}" for i in range(split.width)]
    return TableLayout(
        separator=split.separator,
        decimal_comma=_decimal_comma(rows),
        titles=_distinct([repair_signs(title).strip() for title in titles]),
        units=tuple(repair_signs(unit).strip() for unit in units),
        has_header=header is not None,
        first_line=first,
        sample=tuple(cell.strip() for cell in split.cells[first]),
        preamble=tuple(line for line in lines[:above] if line.strip()),
        header_line=-1 if header is None else above,
    )


def split_line(line: str, separator: str) -> list[str]:
    """Split a line into cells, with quotes respected."""
    if separator == BLANKS:
        line = _RUNS.sub(" ", line.strip())
    if '"' not in line:
        return line.split(separator)
    try:
        return next(csv.reader([line], delimiter=separator, skipinitialspace=True), [])
    except csv.Error:
        return line.split(separator)


def _best_split(lines: Sequence[str]) -> _Split | None:
    """Find the separator that gives the most numbers and dates and the least text."""
    candidates: list[_Split] = []
    for separator in _SEPARATORS:
        if separator == BLANKS and any(split.holds_values for split in candidates):
            break  # a blank inside a date or a title must not decide
        if separator != BLANKS and not any(separator in line for line in lines):
            continue
        cells = [split_line(line, separator) if line.strip() else [] for line in lines]
        likely = [row for row in cells[-_LINES_SCORED:] if len(row) > 1 and _is_row(row)]
        widths = Counter(map(len, likely))
        if not widths:
            continue
        width = max(widths, key=lambda n: (widths[n], n))
        rows = [row for row in likely if len(row) == width]
        score, values = (sum(map(rate, rows)) / len(rows) for rate in (_score, _count_values))
        candidates.append(_Split(separator, cells, width, score, values))
    if not candidates:
        return None
    best = max(candidates, key=lambda split: split.score)
    return best if best.holds_values else None


def _is_row(cells: Sequence[str]) -> bool:
    """Tell whether cells look like a row of values: some number, and at least as much that is no text as text."""
    kinds = [kind_of_cell(cell) for cell in cells]
    known = sum(kind is not Cell.TEXT for kind in kinds)
    return Cell.NUMBER in kinds and 2 * known >= len(kinds)


def _count_values(cells: Sequence[str]) -> int:
    return sum(kind_of_cell(cell) in (Cell.NUMBER, Cell.DATE) for cell in cells)


def _score(cells: Sequence[str]) -> float:
    kinds = Counter(kind_of_cell(cell) for cell in cells)
    return kinds[Cell.NUMBER] + kinds[Cell.DATE] + 0.5 * kinds[Cell.MISSING] - _TEXT_PENALTY * kinds[Cell.TEXT]


def _first_row(split: _Split) -> int | None:
    """Find the first row of values of the usual width, which others follow unless the table ends."""
    for i, cells in enumerate(split.cells):
        if len(cells) != split.width or not _is_row(cells):
            continue
        following = [row for row in split.cells[i + 1 : i + 4] if row]
        alike = sum(len(row) == split.width for row in following)
        if 2 * alike >= len(following):
            return i
    return None


def _find_header(
    lines: Sequence[str], split: _Split, first: int, is_unit: Callable[[str], bool]
) -> tuple[list[str] | None, list[str], int]:
    """Look upwards from the first row for titles and units.

    Returns
    -------
    titles : list of str or None
        None without a header.
    units : list of str
        Units of a row of their own, or nothing.
    above : int
        Number of lines above the header.
    """
    units: list[str] = []
    for at in range(first - 1, max(-1, first - 1 - _HEADER_SEARCH_LINES), -1):
        line = lines[at]
        if not line.strip() or _SEP_LINE.fullmatch(line.strip()):
            continue
        cells = _header_cells(line, split)
        if cells is None:
            continue
        if not units and _is_units_row(cells, is_unit):
            units = cells
            continue
        return cells, units, at
    return None, units, first


def _header_cells(line: str, split: _Split) -> list[str] | None:
    """Split a line into as many titles as the rows have cells; None when it is no header."""
    bare = _COMMENT.sub("", line)
    others = [other for other in _SEPARATORS if other != split.separator]
    # The titles above rows with blanks may be separated by commas.
    for separator in (*others, BLANKS) if split.separator == BLANKS else (split.separator, *others):
        cells = [cell.strip().strip("\"'") for cell in split_line(bare.strip("\n"), separator)]
        if separator != split.separator and not _are_titles(cells):
            continue
        fitted = _fitted(cells, split)
        if fitted is not None and any(any(c.isalpha() for c in cell) for cell in fitted):
            return fitted
    return None


def _are_titles(cells: Sequence[str]) -> bool:
    """Tell whether cells can be titles, rather than the words of a remark such as `Subject ID: 1`."""
    return all(any(c.isalpha() for c in cell) and not cell.endswith(":") for cell in cells)


def _fitted(cells: list[str], split: _Split) -> list[str] | None:
    """Fit titles to the width of the rows: an empty last column may lack a title, a row number in front, too."""
    if len(cells) == split.width:
        return cells
    if len(cells) == split.width + 1 and not cells[-1]:
        return cells[:-1]
    if len(cells) == split.width - 1 and split.width > 2:
        rows = [row for row in split.cells if len(row) == split.width and _is_row(row)][:_LINES_SCORED]
        date = _date_with_time(rows)
        if date is not None:
            return [*cells[: date + 1], f"{cells[date]} (time of day)", *cells[date + 1 :]]
        if all(not row[-1].strip() for row in rows):
            return [*cells, ""]
        if all(row[0].strip().strip('"').isdigit() for row in rows):
            return ["", *cells]
    return None


def _date_with_time(rows: Sequence[Sequence[str]]) -> int | None:
    """Find the cell of a date that is followed by the time of day, because a blank separates them, too."""
    for at in range(len(rows[0]) - 1 if rows else 0):
        pairs = [(row[at], row[at + 1]) for row in rows]
        if all(":" not in day and ":" in time and _is_date(day) and _is_date(time) for day, time in pairs):
            return at
    return None


def _is_date(cell: str) -> bool:
    return kind_of_cell(cell) is Cell.DATE


def _is_units_row(cells: Sequence[str], is_unit: Callable[[str], bool]) -> bool:
    """Tell whether all cells are units, with or without brackets, at least half of them not empty."""
    bare = [cell.strip("[]() ") for cell in cells]
    return 2 * sum(bool(cell) for cell in bare) >= len(bare) and all(is_unit(cell) for cell in bare)


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
