"""Mixtures of few normal distributions, fitted to the points of paths at each pose, for all poses at once.

The points of a pose are divided across the longer or the shorter axis of their covariance, where two normal
distributions describe them best, and one of the parts once more. A division is kept if the joint probability of the
points and their parts gains more than the parameters of one more distribution cost (integrated completed likelihood).
Two distributions that overlap by more than a little count as one, because the parts lose the tails: a normal sample
that is divided in its middle loses a fifth of a unit of log-likelihood for each point. Paths that share a part of
their way are fewer than they seem, so that a division has to gain something for each point, too.

References
----------
C. Biernacki, G. Celeux, G. Govaert, "Assessing a mixture model for clustering with the integrated completed
likelihood", IEEE Trans. Pattern Anal. Mach. Intell. 22 (2000).
"""

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.types.region import MOST_COMPONENTS, PoseRegion

_ONE_PLACE_M = 0.5  # standard deviation up to which the points are not divided: nobody asks which side it is
_LEAST_SHARE = 0.05  # of the points in a part: what is less probable is no part of a region of 95 %
_LEAST_POINTS = 5  # in a part
_LEAST_VARIANCE_M2 = _ONE_PLACE_M**2  # of a part: a few paths that went the same way are no place of their own
_PARAMETERS = 6.0  # of one component more: weight, mean, covariance
_LEAST_GAIN = 0.2  # of log-likelihood for each point, besides: the region gets a fifth smaller (ours)


def fitted_region(points_m: Array, position_m: Array, covariance_m2: Array) -> PoseRegion:
    """Fit a mixture to the points of each pose.

    Parameters
    ----------
    points_m
        (n, 2, k) points drawn from the distribution of each of n poses, equally probable, m.
    position_m
        (n, 2) positions, m, and
    covariance_m2
        (n, 2, 2) mean squared errors about them, m², for poses that one normal distribution describes.
    """
    region = PoseRegion.of_gaussians(position_m, covariance_m2)
    origin = points_m.mean(axis=2)
    terms = _terms(points_m - origin[:, :, None])
    part = np.zeros((len(points_m), points_m.shape[2]), dtype=np.int64)
    divided = np.flatnonzero(np.linalg.eigvalsh(covariance_m2)[:, 1] > _ONE_PLACE_M**2)
    for number in range(1, MOST_COMPONENTS):
        part[divided] = _divided(terms[divided], part[divided], number)
        divided = np.flatnonzero(part.any(axis=1))
    if len(divided):
        weight, mean, covariance = _components(terms[divided], part[divided])
        region.weight[divided] = weight
        region.mean_m[divided] = mean + origin[divided][:, None]
        region.covariance_m2[divided] = covariance
    return region


def _terms(points: Array) -> Array:
    """Return 1, x, y, x x, x y and y y of points (n, 2, k), in this order, (n, 6, k)."""
    x, y = points[:, 0], points[:, 1]
    return np.stack([np.ones_like(x), x, y, x * x, x * y, y * y], axis=1)


def _sums(terms: Array, own: NDArray[np.bool_]) -> Array:
    """Return the sums (n, 6) of the terms of the points that are chosen (n, k)."""
    return np.asarray((terms @ own[:, :, None].astype(np.float64))[:, :, 0])


def _moments(sums: Array) -> tuple[Array, Array]:
    """Return means (..., 2) and covariances (..., 2, 2) of sums of terms (..., 6)."""
    count = np.maximum(sums[..., 0], 1.0)
    x, y, xx, xy, yy = np.moveaxis(sums[..., 1:] / count[..., None], -1, 0)
    xx, xy, yy = xx - x * x, xy - x * y, yy - y * y
    return np.stack([x, y], axis=-1), np.stack([np.stack([xx, xy], axis=-1), np.stack([xy, yy], axis=-1)], axis=-1)


def _components(terms: Array, part: NDArray[np.int64]) -> tuple[Array, Array, Array]:
    """Return weights (n, k), means (n, k, 2) and covariances (n, k, 2, 2) of the parts, the most probable first."""
    sums = np.stack([_sums(terms, part == number) for number in range(MOST_COMPONENTS)], axis=1)
    order = np.argsort(-sums[:, :, 0], axis=1, kind="stable")
    sums = np.take_along_axis(sums, order[..., None], axis=1)
    count = sums[..., 0]
    mean, covariance = _moments(sums)
    covariance *= (count / np.maximum(count - 1.0, 1.0))[..., None, None]
    mean[count == 0.0], covariance[count == 0.0] = np.nan, np.nan
    return count / part.shape[1], mean, covariance


def _divided(terms: Array, part: NDArray[np.int64], number: int) -> NDArray[np.int64]:
    """Divide the part of each pose (n, k) whose division gains most; its far side gets a new number."""
    part = part.copy()
    best = np.full(len(part), 0.5 * _PARAMETERS * np.log(part.shape[1]) + _LEAST_GAIN * part.shape[1])
    chosen = np.zeros(part.shape, dtype=np.bool_)
    for whole in range(number):
        gain, far = _best_division(terms, part == whole)
        better = gain > best
        best = np.where(better, gain, best)
        chosen = np.where(better[:, None], far, chosen)
    part[chosen] = number
    return part


def _best_division(terms: Array, own: NDArray[np.bool_]) -> tuple[Array, NDArray[np.bool_]]:
    """Return what the best division of the chosen points (n, k) gains (n,), and its far side (n, k)."""
    sums, points = _sums(terms, own), own.shape[1]
    mean, covariance = _moments(sums)
    whole = _log_likelihood(sums, covariance, points)
    best, far = np.full(len(own), -np.inf), np.zeros(own.shape, dtype=np.bool_)
    _, axes = np.linalg.eigh(covariance)
    for axis in (axes[:, :, 0], axes[:, :, 1]):
        along = axis[:, :1] * terms[:, 1] + axis[:, 1:] * terms[:, 2] - (axis * mean).sum(axis=1)[:, None]
        beyond = own & (along > _threshold(along, own)[:, None])
        sums_beyond = _sums(terms, beyond)
        gain = -whole
        for side in (sums_beyond, sums - sums_beyond):
            gain = gain + _log_likelihood(side, _moments(side)[1], points)
        better = gain > best
        best = np.where(better, gain, best)
        far = np.where(better[:, None], beyond, far)
    return best, far


def _threshold(along: Array, own: NDArray[np.bool_]) -> Array:
    """Return where to divide the chosen numbers (n, k) into two normal samples; infinity where they are too few."""
    ordered = np.sort(np.where(own, along, np.inf), axis=1)
    count, points = own.sum(axis=1)[:, None], along.shape[1]
    least = max(int(np.ceil(_LEAST_SHARE * points)), _LEAST_POINTS)
    values = np.where(np.arange(points) < count, ordered, 0.0)
    sums, squares = np.cumsum(values, axis=1), np.cumsum(values**2, axis=1)
    near = np.arange(1, points + 1)[None]
    rest = np.maximum(count - near, 1)
    score = np.zeros(along.shape)
    for size, total, square in ((near, sums, squares), (rest, sums[:, -1:] - sums, squares[:, -1:] - squares)):
        variance = np.maximum(square / size - (total / size) ** 2, _LEAST_VARIANCE_M2)
        score += size * (np.log(size) - 0.5 * np.log(variance))
    score[(near < least) | (count - near < least)] = -np.inf
    at = np.argmax(score, axis=1)[:, None]
    after = np.minimum(at + 1, points - 1)
    middle = 0.5 * (np.take_along_axis(ordered, at, axis=1) + np.take_along_axis(ordered, after, axis=1))
    return np.where(np.isfinite(np.take_along_axis(score, at, axis=1)), middle, np.inf)[:, 0]


def _log_likelihood(sums: Array, covariance: Array, points: int) -> Array:
    """Return the log probability of points of a part, and of being in it, but for what is common to all divisions."""
    (xx, xy), (_, yy) = np.moveaxis(covariance + _LEAST_VARIANCE_M2 * np.eye(2), (1, 2), (0, 1))
    count = sums[:, 0]
    return np.asarray(count * (np.log(np.maximum(count, 1.0) / points) - 0.5 * np.log(xx * yy - xy * xy)))
