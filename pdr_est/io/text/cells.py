"""Tell what one cell of a table holds: a number, a date or time, nothing, or text."""

import re
from enum import StrEnum

MISSING = frozenset(
    {
        "",
        "-",
        "--",
        "none",
        "null",
        "nil",
        "n/a",
        "#n/a",
        "na",
        "<na>",
        "nan",
        "undefined",
        "?",
        "missing",
        "n.a.",
        "keine",
        "-nan",
    }
)
"""Words for a missing value, in lower case."""

MISSING_SPELLINGS = tuple(
    {spelling for word in MISSING if word for spelling in (word, word.upper(), word.capitalize(), word.title())}
    | {"NaN", "NaT"}
)
"""The usual spellings of these words."""

_NUMBER = re.compile(r"[+-]?(\d+([.,]\d*)?|[.,]\d+)([eE][+-]?\d+)?")
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
