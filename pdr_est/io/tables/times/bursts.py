"""Mend the time stamps of a table: spread bursts that share one stamp."""

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.io.tables.times.uneven_bursts import SteadyTimes, is_uneven, steady_times

_SHARED = 1.8  # mean number of rows with one stamp, from which on they are a burst and not repeated rows
_CHANGING_SHARE = 0.5


def spread_bursts(time_s: Array, values: Array) -> tuple[Array, str]:
    """Spread rows that share a time stamp evenly until the next stamp, or at a steady rate if bursts vary in size.

    Recorders that deliver samples in packets, or print whole seconds, give many samples one stamp. Rows that are
    merely repeated keep their stamp: they are recognised by their equal values.

    Parameters
    ----------
    time_s
        (n,) s, NaN where a row has no time.
    values
        (n, k) what was measured, to tell a burst from repeated rows.

    Returns
    -------
    time_s : (n,) s
    warning : str
        How many rows shared a stamp; "" when nothing was changed.
    """
    known = np.flatnonzero(np.isfinite(time_s))
    times = time_s[known]
    starts = np.flatnonzero(np.concatenate([[True], np.diff(times) != 0.0])) if len(times) else np.zeros(0, np.intp)
    if len(starts) < 2 or len(times) < _SHARED * len(starts) or not _differ(values[known], starts):
        return time_s, ""
    counts = np.diff(np.concatenate([starts, [len(times)]]))
    steps = np.diff(times[starts])
    usual_step = float(np.median(steps[steps > 0.0])) if (steps > 0.0).any() else 0.0
    usual_count = float(np.median(counts))
    if usual_step <= 0.0:
        return time_s, ""
    spread = time_s.copy()
    steady = steady_times(times[starts], counts) if is_uneven(counts) else None
    if steady is not None:
        spread[known] = steady.time_s
        return spread, _steady_warning(steady, counts)
    if usual_count < 2:
        return time_s, ""
    spread[known] = times + _within(counts, np.append(steps, usual_step), usual_step, usual_count)
    warning = (
        f"{usual_count:.0f} rows share one time stamp, every {usual_step:.3g} s: they are spread evenly until the "
        "next stamp; their true times are not known better than that"
    )
    return spread, warning


def _steady_warning(steady: SteadyTimes, counts: NDArray[np.intp]) -> str:
    row = "last" if steady.by_last else "first"
    return (
        f"{counts.min()} to {counts.max()} rows share one time stamp: they are spread evenly at "
        f"{steady.rate_hz:.1f} Hz, which the stamps fit to {steady.scatter_s:.2g} s as the times of the {row} rows; "
        "their true times are not known better than that"
    )


def _differ(values: Array, starts: NDArray[np.intp]) -> bool:
    """Tell whether rows that share a stamp have different values."""
    shared = np.ones(len(values), dtype=np.bool_)
    shared[starts] = False
    index = np.flatnonzero(shared)
    changed = (values[index] != values[index - 1]).any(axis=1)
    return bool(changed.mean() > _CHANGING_SHARE)


def _within(counts: NDArray[np.intp], steps: Array, usual_step: float, usual_count: float) -> Array:
    """Compute the time (n,) of each row since its stamp, s.

    A burst with fewer rows than usual keeps the usual interval; at the beginning it ends with the next stamp, because
    the recording began in the middle of it.
    """
    interval = usual_step / usual_count
    within = np.arange(int(counts.sum())) - np.repeat(np.concatenate([[0], np.cumsum(counts)[:-1]]), counts)
    each = np.where((steps > 0.0) & (steps < 1.5 * usual_step), steps, usual_step) / counts
    each = np.where(counts < 0.8 * usual_count, interval, each)
    offset = within * np.repeat(each, counts)
    if counts[0] < 0.8 * usual_count:
        offset[: counts[0]] += steps[0] - counts[0] * interval
    return np.asarray(offset, dtype=np.float64)
