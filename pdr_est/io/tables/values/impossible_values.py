"""Find rows that hold no measurement: codes for a missing value such as -9999, zeros, and spikes beyond any phone.

A single such row can decide sign and unit of a recording, which is why they are left out before anything is judged.
A code is one number in all axes, or a number that comes back far from the others; either way the rows around it are
ordinary, while a sensor that is really driven to its limit is near that limit before and after as well. Zeros in all
axes are no acceleration with gravity and no magnetic field; those of a gyroscope may be rest. The limits are ours.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array

_FEWEST_ROWS = 50  # of a recording that can be judged
_SAMPLED_ROWS = 5000  # from which the usual size and change of the values are taken
_FAR = 20.0  # times the distance of the quartiles from the median, at least
_FAR_OF_CODE = 3.0  # times as far as ordinary values may be
_CODE_ROWS = 3
_ORDINARY_SHARE = 0.8  # of the rows around a code that are ordinary
_JUMP_OF_CODE, _JUMP_OF_ONE_ROW = 3.0, 10.0  # times the 95th percentile of usual changes
_MOST_CODES = 20
_LONGEST_ZEROS_AT_WORK = 5  # rows; longer runs of a gyroscope may be rest
_LONE = 0.25  # the rows around a spike are smaller than this share of the limit
# A lone value is this many times the 95th percentile of usual changes away from both neighbours, which agree with
# each other. Accelerometers and gyroscopes of 90 real recordings of 12 data sets have 24 at most.
_LONE_JUMP, _NEIGHBOURS_APART = 40.0, 0.25
_MOST_LONE_SHARE = 0.05

Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class ImpossibleRows:
    """Rows of one sensor that hold no measurement.

    Attributes
    ----------
    rows
        (n,) which rows.
    words
        What stands in them.
    zero_is_code
        True where zeros in all axes stand for a missing value.
    """

    rows: Mask
    words: tuple[str, ...]
    zero_is_code: bool = False


def find_impossible_rows(
    columns: Sequence[NDArray[Any]], *, never_zero: bool, largest: float | None = None, lone_jumps: bool = False
) -> ImpossibleRows:
    """Find the rows of a sensor that hold no measurement.

    Parameters
    ----------
    columns
        (n,) of each axis, in any unit; NaN where a row has no value.
    never_zero
        True for a sensor that always measures something, such as gravity.
    largest
        Most that a phone can measure along an axis, in the unit of the values; None where it is not known.
    lone_jumps
        True for a sensor of motion, of which a single row never jumps far away and back.
    """
    found = np.zeros(len(columns[0]), dtype=np.bool_)
    if len(found) and not np.isfinite(sum(column.sum(dtype=np.float64) for column in columns)):
        # Rows without a value, as of a slower sensor, are no neighbours of others.
        whole = np.all([np.isfinite(column) for column in columns], axis=0)
        if not whole.all():  # else only the sum is too large
            kept = [column[whole] for column in columns]
            inner = find_impossible_rows(kept, never_zero=never_zero, largest=largest, lone_jumps=lone_jumps)
            found[whole] = inner.rows
            return replace(inner, rows=found)
    if len(found) < _FEWEST_ROWS:
        return ImpossibleRows(found, ())
    words: list[str] = []
    zero_is_code = False
    for code, rows in _equal_in_all_axes(columns):
        if code == 0.0 and not never_zero:
            continue
        if code == 0.0:
            zero_is_code = True
        elif not _is_code(columns, rows, _JUMP_OF_CODE if len(rows) >= _CODE_ROWS else _JUMP_OF_ONE_ROW):
            continue
        found[rows] = True
        words.append(f"{code:g} in all axes")
    for column in columns:
        for code, rows in _far_away(column, found):
            found[rows] = True
            words.append(f"{code:g}")
    words += _mark_lone_rows(columns, found, largest, lone_jumps)
    return ImpossibleRows(found, tuple(dict.fromkeys(words)), zero_is_code)


def without_impossible_rows(values: Array) -> Array:
    """Return the rows of an acceleration (n, 3) with gravity that are finite and hold a measurement."""
    finite = values[np.isfinite(values).all(axis=1)]
    return finite[~find_impossible_rows(list(finite.T), never_zero=True).rows] if len(finite) else finite


def rows_without_measurement(columns: Sequence[NDArray[Any]], missing: Mask, zero_is_code: bool) -> Mask:
    """Find the rows of a sensor that are empty because another sensor of the same table has no measurement there.

    Parameters
    ----------
    columns
        (n,) of each axis.
    missing
        (n,) rows in which another sensor has no measurement.
    zero_is_code
        True where zeros stand for a missing value in that other sensor.
    """
    equal = _equal(columns)
    rows: Mask = equal & missing
    if zero_is_code:
        zeros = np.flatnonzero(equal & (columns[0] == 0.0))
        first, last = _runs(zeros)
        for a, b in zip(first, last, strict=True):
            if b - a < _LONGEST_ZEROS_AT_WORK:
                rows[a : b + 1] = True
    return rows


def _equal(columns: Sequence[NDArray[Any]]) -> Mask:
    """Find the rows with one number in all axes; none for a single axis."""
    equal: Mask = np.full(len(columns[0]), len(columns) > 1)
    for column in columns[1:]:
        equal &= column == columns[0]
    return equal


def _equal_in_all_axes(columns: Sequence[NDArray[Any]]) -> Iterator[tuple[float, NDArray[np.intp]]]:
    """Iterate over numbers that all axes have at once, with their rows, those with the most rows first."""
    rows = np.flatnonzero(_equal(columns))
    if not len(rows):
        return
    values, place, counts = np.unique(columns[0][rows], return_inverse=True, return_counts=True)
    for at in np.argsort(-counts, kind="stable")[:_MOST_CODES]:
        yield float(values[at]), rows[place == at]


def _far_away(column: NDArray[Any], found: Mask) -> Iterator[tuple[float, NDArray[np.intp]]]:
    """Iterate over numbers of one axis that come back far from all others, with their rows."""
    sample = column[:: max(1, len(column) // _SAMPLED_ROWS)]
    low, middle, high = np.percentile(sample, (25.0, 50.0, 75.0))
    ordinary = _FAR * max(high - middle, middle - low)
    lowest, highest = column.min(), column.max()
    if ordinary == 0.0 or max(middle - lowest, highest - middle) <= _FAR_OF_CODE * ordinary:
        return
    away = np.abs(column - middle)
    rows = np.flatnonzero((away > _FAR_OF_CODE * ordinary) & ~found)
    values, place, counts = np.unique(column[rows], return_inverse=True, return_counts=True)
    for at in np.flatnonzero(counts >= _CODE_ROWS)[:_MOST_CODES]:
        own = rows[place == at]
        first, last = _runs(own)
        around = np.concatenate([away[first[first > 0] - 1], away[last[last < len(column) - 1] + 1]])
        if (around <= ordinary).sum() >= _ORDINARY_SHARE * len(around):
            yield float(values[at]), own


def _is_code(columns: Sequence[NDArray[Any]], rows: NDArray[np.intp], least_jump: float) -> bool:
    """Tell whether the values of some rows jump away from the rows around them more than other rows do."""
    others = np.ones(len(columns[0]), dtype=np.bool_)
    others[rows] = False
    kept = np.flatnonzero(others)
    if len(kept) < _FEWEST_ROWS:
        return False
    first, _ = _runs(rows)
    at = np.searchsorted(kept, first)
    before, after = kept[np.maximum(at - 1, 0)], kept[np.minimum(at, len(kept) - 1)]
    jumps = _distance(columns, first, before, after)
    middle = np.arange(1, len(kept) - 1, max(1, len(kept) // _SAMPLED_ROWS))
    usual = _distance(columns, kept[middle], kept[middle - 1], kept[middle + 1])
    return float(np.median(jumps)) > least_jump * max(float(np.percentile(usual, 95.0)), 1e-12)


def _distance(
    columns: Sequence[NDArray[Any]],
    rows: NDArray[np.intp],
    before: NDArray[np.intp],
    after: NDArray[np.intp],
) -> Array:
    """Compute how far (k,) rows are from the mean of two others, in the axis where it is most."""
    distance: Array = np.max([np.abs(c[rows] - 0.5 * (c[before] + c[after])) for c in columns], axis=0)
    return distance


def _mark_lone_rows(
    columns: Sequence[NDArray[Any]], found: Mask, largest: float | None, lone_jumps: bool
) -> Iterator[str]:
    """Mark single rows as found that are beyond a phone, or jump away and back; iterate over words for them."""
    spikes = np.zeros(0, dtype=np.intp) if largest is None else _spikes(columns, largest, found)
    if len(spikes):
        found[spikes] = True
        yield f"lone values beyond {largest:.3g}"
    jumps = _lone_jumps(columns, found) if lone_jumps else spikes[:0]
    if len(jumps):
        found[jumps] = True
        yield "lone values far away from those before and after"


def _spikes(columns: Sequence[NDArray[Any]], largest: float, found: Mask) -> NDArray[np.intp]:
    """Find single rows beyond what a phone can measure, with ordinary rows before and after."""
    if all(c.max() <= largest and c.min() >= -largest for c in columns):
        return np.zeros(0, dtype=np.intp)
    size = np.max([np.abs(c, dtype=np.float64) for c in columns], axis=0)
    size[found] = 0.0
    rows = np.flatnonzero(size > largest)
    before, after = np.maximum(rows - 1, 0), np.minimum(rows + 1, len(size) - 1)
    around = np.maximum(np.where(rows > 0, size[before], 0.0), np.where(rows < len(size) - 1, size[after], 0.0))
    return rows[around < _LONE * largest]


def _lone_jumps(columns: Sequence[NDArray[Any]], found: Mask) -> NDArray[np.intp]:
    """Find single rows that jump away from the rows before and after, of those that are not found yet."""
    kept = np.flatnonzero(~found)
    if len(kept) < _FEWEST_ROWS:
        return kept[:0]
    lone = np.zeros(len(kept), dtype=np.bool_)
    middle = np.arange(1, len(kept) - 1, max(1, len(kept) // _SAMPLED_ROWS))
    usual = float(np.percentile(_distance(columns, kept[middle], kept[middle - 1], kept[middle + 1]), 95.0))
    if usual == 0.0:
        return kept[:0]
    for column in columns if len(kept) == len(found) else [column[kept] for column in columns]:
        with np.errstate(over="ignore"):  # numbers near the largest ones there are
            if column.max() - column.min() <= _LONE_JUMP * usual:
                continue  # most sensors end here
            steps = np.diff(column)
        far = np.flatnonzero(np.abs(steps) > _LONE_JUMP * usual)
        at = far[:-1][np.diff(far) == 1]  # away with one step and back with the next
        away, back = steps[at], steps[at + 1]
        lone[at[np.abs(away + back) < _NEIGHBOURS_APART * np.minimum(np.abs(away), np.abs(back))] + 1] = True
    return kept[lone] if lone.mean() <= _MOST_LONE_SHARE else kept[:0]


def _runs(rows: NDArray[np.intp]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return the first and last row of each run of neighbouring rows."""
    if not len(rows):
        return rows, rows
    ends = np.flatnonzero(np.diff(rows) > 1)
    return rows[np.concatenate([[0], ends + 1])], rows[np.concatenate([ends, [len(rows) - 1]])]
