"""Robust straight line through measured differences of two clocks, some of which are outliers."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array

SIGMA_SKEW = 1e-4
"""Prior standard deviation of the skew between two phones: some tens of ppm, at different temperatures; ours."""

_HUBER = 1.345  # standard deviations; 95 % efficient for Gaussian errors
_OUTLIER = 4.0  # standard deviations beyond which a difference gets no weight at all
_ITERATIONS = 30
_MAD_TO_SIGMA = 1.4826  # median absolute deviation -> standard deviation
_PEAK_S = 0.5  # half width of the peak of the correlation of intensity and turns over all shifts


@dataclass(frozen=True)
class ClockLine:
    """Difference of two clocks as a straight line over time.

    Attributes
    ----------
    at_s
        Time, s on the reference clock, to which `offset_s` belongs.
    offset_s
        Difference (other clock - reference clock), s, at `at_s`.
    slope
        Skew: change of the difference per second.
    covariance
        (2, 2) covariance of offset and slope, independent at `at_s`.
    scatter_s
        Standard deviation, s, of the differences about the line.
    inlier
        (n,) which of the fitted differences got a weight above zero.
    """

    at_s: float
    offset_s: float
    slope: float
    covariance: Array
    scatter_s: float
    inlier: NDArray[np.bool_]

    def difference_at(self, time_s: Array) -> Array:
        """Evaluate the clock difference, s, at times of the reference clock."""
        difference: Array = self.offset_s + self.slope * (time_s - self.at_s)
        return difference


def fit_clock_line(time_s: Array, difference_s: Array, sigma_slope: float, min_scatter_s: float) -> ClockLine:
    """Fit a line to clock differences by iteratively reweighted least squares with Huber weights.

    Parameters
    ----------
    time_s
        (n,) times on the reference clock, s; n is at least 1.
    difference_s
        (n,) measured differences (other clock - reference clock), s.
    sigma_slope
        Standard deviation of a zero-mean Gaussian prior of the slope. It keeps a few noisy differences from
        producing a large skew.
    min_scatter_s
        Lower bound of the standard deviation of the differences, s.
    """
    at_s = float(np.mean(time_s))
    since = time_s - at_s
    rows = np.stack([np.ones_like(since), since], axis=1)
    offset, slope = float(np.median(difference_s)), 0.0
    weight = np.ones_like(since)
    for _ in range(_ITERATIONS):
        residual = difference_s - offset - slope * since
        scatter = max(_MAD_TO_SIGMA * float(np.median(np.abs(residual))), min_scatter_s)
        size = np.maximum(np.abs(residual) / scatter, 1e-12)
        weight = np.where(size > _OUTLIER, 0.0, np.minimum(1.0, _HUBER / size))
        information = rows.T @ (weight[:, None] * rows) / scatter**2
        information[1, 1] += 1.0 / sigma_slope**2
        information[0, 0] = max(information[0, 0], 1e-12)
        offset, slope = np.linalg.solve(information, rows.T @ (weight * difference_s) / scatter**2)
    covariance = np.linalg.inv(information).astype(np.float64)
    return ClockLine(at_s, float(offset), float(slope), covariance, scatter, weight > 0.0)


def constant_offset_line(shift_s: float) -> ClockLine:
    """Return the line of a constant clock difference, as uncertain as the peak of the coarse search is wide."""
    return ClockLine(0.0, shift_s, 0.0, np.diag([_PEAK_S**2, SIGMA_SKEW**2]), _PEAK_S, np.zeros(0, dtype=np.bool_))
