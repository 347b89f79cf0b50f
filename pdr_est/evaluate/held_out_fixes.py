"""Smoothing with sparse fixes: some truth points are given to the estimator, the others judge its track."""

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.types.measurements import PositionFix

WAYPOINT_SIGMA_M = 0.7  # per axis, of clicked or surveyed waypoints
LEAST_POINTS = 5
EVERY = 3


def given_points(n_points: int, every: int = EVERY) -> NDArray[np.bool_]:
    """(n,) which of n truth points are given: number 1, 4, 7, … and the last. The others are held out.

    every: 3 gives those numbers.
    """
    given: NDArray[np.bool_] = np.arange(n_points) % every == 0
    given[-1:] = True
    return given


def fixes_at(time_s: Array, position_m: Array, sigma_m: float = WAYPOINT_SIGMA_M) -> tuple[PositionFix, ...]:
    """Truth points as fixes with the sigma of a waypoint. time_s: (n,); position_m: (n, 2)."""
    covariance = sigma_m**2 * np.eye(2)
    return tuple(PositionFix(float(t), p, covariance) for t, p in zip(time_s, position_m, strict=True))
