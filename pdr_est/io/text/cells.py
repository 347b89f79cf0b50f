"""Split a line into cells, and tell what one holds: a number, a date or time, nothing, or text."""

import csv
import re
from enum import StrEnum

BLANKS = " "
"""Separator of a table whose cells are separated by runs of blanks or tabs."""

MISSING = frozenset(
    {
        *("", "-", "--", "---", "–", "—", "?", "*", "..", "...", "…", "\\n"),
        *("none", "null", "<null>", "(null)", "[null]", "nil", "void", "undefined", "missing", "invalid", "unknown"),
        *("n/a", "#n/a", "#n/a n/a", "na", "<na>", "n.a.", "n/d", "n.d.", "nd", "no data", "nodata", "empty"),
        *("nan", "-nan", "+nan", "nan(ind)", "-nan(ind)", "nat", "1.#qnan", "-1.#ind", "1.#ind", "1.#inf", "-1.#inf"),
        *("#num!", "#value!", "#div/0!", "#ref!", "#null!", "#name?", "#error!", "#zahl!", "#wert!", "#nv"),
        *("keine", "leer", "k.a.", "vide", "无", "空", "なし", "欠測", "없음"),
    }
)
"""Words for a missing value, in lower case."""

MISSING_SPELLINGS = tuple(
    {spelling for word in MISSING if word for spelling in (word, word.upper(), word.capitalize(), word.title())}
    | {"NaN", "NaT"}
)
"""The usual spellings of these words."""

GROUPED = r"[+-]?\d{1,3}(?:(?:,\d{3})+(?:\.\d*)?|(?:\.\d{3})+,\d*|(?:[ '\u00a0\u202f]\d{3})+(?:[.,]\d*)?)"
"""Regular expression of a number whose thousands are set apart, such as 1,234.5 or 1 234,5."""

_NUMBER = re.compile(r"[+-]?(\d+([.,]\d*)?|[.,]\d+)([eEdD][+-]?\d+)?|" + GROUPED)
_RUNS = re.compile(r"[ \t]+")
_LONGEST_QUOTED = 40
_INFINITE = frozenset({"inf", "-inf", "+inf", "infinity", "-infinity"})
_DATE = re.compile(
    r"\d{1,4}[-/.](\d{1,2}|[A-Za-z]{3,9}\.?)[-/.]\d{1,4}([ T_].*)?"  # 2031-02-03 …, 03-Feb-2031 …, 03.02.2031 …
    r"|\d{1,3}:\d{2}(:\d{2})?([.,:]\d+)?\s*([AaPp]\.?[Mm]\.?)?"  # 4:05:06.789
    r"|\d{8}[ T_-]\d{6}.*"  # 20310203_040506_789
    r"|[A-Z][a-z]{2},? .*\d{1,2}:\d{2}:\d{2}.*"  # Mon Feb 03 04:05:06 …
)


class Cell(StrEnum):
    """Kind of a cell."""

    NUMBER = "number"
    DATE = "date or time of day"
    MISSING = "empty"
    TEXT = "text"


def kind_of_cell(cell: str) -> Cell:
    """Find out what a cell holds."""
    text = cell.strip().strip("\"'").rstrip(";").strip()
    if text.lower() in MISSING:
        return Cell.MISSING
    if _NUMBER.fullmatch(text) or text.lower() in _INFINITE:
        return Cell.NUMBER
    return Cell.DATE if _DATE.fullmatch(text) else Cell.TEXT


def has_decimal_comma(cell: str) -> bool:
    """Tell whether a cell is a number with a comma as decimal mark."""
    text = cell.strip().strip("\"'")
    return "," in text and _NUMBER.fullmatch(text) is not None


def brief_cell(cell: object) -> str:
    """Quote a cell for a message, shortened if it is long: a damaged file may be one single cell."""
    text = str(cell)
    return repr(text) if len(text) <= _LONGEST_QUOTED else f"{text[:_LONGEST_QUOTED]!r}… ({len(text)} characters)"


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
