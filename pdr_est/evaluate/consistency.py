"""Whether the covariances of a track tell the truth about its errors."""

import math

import numpy as np

from pdr_est.frames import Array


def radius95_m(covariance_m2: Array) -> Array:
    """Long half axes (n,) of the 95 % ellipses of normal distributions; NaN where a covariance is not finite.

    covariance_m2: (n, 2, 2).
    """
    finite = np.asarray(np.isfinite(covariance_m2).all(axis=(1, 2)))
    covariance = np.where(finite[:, None, None], covariance_m2, 0.0)
    xx, xy, yy = covariance[:, 0, 0], covariance[:, 0, 1], covariance[:, 1, 1]
    largest = (xx + yy) / 2.0 + np.hypot((xx - yy) / 2.0, xy)
    radius = np.sqrt(CHI2_95_2D * np.maximum(largest, 0.0))
    return np.where(finite, radius, np.nan)


CHI2_95_2D = -2.0 * math.log(0.05)  # 5.991; with 2 degrees of freedom P(chi2 > x) = exp(-x/2)


def squared_mahalanobis(error_m: Array, covariance_m2: Array, truth_sigma_m: float) -> Array:
    """(n,) e^T (P + sigma^2 I)^-1 e: squared errors in units of the covariance that they should have.

    error_m: (n, 2) track - truth; covariance_m2: (n, 2, 2) of the track; truth_sigma_m: of the truth, per axis.
    """
    innovation = covariance_m2 + truth_sigma_m**2 * np.eye(2)
    weighted = np.linalg.solve(innovation, error_m[:, :, None])[:, :, 0]
    return np.asarray((error_m * weighted).sum(axis=1))


def coverage95(error_m: Array, covariance_m2: Array, truth_sigma_m: float) -> float:
    """`coverage95`: share of the points inside the 95 % region (chi-squared, 2 degrees of freedom). 0.95 is right."""
    return float((squared_mahalanobis(error_m, covariance_m2, truth_sigma_m) <= CHI2_95_2D).mean())


def nees_mean(error_m: Array, covariance_m2: Array, truth_sigma_m: float) -> float:
    """`nees_mean`: mean normalised squared error. 2 is right; more means that the covariances are too small."""
    return float(squared_mahalanobis(error_m, covariance_m2, truth_sigma_m).mean())
