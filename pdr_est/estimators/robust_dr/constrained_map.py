"""Maximum a posteriori positions of tethered devices at one time, as in Robust DR.

The paper maximises the product of the devices' Gaussian likelihoods, subject to a largest distance 2R between them
(section IV-B). Here that is: minimise the sum over devices of (l - e)' S^-1 (l - e), e the estimate, S its
covariance, subject to |l_a - l_b| <= 2R for each pair of devices, which is convex and has one solution.

References
----------
Y. Jin et al., A Robust Dead-Reckoning Pedestrian Tracking System with Low Cost Sensors, section IV.
"""

from collections.abc import Sequence

import numpy as np

from pdr_est.errors import EstimationError
from pdr_est.estimators.robust_dr.slsqp import constrained_optimum
from pdr_est.frames import Array

_LEAST_VARIANCE = 1e-12  # relative to the largest of all (our choice): an exactly known position has no finite weight
_MOST_NEWTON = 100  # far more than the ten or so that it takes


def closed_form(estimates_m: Array, max_distance_m: float) -> Array:
    """Fuse two devices whose errors have the same size in all directions.

    Estimates within the limit 2R stay as they are (the paper's first case). Otherwise both move to the distance R
    from the middle between them, on the line that connects them (eq. 28).

    Parameters
    ----------
    estimates_m
        Estimated positions of both devices, (2, 2), m.
    max_distance_m
        Largest distance 2R between them, m.

    Returns
    -------
    Array
        Fused positions, (2, 2), m.

    Raises
    ------
    EstimationError
        If a number is not finite or the limit is not positive.

    References
    ----------
    Jin et al., eqs. 21-28.
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
    """Fuse two devices with any covariances.

    With q = l_b - l_a (eq. 8), eqs. 13 and 14 say that the sum of eq. 16 is zero, and give l_a for any q. Eq. 15
    remains, for the best direction phi of q. The paper calls the three linear, but phi enters eqs. 15 and 20 as sine
    and cosine. In the eigenvectors of S = S_a + S_b they reduce to q_i = d_i / (1 + m s_i), where d is the difference
    of the estimates, with one unknown: the multiplier m > 0 at which |q| = 2R. 1 / |q| is nearly linear and concave
    in it, so that Newton's method on 1 / |q| = 1 / 2R rises to the root monotonically from m = 0.

    Parameters
    ----------
    estimates_m
        Estimated positions of both devices, (2, 2), m.
    covariances_m2
        Covariances of the estimates, (2, 2, 2), m^2; singular ones are changed as in `with_least_variance`.
    max_distance_m
        Largest distance 2R between them, m.

    Returns
    -------
    Array
        Fused positions, (2, 2), m.

    Raises
    ------
    EstimationError
        If a number is not finite, the limit is not positive, or a covariance is not positive semi-definite.

    References
    ----------
    Jin et al., eqs. 8-20.
    """
    _check(estimates_m, np.array([max_distance_m]))
    a, b = estimates_m
    apart = b - a
    if np.hypot(*apart) <= max_distance_m:
        return estimates_m.copy()
    of_a, of_b = with_least_variance(covariances_m2)
    variance, axes = np.linalg.eigh(of_a + of_b)
    along = axes.T @ apart
    multiplier = _multiplier(along, variance, max_distance_m)
    q = axes @ (along / (1.0 + multiplier * variance))
    return np.array([a + multiplier * (of_a @ q), b - multiplier * (of_b @ q)])


def general_many(
    estimates_m: Array, covariances_m2: Array, pairs: Sequence[tuple[int, int]], max_distance_m: Array
) -> Array:
    """Fuse any number of devices with any covariances; the paper says only that its method extends to them.

    Parameters
    ----------
    estimates_m
        Estimated positions of the devices, (n, 2), m.
    covariances_m2
        Covariances of the estimates, (n, 2, 2), m^2.
    pairs
        Indices of the devices of each tethered pair.
    max_distance_m
        Largest distance 2R of each pair, (len(pairs),), m.

    Returns
    -------
    Array
        Fused positions, (n, 2), m. A device without a tether keeps its estimate.

    Raises
    ------
    EstimationError
        If a number is not finite, a limit is not positive, a covariance is not positive semi-definite, or the
        numerical optimisation for three devices or more does not converge.
    """
    _check(estimates_m, max_distance_m)
    a, b = (np.array([pair[end] for pair in pairs], dtype=np.int64) for end in (0, 1))
    if not len(pairs) or np.all(np.hypot(*(estimates_m[a] - estimates_m[b]).T) <= max_distance_m):
        return estimates_m.copy()
    if len(estimates_m) == 2:
        return general(estimates_m, covariances_m2, float(max_distance_m.min()))
    return constrained_optimum(estimates_m, with_least_variance(covariances_m2), pairs, max_distance_m)


def with_least_variance(covariances_m2: Array) -> Array:
    """Raise variances along the principal axes to at least 1e-12 of the largest one, so that all can be inverted.

    Parameters
    ----------
    covariances_m2
        Positive semi-definite covariances, (n, 2, 2), m^2.

    Returns
    -------
    Array
        Positive definite covariances, (n, 2, 2), m^2.

    Raises
    ------
    EstimationError
        If a covariance is not finite, symmetric and positive semi-definite, or all are zero.
    """
    # After a long walk the elements off the diagonal carry the rounding errors of much larger variances.
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
    raised: Array = (axes * np.maximum(variance, _LEAST_VARIANCE * largest)[:, None, :]) @ np.swapaxes(axes, 1, 2)
    return raised


def _multiplier(along: Array, variance: Array, max_distance_m: float) -> float:
    """Find the multiplier m > 0 at which along / (1 + m variance) has the length max_distance_m."""
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
    """Refuse positions that are not finite and limits that are not positive."""
    if not np.isfinite(estimates_m).all():
        raise EstimationError(f"positions to fuse {estimates_m.tolist()}: all must be finite")
    if not np.all(max_distance_m > 0.0):
        raise EstimationError(f"largest distance {max_distance_m.tolist()} m between devices: give a positive one")
