"""Convert columns that were read as text to numbers: words for a missing value, decimal commas, blanks, quotes."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import polars as pl
from numpy.typing import NDArray

from pdr_est.io.text.cells import MISSING
from pdr_est.io.text.finite_values import discard_huge_values

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
    text = column.str.strip_chars(" \t\"';")
    missing = text.is_null() | text.str.to_lowercase().is_in(list(MISSING)).fill_null(True)
    text = text.to_frame("t").select(pl.when(~missing).then(pl.col("t"))).to_series()
    integers = text.cast(pl.Int64, strict=False)
    empty = missing.to_numpy()
    nothing = np.zeros(len(text), dtype=np.bool_)
    if integers.null_count() == 0 and len(text):
        return ParsedColumn(integers.to_numpy(), empty, nothing)
    plain = text.str.replace(",", ".", literal=True)
    numbers = plain.cast(pl.Float64, strict=False)
    wrong = (numbers.is_null() & ~missing).to_numpy()
    present = int((~empty).sum())
    if wrong.sum() > _TEXT_COLUMN_SHARE * present:
        if may_be_text:
            return ParsedColumn(text.fill_null("").to_numpy().astype(np.str_), empty, nothing, is_text=True)
        return ParsedColumn(np.full(len(text), np.nan), np.ones_like(empty), nothing)
    if wrong.any() and not empty.any() and integers.null_count() == int(wrong.sum()):
        # Ticks of a clock stay exact; the damaged rows are left out later.
        return ParsedColumn(integers.fill_null(0).to_numpy(), empty, wrong)
    return ParsedColumn(discard_huge_values(numbers.cast(pl.Float64).to_numpy().astype(np.float64)), empty, wrong)
