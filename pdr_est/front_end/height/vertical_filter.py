"""Kalman filters of height, error of the height by the pressure, and vertical speed, moved on second by second."""

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.front_end.height import vertical_moves as modes
from pdr_est.front_end.height.height_params import HeightParams

HEIGHT, ERROR, SPEED = range(3)
"""States: height (m), error of the height by the pressure (m), vertical speed (m/s)."""

STEADY, JUMP, GREAT_JUMP = range(3)
"""Cases of the error of the pressure in a second: it wanders, or it has jumped, or jumped far."""

_EACH = np.eye(3)
_HALF_A_SECOND = np.array([[1.0, 0.0, 0.5], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])  # a move ends within the second
_EVENLY = np.array([0.5, 0.0, 1.0])  # height and speed of a change of the speed

Numbers = NDArray[np.int64]


def move_on(mean: Array, covariance: Array, before: Numbers, mode: Numbers, drift_m_per_sqrt_s: float) -> None:
    """Move filters on by a second, in place.

    Parameters
    ----------
    mean, covariance
        (n, 3) and (n, 3, 3), height (m), its error (m) and vertical speed (m/s).
    before, mode
        (n,) mode of the second before and of this one.
    drift_m_per_sqrt_s
        Random walk of the error, m per root second.
    """
    moving, changes = modes.is_moving(mode), before != mode
    ends, begins, goes_on = modes.is_moving(before) & changes, moving & changes, moving & ~changes
    for places, by in ((ends, _HALF_A_SECOND), (goes_on, move_matrices(modes.STEADINESS[mode[goes_on]]))):
        mean[places] = np.matmul(by, mean[places][:, :, None])[:, :, 0]
        covariance[places] = by @ covariance[places] @ np.swapaxes(by, -1, -2)
    still = ~goes_on
    mean[still, SPEED] = 0.0
    covariance[still, SPEED, :] = 0.0
    covariance[still, :, SPEED] = 0.0
    chosen = mode[begins]
    _add_speed(mean, covariance, begins, modes.SPEED_MPS[chosen], modes.SIGMA_SPEED_MPS[chosen] ** 2)
    chosen = mode[goes_on]
    steadiness = modes.STEADINESS[chosen]
    pull_mps = (1.0 - steadiness) * modes.SPEED_MPS[chosen]
    _add_speed(mean, covariance, goes_on, pull_mps, (1.0 - steadiness**2) * modes.SIGMA_SPEED_MPS[chosen] ** 2)
    covariance[:, ERROR, ERROR] += drift_m_per_sqrt_s**2


def jump_variances_m2(parameters: HeightParams) -> Array:
    """Return what each case adds to the variance of the error of the pressure (cases,), m²."""
    return np.array([0.0, parameters.sigma_jump_m**2, parameters.sigma_great_jump_m**2])


def _add_speed(mean: Array, covariance: Array, places: NDArray[np.bool_], speed_mps: Array, variance: Array) -> None:
    """Add to the speed what changes within the second, evenly: it moves the height by half of itself."""
    mean[places] += speed_mps[:, None] * _EVENLY
    covariance[places] += variance[:, None, None] * np.outer(_EVENLY, _EVENLY)


def move_matrices(steadiness: Array) -> Array:
    """Return the matrices (n, 3, 3) that move height, error and speed on by a second of a move."""
    by = np.tile(_EACH, (len(steadiness), 1, 1))
    by[:, HEIGHT, SPEED] = 0.5 * (1.0 + steadiness)
    by[:, SPEED, SPEED] = steadiness
    return by


def measure_height(mean: Array, covariance: Array, height_m: float, noise_m2: Array) -> Array:
    """Update filters (n,) by the height in a second, in place; return the log likelihoods, up to a constant."""
    innovation = height_m - mean[:, HEIGHT] - mean[:, ERROR]
    shared = covariance[:, :, HEIGHT] + covariance[:, :, ERROR]
    spread = shared[:, HEIGHT] + shared[:, ERROR] + noise_m2
    gain = shared / spread[:, None]
    mean += gain * innovation[:, None]
    covariance -= gain[:, :, None] * shared[:, None, :]
    return np.asarray(-0.5 * (innovation**2 / spread + np.log(spread)))
