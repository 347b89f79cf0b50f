"""Robust DR's maximum a posteriori fusion as pure geometry: positions of devices that a body holds together.

The paper maximises the product of the devices' Gaussian likelihoods, subject to a largest distance 2R between them
(section IV-B). Here that is: minimise the sum over devices of (l - e)' S^-1 (l - e), e the estimate, S its
covariance, subject to |l_a - l_b| <= 2R for each pair of devices, which is convex and has one solution.
"""

from collections.abc import Sequence

import numpy as np

from pdr_est.errors import EstimationError
from pdr_est.estimators.robust_dr.slsqp import constrained_optimum
from pdr_est.frames import Array

_LEAST_VARIANCE = 1e-12  # over the largest of all; ours: a certain position cannot be weighed against another
_MOST_NEWTON = 100  # far more than the ten or so that it takes


def closed_form(estimates_m: Array, max_distance_m: float) -> Array:
    """Fused positions (2, 2) of two devices whose errors have the same size in all directions: eqs. 21-28.

    estimates_m: (2, 2), of devices a and b; max_distance_m: 2R. Estimates within 2R stay as they are (the paper's
    first case). Otherwise both move to R from the middle between them, on the line that connects them (eq. 28).
    Raises EstimationError if a number is not finite or 2R not positive.
    """
    _check(estimates_m, np.array([max_distance_m]))
    a, b = estimates_m
    apart = b - a
    distance_m = float(np.hypot(*apart))
    if distance_m <= max_distance_m:
        return estimates_m.copy()
    reach = 0.5 * max_distance_m / distance_m * apart  # R (cos phi, sin phi), eq. 27
    middle = 0.5 * (a + b)
    return np.array([middle - reach, middle + reach])


def general(estimates_m: Array, covariances_m2: Array, max_distance_m: float) -> Array:
    """Fused positions (2, 2) of two devices of any covariances (2, 2, 2): eqs. 8-20.

    With q = l_b - l_a (eq. 8), eqs. 13 and 14 say that the sum of eq. 16 is zero, and give l_a for any q. Left is
    eq. 15, the best direction phi of q. The paper calls the three linear, but phi stands in eqs. 15 and 20 as sine
    and cosine. In the eigenvectors of S = S_a + S_b they come down to q_i = d_i / (1 + m s_i), d the distance
    between the estimates, with one unknown: the multiplier m > 0 at which |q| = 2R. 1 / |q| is nearly linear in it,
    and Newton's method on 1 / |q| = 1 / 2R climbs to the root from m = 0 without a way to fail.

    A covariance without width in some direction is taken as if it had 1e-12 of the largest variance there. Raises
    EstimationError if a number is not finite, 2R not positive, or a covariance not positive semi-definite.
    """
    _check(estimates_m, np.array([max_distance_m]))
    a, b = estimates_m
    apart = b - a
    if np.hypot(*apart) <= max_distance_m:
        return estimates_m.copy()
    of_a, of_b = with_width(covariances_m2)
    variance, axes = np.linalg.eigh(of_a + of_b)
    along = axes.T @ apart
    multiplier = _multiplier(along, variance, max_distance_m)
    q = axes @ (along / (1.0 + multiplier * variance))
    return np.array([a + multiplier * (of_a @ q), b - multiplier * (of_b @ q)])


def general_many(
    estimates_m: Array, covariances_m2: Array, pairs: Sequence[tuple[int, int]], max_distance_m: Array
) -> Array:
    """Fused positions (n, 2) of any number of devices, as `general`: the paper says only that it extends to them.

    pairs: which devices are held together; max_distance_m: (len(pairs),) 2R of each. A device in no pair stays.
    """
    _check(estimates_m, max_distance_m)
    a, b = (np.array([pair[end] for pair in pairs], dtype=np.int64) for end in (0, 1))
    if not len(pairs) or np.all(np.hypot(*(estimates_m[a] - estimates_m[b]).T) <= max_distance_m):
        return estimates_m.copy()
    if len(estimates_m) == 2:
        return general(estimates_m, covariances_m2, float(max_distance_m.min()))
    return constrained_optimum(estimates_m, with_width(covariances_m2), pairs, max_distance_m)


def with_width(covariances_m2: Array) -> Array:
    """Covariances (n, 2, 2) of which none is without width, as `general` says."""
    # What is left of a long walk's large variances off the diagonal has their rounding, not its own.
    skew = np.abs(covariances_m2 - np.swapaxes(covariances_m2, 1, 2)).max(axis=(1, 2))
    rounding = 1e-9 * np.abs(covariances_m2).max(axis=(1, 2)) + 1e-12
    if not (np.isfinite(covariances_m2).all() and np.all(skew <= rounding)):
        raise EstimationError(f"covariances {covariances_m2.tolist()}: give symmetric matrices of finite numbers")
    variance, axes = np.linalg.eigh(covariances_m2)
    largest = float(variance.max())
    if not (largest > 0.0 and variance.min() >= -1e-9 * largest):
        raise EstimationError(
            f"covariances with variances {variance.tolist()} m^2 cannot be weighed: give positive ones"
        )
    widened: Array = (axes * np.maximum(variance, _LEAST_VARIANCE * largest)[:, None, :]) @ np.swapaxes(axes, 1, 2)
    return widened


def _multiplier(along: Array, variance: Array, max_distance_m: float) -> float:
    """The m > 0 at which along / (1 + m variance) is max_distance_m long."""
    multiplier = 0.0
    for _ in range(_MOST_NEWTON):
        shrunk = along / (1.0 + multiplier * variance)
        length = float(np.hypot(*shrunk))
        # d(1 / length) / dm = sum of shrunk^2 s / (1 + m s), over length^3
        slope = float(np.sum(shrunk**2 * variance / (1.0 + multiplier * variance))) / length**3
        advance = (1.0 / max_distance_m - 1.0 / length) / slope
        multiplier += advance
        if advance <= 1e-15 * multiplier:
            break
    return multiplier


def _check(estimates_m: Array, max_distance_m: Array) -> None:
    if not np.isfinite(estimates_m).all():
        raise EstimationError(f"positions to fuse {estimates_m.tolist()}: all must be finite")
    if not np.all(max_distance_m > 0.0):
        raise EstimationError(f"largest distance {max_distance_m.tolist()} m between devices: give a positive one")
