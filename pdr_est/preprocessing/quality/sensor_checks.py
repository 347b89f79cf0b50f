"""Check one sensor: its clock, values that stand still or hit the end of their range."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.types.recording import Signal

LONGEST_PERIOD_S = 0.5
"""A longer time between two samples is a gap."""

_STUCK_S = 2.0
_STUCK_SAMPLES = 5
_PLATEAUS = 2  # separate times at the same extreme for two samples or more
_LONG_PLATEAU = 10  # samples of a single one
_PILED_UP = 2.0  # times as many samples at the extreme as at the next value; coarse digits thin out towards it
_CLIPPED_SAMPLES = 5
_MOVING_SHARE = 0.2  # of the signal's usual variation
_LEAST_VARIATION = 1e-9  # in the unit of the signal; a constant one varies by rounding errors


@dataclass(frozen=True)
class Interval:
    """Time interval on the clock of the recording.

    Attributes
    ----------
    start_s
        Beginning, s.
    length_s
        Duration, s.
    """

    start_s: float
    length_s: float

    @property
    def end_s(self) -> float:
        """Return the end, s."""
        return self.start_s + self.length_s


@dataclass(frozen=True)
class ClockCheck:
    """Regularity of the time stamps of a sensor.

    Attributes
    ----------
    rate_hz
        Sampling rate by the median period, Hz; 0 when fewer than two times differ.
    jitter_p50_s, jitter_p99_s
        Median and 99th percentile of the deviation of the period from its median, s.
    duplicates
        Number of samples whose time repeats.
    backward_steps
        Number of samples whose time goes back.
    gaps
        Times between samples longer than `LONGEST_PERIOD_S` and five median periods.
    """

    rate_hz: float
    jitter_p50_s: float
    jitter_p99_s: float
    duplicates: int
    backward_steps: int
    gaps: tuple[Interval, ...]


def check_clock(time_s: Array) -> ClockCheck:
    """Check the time stamps (n,), s, of a sensor."""
    period_s = np.diff(time_s)
    forward_s = period_s[period_s > 0.0]
    if not len(forward_s):
        return ClockCheck(0.0, 0.0, 0.0, int((period_s == 0).sum()), int((period_s < 0).sum()), ())
    median_s = float(np.median(forward_s))
    p50, p99 = np.percentile(np.abs(forward_s - median_s), [50, 99])
    long = np.flatnonzero(period_s > max(LONGEST_PERIOD_S, 5.0 * median_s))
    return ClockCheck(
        rate_hz=1.0 / median_s,
        jitter_p50_s=float(p50),
        jitter_p99_s=float(p99),
        duplicates=int((period_s == 0.0).sum()),
        backward_steps=int((period_s < 0.0).sum()),
        gaps=tuple(Interval(float(time_s[i]), float(period_s[i])) for i in long),
    )


def clipped_axes(values: Array) -> tuple[int, ...]:
    """Find the axes (columns of values, (n, k)) that stay at one extreme value while the other axes move.

    Samples that repeat as a whole are counted once: they come from a slower sensor, not from the end of a range.
    """
    distinct = values[np.concatenate([[True], (np.diff(values, axis=0) != 0.0).any(axis=1)])]
    return tuple(axis for axis in range(values.shape[1]) if _is_clipped(distinct[:, axis]))


def constant_axes(values: Array) -> tuple[int, ...]:
    """Find the axes (columns of values, (n, k)) that never change although another one does."""
    if len(values) < _STUCK_SAMPLES:
        return ()
    varies = np.ptp(values, axis=0) > 0.0
    return tuple(np.flatnonzero(~varies).tolist()) if varies.any() else ()


def _is_clipped(values: Array) -> bool:
    """Tell whether a column has several plateaus, or a long one, at its minimum or maximum."""
    spread = float(values.std())
    levels, counts = np.unique(values, return_counts=True)
    if len(levels) < 3:
        return False
    piled_up = {
        levels[0]: counts[0] >= _PILED_UP * counts[1],
        levels[-1]: counts[-1] >= _PILED_UP * counts[-2],
    }
    for extreme in (values.min(), values.max()):
        lengths = _run_lengths(values == extreme)
        plateaus = lengths[lengths >= 2]
        far = abs(float(extreme) - float(np.median(values))) > spread
        enough = len(plateaus) >= _PLATEAUS or plateaus.max(initial=0) >= _LONG_PLATEAU
        if far and piled_up[extreme] and enough and plateaus.sum() >= _CLIPPED_SAMPLES:
            return True
    return False


def stuck_intervals(signal: Signal, others: Sequence[Signal]) -> tuple[Interval, ...]:
    """Find intervals of more than 2 s in which a sensor does not change at all while another one moves."""
    same = np.concatenate([[False], (np.diff(signal.values, axis=0) == 0.0).all(axis=1)])
    found = []
    for first, last in _runs(same):
        begin = max(first - 1, 0)
        interval = Interval(float(signal.time_s[begin]), float(signal.time_s[last] - signal.time_s[begin]))
        enough = last - begin >= _STUCK_SAMPLES and interval.length_s > _STUCK_S
        if enough and any(_varies(other, interval) for other in others):
            found.append(interval)
    return tuple(found)


def _varies(signal: Signal, interval: Interval) -> bool:
    """Tell whether a signal varies in an interval by a good part of its usual variation."""
    inside = (signal.time_s >= interval.start_s) & (signal.time_s <= interval.end_s)
    if inside.sum() < 2:
        return False
    usual = float(signal.values.std(axis=0).max())
    return usual > _LEAST_VARIATION and float(signal.values[inside].std(axis=0).max()) > _MOVING_SHARE * usual


def _runs(mask: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Return first and last index of each run of True."""
    edges = np.diff(np.concatenate([[0], mask.astype(np.int8), [0]]))
    return [
        (int(a), int(b) - 1) for a, b in zip(np.flatnonzero(edges == 1), np.flatnonzero(edges == -1), strict=True)
    ]


def _run_lengths(mask: NDArray[np.bool_]) -> NDArray[np.int64]:
    return np.array([last - first + 1 for first, last in _runs(mask)], dtype=np.int64)
