"""Sparse fixes: some true positions are given to the estimator, and the others judge its track."""

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.types.measurements import PositionFix

WAYPOINT_SIGMA_M = 0.7  # per axis, of clicked or surveyed waypoints
LEAST_POINTS = 5
EVERY = 3


def given_points(n_points: int, every: int = EVERY) -> NDArray[np.bool_]:
    """Select the true positions that are given: with every = 3 number 1, 4, 7, … and the last one.

    Returns
    -------
    ndarray
        Mask (n,) of the points that are given; the others are held out.
    """
    given: NDArray[np.bool_] = np.arange(n_points) % every == 0
    given[-1:] = True
    return given


def fixes_at(time_s: Array, position_m: Array, sigma_m: float = WAYPOINT_SIGMA_M) -> tuple[PositionFix, ...]:
    """Make fixes of true positions.

    Parameters
    ----------
    time_s : ndarray
        Times (n,), s.
    position_m : ndarray
        Positions (n, 2), m.
    sigma_m : float
        Standard deviation per axis, m.
    """
    covariance = sigma_m**2 * np.eye(2)
    return tuple(PositionFix(float(t), p, covariance) for t, p in zip(time_s, position_m, strict=True))
