"""A straight line through the differences of two clocks, some of which are wrong."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pdr_est.clock_sync.common_signals import RATE_HZ, CommonSignals
from pdr_est.frames import Array

SIGMA_SKEW = 1e-4  # of a phone's clock: quartz of some tens of ppm, colder or warmer than its twin; ours

_HUBER = 1.345  # standard deviations; 95 % efficient for Gaussian errors
_WRONG = 4.0  # standard deviations beyond which a difference is no measurement of the line at all
_ITERATIONS = 30
_TO_SIGMA = 1.4826  # median of absolute deviations -> standard deviation


@dataclass(frozen=True)
class Line:
    """Offset at at_s and slope of a line, their covariance (2, 2), and the differences that lie on it, (n,)."""

    at_s: float
    offset_s: float
    slope: float
    covariance: Array
    scatter_s: float
    on_it: NDArray[np.bool_]

    def value(self, time_s: Array) -> Array:
        there: Array = self.offset_s + self.slope * (time_s - self.at_s)
        return there


def fit_line(time_s: Array, difference_s: Array, sigma_slope: float, least_scatter_s: float) -> Line:
    """Huber's line through differences (n,) at times (n,), n at least 1.

    sigma_slope: standard deviation of the slope known beforehand, about zero; it keeps few differences from making a
    skew of their noise. least_scatter_s: what their scatter is at least.
    """
    at_s = float(np.mean(time_s))
    since = time_s - at_s
    rows = np.stack([np.ones_like(since), since], axis=1)
    offset, slope = float(np.median(difference_s)), 0.0
    weight = np.ones_like(since)
    for _ in range(_ITERATIONS):
        residual = difference_s - offset - slope * since
        scatter = max(_TO_SIGMA * float(np.median(np.abs(residual))), least_scatter_s)
        size = np.maximum(np.abs(residual) / scatter, 1e-12)
        weight = np.where(size > _WRONG, 0.0, np.minimum(1.0, _HUBER / size))
        information = rows.T @ (weight[:, None] * rows) / scatter**2
        information[1, 1] += 1.0 / sigma_slope**2
        information[0, 0] = max(information[0, 0], 1e-12)
        offset, slope = np.linalg.solve(information, rows.T @ (weight * difference_s) / scatter**2)
    covariance = np.linalg.inv(information).astype(np.float64)
    return Line(at_s, float(offset), float(slope), covariance, scatter, weight > 0.0)


_PEAK_S = 0.5  # half width of the peak of effort and turns over all shifts


def level_line(shift_s: float) -> Line:
    """What the first look knows: one shift, to the width of its peak."""
    return Line(0.0, shift_s, 0.0, np.diag([_PEAK_S**2, SIGMA_SKEW**2]), _PEAK_S, np.zeros(0, dtype=np.bool_))


def stretches(
    one: CommonSignals, two: CommonSignals, line: Line, window_s: float, reach_s: float, least_s: float
) -> list[NDArray[np.int64]]:
    """Samples of `one` that `two` has up to reach_s about, in windows of at least window_s if there is so much, and
    none of less than least_s."""
    there_s = one.time_s + line.value(one.time_s)
    both = np.flatnonzero((there_s >= two.time_s[0] + reach_s) & (there_s <= two.time_s[-1] - reach_s))
    windows = np.array_split(both, max(1, int(len(both) / (window_s * RATE_HZ))))
    return [rows for rows in windows if len(rows) >= least_s * RATE_HZ]
