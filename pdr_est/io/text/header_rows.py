"""Find the titles of a table above its first row: one or two header lines, rows of units and of types.

Two header lines, of which the upper one names a sensor over several axes, become one title a column. A sensor that
stands over merged cells is written once and holds for the empty cells to its right.
"""

import re
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from pdr_est.io.text.cells import BLANKS, Cell, kind_of_cell, split_line

SEPARATORS = ("\t", ";", ",", "|", BLANKS)
"""Characters that may separate cells, in the order in which they are tried."""

_SEP_LINE = re.compile(r'"?sep=(.)"?', re.IGNORECASE)
_COMMENT = re.compile(r"^\s*(#|%|//)+\s*")
_LINES_SCORED = 40
_SEARCH_LINES = 6
_FEWEST_UNITS = 2  # of a row in which other cells name no unit that is known
_AXES = frozenset("xyzw")
# Cells of a row of types or units that name no unit.
_TYPES = frozenset(
    {
        *("", "-", "--", "none", "null", "n/a", "na", "nan", "no_units", "no units", "nounits", "unitless", "text"),
        *("float", "float16", "float32", "float64", "double", "real", "number", "numeric", "decimal", "single"),
        *(
            "int",
            "int8",
            "int16",
            "int32",
            "int64",
            "uint8",
            "uint16",
            "uint32",
            "uint64",
            "integer",
            "long",
            "short",
        ),
        *("string", "str", "object", "char", "varchar", "bool", "boolean", "categorical", "category", "byte", "long"),
        *("datetime", "datetime64", "datetime64[ns]", "date", "timestamp", "time"),
    }
)


@dataclass(frozen=True)
class SplitLines:
    """Lines of a table split into cells.

    Attributes
    ----------
    separator
        Character between two cells.
    cells
        Cells of each line.
    width
        Number of cells of the rows.
    """

    separator: str
    cells: Sequence[list[str]]
    width: int


@dataclass(frozen=True)
class HeaderRows:
    """Titles above the rows.

    Attributes
    ----------
    titles
        Titles of the columns; None without a header.
    units
        Units of a row of their own, or nothing.
    above
        Number of lines above the header.
    """

    titles: list[str] | None
    units: list[str]
    above: int


def find_header(lines: Sequence[str], split: SplitLines, first: int, is_unit: Callable[[str], bool]) -> HeaderRows:
    """Look upwards from the first row for titles and units.

    Parameters
    ----------
    lines
        Lines of the table.
    split
        The same lines split into cells.
    first
        Number of lines above the first row.
    is_unit
        Tells whether a cell is the name of a unit, or empty.
    """
    found: list[tuple[int, list[str]]] = []
    for at in range(first - 1, max(-1, first - 1 - _SEARCH_LINES), -1):
        line = lines[at]
        if not line.strip() or _SEP_LINE.fullmatch(line.strip()):
            continue
        cells = _header_cells(line, split)
        if cells is not None:
            found.append((at, cells))
    units: list[str] = []
    for i, (at, cells) in enumerate(found):
        bare = [cell.strip("[](){} ") for cell in cells]
        if _are_units(bare, is_unit, others_above=any(not _are_types(c) for _, c in found[i + 1 : i + 2])):
            units = units or ([] if _are_types(bare) else cells)
            continue
        if i + 1 < len(found):
            joined = _joined(found[i + 1][1], cells)
            if joined is not None:
                return HeaderRows(joined, units, found[i + 1][0])
        return HeaderRows(cells, units, at)
    return HeaderRows(None, units, first)


def is_row(cells: Sequence[str]) -> bool:
    """Tell whether cells look like a row of values: some number, and at least as much that is no text as text."""
    kinds = [kind_of_cell(cell) for cell in cells]
    known = sum(kind is not Cell.TEXT for kind in kinds)
    return Cell.NUMBER in kinds and 2 * known >= len(kinds)


def _are_units(cells: Sequence[str], is_unit: Callable[[str], bool], others_above: bool) -> bool:
    """Tell whether cells are a row of units or types: all, or half of those that are no types below other titles."""
    filled = [cell for cell in cells if cell]
    if 2 * len(filled) < len(cells):
        return False
    if all(is_unit(cell) or cell.lower() in _TYPES for cell in filled):
        return True
    telling = [cell for cell in filled if cell.lower() not in _TYPES]
    real = [cell for cell in telling if is_unit(cell)]
    return others_above and len(real) >= _FEWEST_UNITS and 2 * len(real) >= len(telling)


def _are_types(cells: Sequence[str]) -> bool:
    return all(cell.lower() in _TYPES for cell in cells)


def _joined(upper: Sequence[str], lower: Sequence[str]) -> list[str] | None:
    """Join a line of sensors and the line of axes below it; None where the lower line names its columns alone."""
    names = [cell.strip().lower() for cell in lower if cell.strip()]
    if max(Counter(names).values(), default=0) < 2 and len(_AXES & set(names)) < 2:
        return None
    above = [cell.strip() for cell in upper]
    filled = [cell for cell in above if cell]
    if len(filled) == len(above) and len(set(filled)) == len(filled):
        return None  # a line of other titles
    titles, current = [], ""
    for top, bottom in zip(above, (cell.strip() for cell in lower), strict=True):
        current = top or (current if bottom else "")
        titles.append(" ".join(part for part in (current, bottom) if part))
    return titles


def _header_cells(line: str, split: SplitLines) -> list[str] | None:
    """Split a line into as many titles as the rows have cells; None when it is no header."""
    bare = _COMMENT.sub("", line)
    others = [other for other in SEPARATORS if other != split.separator]
    # The titles above rows with blanks may be separated by commas.
    for separator in (*others, BLANKS) if split.separator == BLANKS else (split.separator, *others):
        raw = split_line(bare.strip("\n"), separator)
        cells = [cell.strip().strip("\"'") for cell in raw]
        if separator != split.separator and not _are_titles(cells):
            continue
        fitted = _fitted(cells, split) or _with_units_behind_commas(raw, split)
        if fitted is not None and any(any(c.isalpha() for c in cell) for cell in fitted):
            return fitted
    return None


def _are_titles(cells: Sequence[str]) -> bool:
    """Tell whether cells can be titles, rather than the words of a remark such as `Subject ID: 1`."""
    return all(any(c.isalpha() for c in cell) and not cell.endswith(":") for cell in cells)


def _fitted(cells: list[str], split: SplitLines) -> list[str] | None:
    """Fit titles to the width of the rows: an empty last column may lack a title, a row number in front, too."""
    if len(cells) == split.width:
        return cells
    if len(cells) == split.width + 1 and not cells[-1]:
        return cells[:-1]
    if len(cells) == split.width - 1 and split.width > 2:
        rows = [row for row in split.cells if len(row) == split.width and is_row(row)][:_LINES_SCORED]
        date = _date_with_time(rows)
        if date is not None:
            return [*cells[: date + 1], f"{cells[date]} (time of day)", *cells[date + 1 :]]
        if all(not row[-1].strip() for row in rows):
            return [*cells, ""]
        if all(row[0].strip().strip('"').isdigit() for row in rows):
            return ["", *cells]
    return None


def _with_units_behind_commas(cells: Sequence[str], split: SplitLines) -> list[str] | None:
    """Join `acc_x, m/s^2`, which the separator cut in two, where the rows then have as many cells."""
    titles: list[str] = []
    for cell in cells:
        if titles and cell.startswith(" "):
            titles[-1] = f"{titles[-1]},{cell.rstrip()}"
        else:
            titles.append(cell.strip())
    return titles if len(cells) > len(titles) == split.width else None


def _date_with_time(rows: Sequence[Sequence[str]]) -> int | None:
    """Find the cell of a date that is followed by the time of day, because a blank separates them, too."""
    for at in range(len(rows[0]) - 1 if rows else 0):
        pairs = [(row[at], row[at + 1]) for row in rows]
        if all(":" not in day and ":" in time and _is_date(day) and _is_date(time) for day, time in pairs):
            return at
    return None


def _is_date(cell: str) -> bool:
    return kind_of_cell(cell) is Cell.DATE
