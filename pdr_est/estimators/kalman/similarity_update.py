"""Update of poses with a wide heading uncertainty by a position fix.

A heading that is uncertain by 10° bends the distribution of a position 60 m further on to an arc, which a Gaussian of
the position does not describe. Rotation, length scale and translation of the whole track do describe it: a track of
unknown heading and scale is the expected one turned and scaled about a centre, and moved, X = ξ X̂, and no motion of
the walker changes ξ, an element of the similarity group of the plane. A Gaussian of ξ stays a Gaussian, and only the
update is not linear; it is iterated (Gauss-Newton). The centre is the place whose position does not depend on the
heading, such as a known start.

References
----------
A. Barrau, S. Bonnabel, "The invariant extended Kalman filter as a stable observer", IEEE Trans. Autom. Control 62
(2017): errors of the right-invariant kind, here for similarities instead of rigid motions.
"""

import numpy as np

from pdr_est.estimators.common.motion_model import JITTER_VARIANCE, LOG_SCALE, STATES
from pdr_est.frames import Array

_ITERATIONS = 4
_MOST_CHANGE = 0.5  # of heading (rad) and logarithmic scale in one iteration, within which the linearisation helps


def similarity_update(
    means: Array, covariances: Array, observed_m: Array, of_fix: Array, noise: Array
) -> tuple[Array, Array, Array]:
    """Update states with a position fix by Gauss-Newton iterations.

    Parameters
    ----------
    means
        States (k, n).
    covariances
        Their covariances (k, n, n).
    observed_m
        Positions (k, 2) that the fix gives.
    of_fix
        Jacobians (k, 2, n) of the fix with respect to the states, of position and source.
    noise
        Covariances (k, 2, 2) of the independent error of the fix.

    Returns
    -------
    means, covariances
        The updated ones.
    log_likelihood
        Logarithm (k,) of the probability density of the fix, up to a constant.
    """
    centre_m = _centres(means, covariances)
    before_m, size = means[:, :2] - centre_m, means.shape[1]
    to_similarity = _from_similarity(-before_m, size)
    prior = to_similarity @ covariances @ to_similarity.transpose(0, 2, 1)
    at = change = np.zeros_like(means)
    for _ in range(_ITERATIONS):
        at = at + _limited(change - at)
        turned_m = _turned(before_m, at)
        jacobian = _from_similarity(turned_m, size)[:, :2]
        jacobian[:, :, STATES:] = of_fix[:, :, STATES:]
        wandered_m = np.einsum("kij,kj->ki", of_fix[:, :, STATES:], (means + at)[:, STATES:])
        expected_m = centre_m + turned_m + at[:, :2] + wandered_m
        residual = observed_m - expected_m + np.einsum("kij,kj->ki", jacobian, at)
        turned = _turned_errors(prior, at)
        across = turned @ jacobian.transpose(0, 2, 1)
        spread = jacobian @ across + noise
        gain = np.linalg.solve(spread, across.transpose(0, 2, 1)).transpose(0, 2, 1)
        change = np.einsum("kij,kj->ki", gain, residual)
    change = at + _limited(change - at)
    log_likelihood = -0.5 * (squared_distance(spread, residual) + np.linalg.slogdet(spread)[1])
    posterior = turned - gain @ across.transpose(0, 2, 1)
    moved = means + change
    after_m = _turned(before_m, change) + change[:, :2]
    moved[:, :2] = centre_m + after_m
    back = _from_similarity(after_m, size) @ _from_similarity(-change[:, :2], size)
    posterior = back @ posterior @ back.transpose(0, 2, 1)
    return moved, 0.5 * (posterior + posterior.transpose(0, 2, 1)), log_likelihood


def squared_distance(covariance: Array, residual: Array) -> Array:
    """Return the squared Mahalanobis distances (k,) of residuals (k, m) with covariances (k, m, m)."""
    return np.asarray(np.einsum("ki,ki->k", residual, np.linalg.solve(covariance, residual[..., None])[..., 0]))


def _limited(step: Array) -> Array:
    """Shorten steps (k, n) that change heading or logarithmic scale by more than the linearisation is good for."""
    largest = np.abs(step[:, 2 : LOG_SCALE + 1]).max(axis=1)
    return np.asarray(step * (_MOST_CHANGE / np.maximum(largest, _MOST_CHANGE))[:, None])


def _turned_errors(covariances: Array, change: Array) -> Array:
    """Turn covariances (k, n, n) of similarities with the track: the noise of its steps goes along with it."""
    rotation = np.tile(np.eye(covariances.shape[1]), (len(change), 1, 1))
    c, s = np.cos(change[:, 2]), np.sin(change[:, 2])
    rotation[:, 0, 0], rotation[:, 0, 1], rotation[:, 1, 0], rotation[:, 1, 1] = c, -s, s, c
    return np.asarray(rotation @ covariances @ rotation.transpose(0, 2, 1))


def _centres(means: Array, covariances: Array) -> Array:
    """Return the places (k, 2) that are uncorrelated with the heading; where it is known exactly, the positions."""
    per_radian = covariances[:, :2, 2] / np.maximum(covariances[:, 2, 2, None], JITTER_VARIANCE)
    return means[:, :2] + np.stack([-per_radian[:, 1], per_radian[:, 0]], axis=1)


def _turned(position_m: Array, change: Array) -> Array:
    """Turn and scale positions (k, 2) from their centre by changes (k, n) of heading and logarithmic scale."""
    scale = np.exp(change[:, LOG_SCALE])
    c, s = scale * np.cos(change[:, 2]), scale * np.sin(change[:, 2])
    east, north = position_m.T
    return np.stack([c * east - s * north, s * east + c * north], axis=1)


def _from_similarity(position_m: Array, size: int) -> Array:
    """Return the Jacobian (k, n, n) of states with respect to similarities of the map, at positions (k, 2)."""
    jacobian = np.tile(np.eye(size), (len(position_m), 1, 1))
    jacobian[:, 0, 2], jacobian[:, 1, 2] = -position_m[:, 1], position_m[:, 0]
    jacobian[:, :2, LOG_SCALE] = position_m
    return jacobian
