"""Join columns that tell the time together: whole seconds with their fraction, a date with the time of day."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import polars as pl
from numpy.typing import NDArray

from pdr_est.io.conversion.units import Conversion
from pdr_est.io.tables.mapping import ClockColumn
from pdr_est.io.tables.times.scripts import with_usual_marks
from pdr_est.io.text.loose_table import LooseTable

_FRACTIONS = (10**3, 10**6, 10**9)
_LONGEST_DATE = 11


def with_fractions(loose: LooseTable, columns: Sequence[ClockColumn]) -> list[ClockColumn]:
    """Join whole seconds with the column that has their fraction, and a date with the time of day beside it."""
    usable = [column for column in columns if column.title in loose.table]
    fractions = [column for column in usable if _fraction_size(loose, column.title) is not None]
    dates = _dates_without_time(loose, usable)
    result = []
    for column in usable:
        if column.fraction:
            result.append(column)
            continue
        if column in dates:
            partner = next(
                (other for other in usable if other is not column and other.title in loose.text_columns), None
            )
            result += [replace(column, fraction=partner.title)] if partner is not None else []
            continue
        if column in fractions:
            continue
        fine = next((other for other in fractions if _counts_up(loose, column.title, other.title)), None)
        result.append(column if fine is None else replace(column, fraction=fine.title))
    return result


def _dates_without_time(loose: LooseTable, columns: Sequence[ClockColumn]) -> list[ClockColumn]:
    """Find text columns with dates that have no time of day."""
    texts = [column for column in columns if column.title in loose.text_columns]
    return [column for column in texts if _is_bare_date(loose.table.texts(column.title))]


def _is_bare_date(texts: NDArray[np.str_]) -> bool:
    filled = texts[texts != ""]
    if not len(filled):
        return False
    first = str(with_usual_marks(pl.Series([str(filled[0])]))[0])
    return ":" not in first and first[:1].isdigit() and len(first) <= _LONGEST_DATE


def _fraction_size(loose: LooseTable, title: str) -> int | None:
    """Return the number of ticks in a second of a column that starts anew every second; None for other columns."""
    if title in loose.text_columns:
        return None
    ticks = loose.table.columns[title]
    if ticks.dtype.kind != "i" or not len(ticks) or ticks.min() < 0:
        return None
    largest = int(ticks.max())
    size = next((size for size in _FRACTIONS if largest < size), None)
    falls = int((np.diff(ticks) < 0).sum())
    return size if size is not None and falls >= 2 and largest >= size // 2 else None


def _counts_up(loose: LooseTable, coarse: str, fine: str) -> bool:
    """Tell whether a column changes about as often as another one starts anew."""
    column = loose.table.columns[coarse]
    changes = int((column[1:] != column[:-1]).sum())
    falls = int((np.diff(loose.table.columns[fine]) < 0).sum())
    return 0 < changes <= falls + 1 and falls <= changes + 1


def joined_ticks(
    loose: LooseTable, column: ClockColumn, seconds: NDArray[Any], known: NDArray[np.bool_]
) -> tuple[NDArray[Any], Conversion]:
    """Join whole seconds and their fraction to nanoseconds; 0 in rows that are not known."""
    part_ns = fraction_ns(loose.table.columns[column.fraction])
    ticks = np.floor(np.where(known, seconds, 0)).astype(np.int64) * 10**9 + part_ns
    return ticks, Conversion(
        1e-9, f"the clock counts seconds in {column.title} with their fraction in {column.fraction}"
    )


def fraction_ns(ticks: NDArray[Any]) -> NDArray[np.int64]:
    """Convert fractions of a second (n,), in ms, us or ns by the size of the largest, to ns."""
    whole = np.where(np.isfinite(ticks), ticks, 0).astype(np.int64)
    largest = int(whole.max()) if len(whole) else 0
    size = next((size for size in _FRACTIONS if largest < size), 10**9)
    fraction: NDArray[np.int64] = whole * (10**9 // size)
    return fraction
