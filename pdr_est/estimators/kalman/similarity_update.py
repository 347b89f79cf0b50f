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
from pdr_est.estimators.kalman.source_trust import FixHypotheses, mixture_of
from pdr_est.frames import Array
from pdr_est.types.measurements import PositionFix

_ITERATIONS = 4
_MOST_CHANGE = 0.5  # of heading (rad) and logarithmic scale in one iteration, within which the linearisation helps


def updated_by_fix(
    weights: Array, means: Array, covariances: Array, fix: PositionFix, of_fix: Array, about: FixHypotheses
) -> tuple[Array, Array, Array, Array]:
    """Update k weighted states with a position fix about which there are hypotheses.

    Parameters
    ----------
    weights, means, covariances
        Weights (k,), states (k, n) and their covariances (k, n, n).
    fix
        The fix.
    of_fix
        Jacobian (2, n) of the fix with respect to the states, of position and wandering errors.
    about
        Hypotheses (m) about the fix.

    Returns
    -------
    weights, means, covariances
        The updated ones, the moments over the hypotheses about the fix.
    probabilities
        Probabilities (m,) of the hypotheses about the fix after it.
    """
    states, kinds, size = len(weights), len(about), means.shape[1]
    prior = np.repeat(covariances, kinds, axis=0)
    lost_m2, jump = np.tile(about.lost_m2, states), np.tile(about.jump, states)
    wander = np.flatnonzero(of_fix[:, STATES:].any(axis=0)) + STATES
    prior[:, [0, 1], [0, 1]] += lost_m2[:, None]
    prior[:, wander, wander] += jump[:, None]
    noise = np.tile(about.noise, (states, 1, 1))
    moved, spread, log_likelihood = similarity_update(np.repeat(means, kinds, axis=0), prior, fix, of_fix, noise)
    log_weight = np.log(np.maximum(weights, 1e-300))[:, None] + np.log(np.maximum(about.weights, 1e-300))
    log_weight = log_weight + log_likelihood.reshape(states, kinds)
    joint = np.exp(log_weight - log_weight.max())
    joint /= joint.sum()
    probabilities = joint.sum(axis=0)
    kept = np.flatnonzero(~about.negligible(probabilities))
    log_weight = log_weight[:, kept] - log_weight[:, kept].max(axis=1, keepdims=True)
    share = np.exp(log_weight)
    share /= share.sum(axis=1, keepdims=True)
    moved = moved.reshape(states, kinds, size)[:, kept]
    spread = spread.reshape(states, kinds, size, size)[:, kept]
    mixed = [mixture_of(*one) for one in zip(share, moved, spread, strict=True)]
    after = joint[:, kept].sum(axis=1)
    return (
        after / after.sum(),
        np.array([one[0] for one in mixed]),
        np.array([one[1] for one in mixed]),
        probabilities,
    )


def similarity_update(
    means: Array, covariances: Array, fix: PositionFix, of_fix: Array, noise: Array | None = None
) -> tuple[Array, Array, Array]:
    """Update states with a position fix by Gauss-Newton iterations.

    Parameters
    ----------
    means
        States (k, n).
    covariances
        Their covariances (k, n, n).
    fix
        The fix.
    of_fix
        Jacobian (2, n) of the fix with respect to the states, of position and wandering errors.
    noise
        Covariances (k, 2, 2) of the independent error of the fix; by default that of the fix itself.

    Returns
    -------
    means, covariances
        The updated ones.
    log_likelihood
        Logarithm (k,) of the probability density of the fix, up to a constant.
    """
    noise = np.asarray(fix.covariance_m2) if noise is None else noise
    centre_m = _centres(means, covariances)
    before_m, size = means[:, :2] - centre_m, means.shape[1]
    to_similarity = _from_similarity(-before_m, size)
    prior = to_similarity @ covariances @ to_similarity.transpose(0, 2, 1)
    at = change = np.zeros_like(means)
    for _ in range(_ITERATIONS):
        at = at + _limited(change - at)
        turned_m = _turned(before_m, at)
        jacobian = _from_similarity(turned_m, size)[:, :2]
        jacobian[:, :, STATES:] = of_fix[:, STATES:]
        wandered_m = (means + at)[:, STATES:] @ of_fix[:, STATES:].T
        expected_m = centre_m + turned_m + at[:, :2] + wandered_m
        residual = np.asarray(fix.position_m) - expected_m + np.einsum("kij,kj->ki", jacobian, at)
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
