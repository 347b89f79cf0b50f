"""Huber's weights: far measurements count less, none is thrown away."""

import numpy as np

from pdr_est.frames import Array

HUBER = 1.345  # standard deviations; 95 % efficient for Gaussian errors in one dimension, 93 % in two


def huber_inflation(residual: Array, covariance: Array) -> float:
    """Factor by which the noise of a measurement grows. residual: (m,); covariance: (m, m) of the innovation."""
    distance = float(np.sqrt(residual @ np.linalg.solve(covariance, residual)))
    return max(1.0, distance / HUBER)
