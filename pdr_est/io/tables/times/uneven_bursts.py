"""Spread bursts of varying size: find the constant rate at which their rows were measured.

A recorder that collects samples until it has time to hand them over gives all of a burst one stamp: that of the first
one, that of the last one, or that at which they arrived. The rows were measured at a steady rate nevertheless, which
the stamps of many bursts together show.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array

_DIFFERENT = 0.1  # ours: share of the usual size, and half a row, by which a burst is of another size
_DIFFERENT_ROWS = 0.5
_UNEVEN_SHARE = 0.2  # ours: of the bursts have another size than usual; the ends of a gap are fewer
_FEWEST_BURSTS = 8
_MOST_SCATTER = 0.5  # ours: of the time between two stamps; random stamps have 0.6
_LAG = 20  # bursts over which a rate is measured
_WINDOW = 21  # bursts whose median tells the time of the middle one, to follow a rate that drifts
_GAP_S = 0.5  # ours: more than a burst is late
_GAP_STEPS = 5.0


@dataclass(frozen=True)
class SteadyTimes:
    """Times of rows at a steady rate.

    Attributes
    ----------
    time_s
        (n,) s, from the first row to the last.
    rate_hz
        Rows a second, Hz.
    by_last
        True when a stamp is the time of the last row of its burst, False for the first.
    scatter_s
        Median distance of the stamps from those times, s.
    """

    time_s: Array
    rate_hz: float
    by_last: bool
    scatter_s: float


def is_uneven(counts: NDArray[np.intp]) -> bool:
    """Tell whether bursts with these numbers of rows (m,) have many sizes; the first and the last may be cut."""
    inner = counts[1:-1]
    if len(inner) < _FEWEST_BURSTS:
        return False
    usual = float(np.median(inner))
    differ = np.abs(inner - usual) > max(_DIFFERENT * usual, _DIFFERENT_ROWS)
    return bool(differ.mean() > _UNEVEN_SHARE)


def steady_times(stamps_s: Array, counts: NDArray[np.intp]) -> SteadyTimes | None:
    """Find the times of rows that were measured at a steady rate and stamped in bursts.

    Parameters
    ----------
    stamps_s
        (m,) s, one for each burst, in the order of the rows.
    counts
        (m,) rows of each burst.

    Returns
    -------
    SteadyTimes or None
        None where the stamps do not fit a steady rate.
    """
    ends = np.cumsum(counts)
    found = [_fit(stamps_s, rows, ends) for rows in (ends - counts, ends - 1)]
    fits = [one for one in found if one is not None]
    if not fits:
        return None
    time_s, interval_s, scatter_s = min(fits, key=lambda fit: fit[2])
    steps = np.diff(stamps_s)
    if scatter_s > _MOST_SCATTER * float(np.median(steps[steps > 0.0])):
        return None
    by_last = found[0] is None or scatter_s < found[0][2]
    return SteadyTimes(time_s, 1.0 / interval_s, by_last, scatter_s)


def _fit(stamps_s: Array, rows: NDArray[np.intp], ends: NDArray[np.intp]) -> tuple[Array, float, float] | None:
    """Fit times of all rows to the stamps of some of them.

    Returns
    -------
    time_s : (n,)
    interval_s, scatter_s : float
        Time between two rows, and median distance of the stamps from the times.
    """
    lag = min(_LAG, len(rows) - 1)
    interval_s = float(np.median((stamps_s[lag:] - stamps_s[:-lag]) / (rows[lag:] - rows[:-lag])))
    if interval_s <= 0.0:
        return None
    offset_s = stamps_s - interval_s * rows
    steps = np.diff(stamps_s)
    gap_s = max(_GAP_S, _GAP_STEPS * float(np.median(steps[steps > 0.0])))
    breaks = np.flatnonzero(np.abs(np.diff(offset_s)) > gap_s) + 1
    every = np.arange(ends[-1])
    time_s = np.empty(len(every))
    smooth_s = np.empty(len(rows))
    for run in np.split(np.arange(len(rows)), breaks):
        first, last = run[0], run[-1]
        smooth_s[run] = _sliding_median(offset_s[run])
        inside = slice(ends[first - 1] if first else 0, ends[last])
        times = interval_s * every[inside] + np.interp(every[inside], rows[run], smooth_s[run])
        time_s[inside] = np.maximum.accumulate(times)
    return time_s, interval_s, float(np.median(np.abs(offset_s - smooth_s)))


def _sliding_median(values: Array) -> Array:
    """Compute the median of the `_WINDOW` values about each of some (n,), which are mirrored at their ends."""
    half = _WINDOW // 2
    windows = np.lib.stride_tricks.sliding_window_view(np.pad(values, half, mode="symmetric"), _WINDOW)
    medians: Array = np.partition(windows, half, axis=1)[:, half]
    return medians
