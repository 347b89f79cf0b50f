"""Robust weights: outlying measurements count less, and none is discarded."""

import numpy as np

from pdr_est.frames import Array

HUBER = 1.345
"""Huber threshold in standard deviations: 95 % efficient for Gaussian errors in one dimension, 93 % in two."""

CAUCHY = 1.0
"""Scale of Cauchy's kernel for heading priors, in standard deviations: an error of so many counts half."""


def huber_inflation(residual: Array, covariance: Array) -> float:
    """Compute the factor by which Huber weighting inflates the noise covariance of a measurement.

    Parameters
    ----------
    residual
        Innovation, (m,).
    covariance
        Covariance of the innovation, (m, m).

    Returns
    -------
    float
        Factor of at least 1.

    References
    ----------
    P. J. Huber, "Robust estimation of a location parameter", Ann. Math. Statist. 35 (1964).
    """
    solved = residual / covariance[0] if len(residual) == 1 else np.linalg.solve(covariance, residual)
    distance = float(np.sqrt(residual @ solved))
    return max(1.0, distance / HUBER)
