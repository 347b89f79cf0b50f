"""Consistency of the covariances of a track with its errors."""

import math

import numpy as np

from pdr_est.frames import Array


def radius95_m(covariance_m2: Array) -> Array:
    """Compute the semi-major axes of the 95 % ellipses of normal distributions.

    Parameters
    ----------
    covariance_m2 : ndarray
        Covariances (n, 2, 2), m².

    Returns
    -------
    ndarray
        Semi-major axes (n,), m; NaN where a covariance is not finite.
    """
    finite = np.asarray(np.isfinite(covariance_m2).all(axis=(1, 2)))
    covariance = np.where(finite[:, None, None], covariance_m2, 0.0)
    xx, xy, yy = covariance[:, 0, 0], covariance[:, 0, 1], covariance[:, 1, 1]
    largest = (xx + yy) / 2.0 + np.hypot((xx - yy) / 2.0, xy)
    radius = np.sqrt(CHI2_95_2D * np.maximum(largest, 0.0))
    return np.where(finite, radius, np.nan)


CHI2_95_2D = -2.0 * math.log(0.05)  # 5.991; with 2 degrees of freedom P(chi2 > x) = exp(-x/2)


def squared_mahalanobis(error_m: Array, covariance_m2: Array, truth_sigma_m: float) -> Array:
    """Compute the squared Mahalanobis distances e^T (P + sigma^2 I)^-1 e of position errors.

    Parameters
    ----------
    error_m : ndarray
        Track - truth, (n, 2), m.
    covariance_m2 : ndarray
        Covariances (n, 2, 2) of the track, m².
    truth_sigma_m : float
        Standard deviation of the truth per axis, m.

    Returns
    -------
    ndarray
        Squared distances (n,); their mean is 2 for a consistent track.
    """
    innovation = covariance_m2 + truth_sigma_m**2 * np.eye(2)
    weighted = np.linalg.solve(innovation, error_m[:, :, None])[:, :, 0]
    return np.asarray((error_m * weighted).sum(axis=1))


def coverage95(error_m: Array, covariance_m2: Array, truth_sigma_m: float) -> float:
    """Compute `coverage95`: the share of the points inside the 95 % region (chi-squared, 2 degrees of freedom).

    The ideal value is 0.95. Parameters are those of `squared_mahalanobis`.
    """
    return float((squared_mahalanobis(error_m, covariance_m2, truth_sigma_m) <= CHI2_95_2D).mean())


def nees_mean(error_m: Array, covariance_m2: Array, truth_sigma_m: float) -> float:
    """Compute `nees_mean`: the mean normalised estimation error squared.

    The ideal value is 2; more means that the covariances are too small. Parameters are those of
    `squared_mahalanobis`.
    """
    return float(squared_mahalanobis(error_m, covariance_m2, truth_sigma_m).mean())
