"""Convert columns that were read as text to numbers: words for a missing value, decimal commas, blanks, quotes."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import polars as pl
from numpy.typing import NDArray

from pdr_est.io.text.cells import MISSING
from pdr_est.io.text.finite_values import discard_huge_values

_LONGEST_TEXT = 200
_TEXT_COLUMN_SHARE = 0.5  # a column of which fewer cells are numbers holds something else


@dataclass(frozen=True)
class ParsedColumn:
    """Values of a column that was read as text.

    Attributes
    ----------
    values
        (n,) numbers, int64 where all are integers, or texts.
    empty
        (n,) which cells hold no value.
    wrong
        (n,) which cells hold text among numbers.
    is_text
        True where the values are texts.
    """

    values: NDArray[Any]
    empty: NDArray[np.bool_]
    wrong: NDArray[np.bool_]
    is_text: bool = False


def parse_text_column(column: pl.Series, may_be_text: bool) -> ParsedColumn:
    """Convert text cells to numbers.

    Parameters
    ----------
    column
        (n,) texts.
    may_be_text
        True for a column that may hold dates: it stays text if most cells are no numbers. Another column of which
        most cells are no numbers has no values.
    """
    integers, text, missing = _cleaned(column)
    empty = missing.to_numpy()
    nothing = np.zeros(len(text), dtype=np.bool_)
    if integers.null_count() == 0 and len(text):
        return ParsedColumn(integers.to_numpy(), empty, nothing)
    numbers, wrong = _floats(text, missing)
    present = int((~empty).sum())
    if wrong.sum() > _TEXT_COLUMN_SHARE * present:
        if may_be_text:
            return ParsedColumn(as_texts(text), empty, nothing, is_text=True)
        return without_values(len(text))
    if wrong.any() and not empty.any() and integers.null_count() == int(wrong.sum()):
        # Ticks of a clock stay exact; the damaged rows are left out later.
        return ParsedColumn(integers.fill_null(0).to_numpy(), empty, wrong)
    return ParsedColumn(numbers, empty, wrong)


def as_texts(column: pl.Series) -> NDArray[np.str_]:
    """Return the texts of a column; "" for a missing one.

    Numpy gives every cell the room of the longest, so that one damaged cell could fill the memory: cells are cut.
    """
    return column.fill_null("").str.head(_LONGEST_TEXT).to_numpy().astype(np.str_)


def parse_numbers(column: pl.Series) -> ParsedColumn:
    """Convert text cells to numbers, however many of them are none."""
    integers, text, missing = _cleaned(column)
    if integers.null_count() == 0 and len(text):
        return ParsedColumn(integers.to_numpy(), missing.to_numpy(), np.zeros(len(text), dtype=np.bool_))
    numbers, wrong = _floats(text, missing)
    return ParsedColumn(numbers, missing.to_numpy(), wrong)


def join_numbers(parts: Sequence[ParsedColumn]) -> ParsedColumn:
    """Join parts of a column of numbers; a column of which most cells are no numbers has no values."""
    empty, wrong = (np.concatenate([getattr(one, name) for one in parts]) for name in ("empty", "wrong"))
    if wrong.sum() > _TEXT_COLUMN_SHARE * (~empty).sum():
        return without_values(len(empty))
    return ParsedColumn(np.concatenate([one.values for one in parts]), empty, wrong)


def without_values(count: int) -> ParsedColumn:
    """Return a column of empty cells."""
    return ParsedColumn(np.full(count, np.nan), np.ones(count, dtype=np.bool_), np.zeros(count, dtype=np.bool_))


def _cleaned(column: pl.Series) -> tuple[pl.Series, pl.Series, pl.Series]:
    """Return the integers in text cells, the texts without what surrounds numbers, and which cells hold no value."""
    text = column.str.strip_chars(" \t\"';\u00a0\u202f")
    missing = text.is_null() | text.str.to_lowercase().is_in(list(MISSING)).fill_null(True)
    text = text.to_frame("t").select(pl.when(~missing).then(pl.col("t"))).to_series()
    return text.cast(pl.Int64, strict=False), text, missing


def _with_points(text: pl.Series) -> pl.Series:
    """Write numbers with a point before their decimals, and nothing between thousands.

    In a column with commas and points the sign that comes last in a number is the decimal one. Two commas in one
    number can only set thousands apart, and so do the commas of a column that has whole numbers below 1000 without
    one, and none but groups of three digits behind it. Otherwise a comma is the decimal mark.
    """
    plain = text.str.replace(r"^([+-]?[\d.,]+)[dD]([+-]?\d+)$", "${1}e${2}")
    for _ in range(2):  # neighbouring groups share a digit
        plain = plain.str.replace_all(r"(\d)[ '\x{00a0}\x{202f}](\d{3})", "${1}${2}")
    if not plain.str.contains(",", literal=True).any():
        return plain
    both_american = plain.str.contains(r"\d,\d{3}(,\d{3})*\.\d*$").any()
    both_european = plain.str.contains(r"\d\.\d{3}(\.\d{3})*,\d*$").any()
    grouped = plain.str.contains(r"^[+-]?\d{1,3},\d{3},\d{3}").any()
    if (both_american or grouped or _counts_in_thousands(plain)) and not both_european:
        return plain.str.replace_all(",", "", literal=True)
    if both_european and not both_american:
        plain = plain.str.replace_all(".", "", literal=True)
    return plain.str.replace(",", ".", literal=True)


def _counts_in_thousands(text: pl.Series) -> bool:
    """Tell whether cells are whole numbers of which only those above 999 have a comma, before every third digit."""
    cells = text.drop_nulls()
    with_comma = cells.str.contains(r"^[+-]?[1-9]\d{0,2}(,\d{3})+$")
    below = cells.str.contains(r"^[+-]?\d{1,3}$")
    return bool((with_comma | below).all() and with_comma.any() and below.any())


def _floats(text: pl.Series, missing: pl.Series) -> tuple[NDArray[Any], NDArray[np.bool_]]:
    """Convert cleaned cells to numbers, and find those that are none."""
    numbers = _with_points(text).cast(pl.Float64, strict=False)
    wrong = (numbers.is_null() & ~missing).to_numpy()
    return discard_huge_values(numbers.to_numpy().astype(np.float64)), wrong
