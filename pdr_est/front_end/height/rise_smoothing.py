"""Heights of all seconds under known modes, by a Kalman filter and a Rauch-Tung-Striebel smoother."""

from collections.abc import Sequence

import numpy as np

from pdr_est.frames import Array
from pdr_est.front_end.height import vertical_moves as modes
from pdr_est.front_end.height.height_params import HeightParams
from pdr_est.front_end.height.move_hypotheses import PathOfModes
from pdr_est.front_end.height.seconds import Second
from pdr_est.front_end.height.vertical_filter import jump_variances_m2, measure_height, move_matrices, move_on

_BESIDE_S = 120  # seconds beside a move that tell its rise; the error wanders too much for more
_TINY_M2 = 1e-9  # makes covariances regular: on the level the height is known to be constant


def smoothed_heights(
    seconds: Sequence[Second], path: PathOfModes, sigma_m: float, parameters: HeightParams
) -> tuple[Array, Array]:
    """Estimate the height above that of the first second.

    Parameters
    ----------
    seconds
        The n seconds.
    path
        Their modes and the cases of the pressure.
    sigma_m
        Standard deviation of the noise of the height in a second, m.
    parameters
        Noise of the pressure.

    Returns
    -------
    height_m, variance_m2 : Array
        (n,) m and m²; the variance is that of the rises so far.
    """
    moving = np.flatnonzero(modes.is_moving(path.mode))
    height_m, variance_m2 = np.zeros(len(seconds)), np.zeros(len(seconds))
    known = np.flatnonzero(np.isfinite([one.height_m for one in seconds]))
    if not len(moving) or not len(known):
        return height_m, variance_m2
    first, last = max(int(moving[0]) - _BESIDE_S, int(known[0])), min(int(moving[-1]) + _BESIDE_S, len(seconds))
    mean, covariance = _smoothed(
        seconds[first:last], PathOfModes(path.mode[first:last], path.case[first:last]), sigma_m, parameters
    )
    height_m[first:last], variance_m2[first:last] = mean[:, 0], np.maximum(covariance[:, 0, 0], 0.0)
    height_m[last:], variance_m2[last:] = height_m[last - 1], variance_m2[last - 1]
    return height_m, variance_m2


def _smoothed(
    seconds: Sequence[Second], path: PathOfModes, sigma_m: float, parameters: HeightParams
) -> tuple[Array, Array]:
    """Filter and smooth height, error and vertical speed: means (n, 3) and covariances (n, 3, 3)."""
    count = len(seconds)
    mean, covariance = np.zeros((count, 3)), np.zeros((count, 3, 3))
    expected, expected_covariance = np.zeros((count, 3)), np.zeros((count, 3, 3))
    moves = np.zeros((count, 3, 3))
    now, spread = np.array([[0.0, seconds[0].height_m, 0.0]]), np.diag([0.0, sigma_m**2, 0.0])[None]
    before, jump_m2 = np.array([modes.LEVEL]), jump_variances_m2(parameters)
    for k, second in enumerate(seconds):
        mode = path.mode[k : k + 1]
        if k:
            moves[k] = _transition(int(before[0]), int(mode[0]))
            move_on(now, spread, before, mode, parameters.drift_m_per_sqrt_s)
            spread[0, 1, 1] += jump_m2[path.case[k]]
        expected[k], expected_covariance[k] = now[0], spread[0]
        if k and np.isfinite(second.height_m):
            disturbed_m2 = parameters.sigma_disturbed_m**2 * (mode == modes.DISTURBED)
            measure_height(now, spread, second.height_m, sigma_m**2 + disturbed_m2)
        mean[k], covariance[k], before = now[0], spread[0], mode
    for k in range(count - 2, -1, -1):
        ahead = expected_covariance[k + 1] + _TINY_M2 * np.eye(3)
        gain = np.linalg.solve(ahead, moves[k + 1] @ covariance[k]).T
        mean[k] += gain @ (mean[k + 1] - expected[k + 1])
        covariance[k] += gain @ (covariance[k + 1] - ahead) @ gain.T
    return mean, covariance


def _transition(before: int, mode: int) -> Array:
    """Return the matrix (3, 3) that moves height, error and speed on; a speed that begins or ends is independent."""
    if before == mode and modes.direction_of(mode):
        return np.asarray(move_matrices(modes.STEADINESS[[mode]])[0])
    return np.array([[1.0, 0.0, 0.5 * abs(modes.direction_of(before))], [0.0, 1.0, 0.0], [0.0, 0.0, 0.0]])
