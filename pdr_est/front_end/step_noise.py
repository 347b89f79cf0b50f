"""Covariances of the motion of steps; that of one step is the same in whatever batch it comes."""

import numpy as np

from pdr_est.frames import Array

_LEAST_VARIANCE = 1e-3**2  # m^2, rad^2; keeps the matrices regular for steps of no length


def step_covariance(
    length_m: float, sigma_length_m: float, sigma_direction_rad: float, sigma_heading_rad: float
) -> Array:
    """Compute the covariance (3, 3) of forward (m), left (m) and heading (rad) at the end of a step.

    The heading error of the step turns its displacement too: left = length * heading error.

    Parameters
    ----------
    length_m, sigma_length_m : float
        Length of the step and its standard deviation.
    sigma_direction_rad : float
        Standard deviation of the direction of the step around the heading.
    sigma_heading_rad : float
        Standard deviation of the heading change over the step.
    """
    one = np.array([[length_m], [sigma_length_m], [sigma_heading_rad]])
    return np.asarray(step_covariances(one[0], one[1], sigma_direction_rad, one[2])[0])


def step_covariances(
    length_m: Array, sigma_length_m: Array, sigma_direction_rad: float, sigma_heading_rad: Array
) -> Array:
    """Compute the same covariances (n, 3, 3) for many steps, from arrays (n,)."""
    covariance = np.zeros((len(length_m), 3, 3))
    turn = sigma_heading_rad * sigma_heading_rad
    aside = length_m * length_m * (turn + sigma_direction_rad * sigma_direction_rad)
    covariance[:, 0, 0] = sigma_length_m * sigma_length_m + _LEAST_VARIANCE
    covariance[:, 1, 1] = aside + _LEAST_VARIANCE
    covariance[:, 1, 2] = covariance[:, 2, 1] = length_m * turn
    covariance[:, 2, 2] = turn + _LEAST_VARIANCE
    return covariance


def course_covariance(length_m: float, sigma_course_rad: float) -> Array:
    """Compute the covariance (3, 3) that a doubtful direction of motion adds to forward (m), left (m), heading (rad).

    It is that of the end of a step whose direction has a normal distribution on the circle, so that a step which
    leads anywhere has the variance length^2 / 2 in both axes. The heading of the next step does not depend on it.

    Parameters
    ----------
    length_m : float
        Length of the step.
    sigma_course_rad : float
        Standard deviation of the direction, rad.
    """
    return np.asarray(course_covariances(np.array([length_m]), np.array([sigma_course_rad]))[0])


def course_covariances(length_m: Array, sigma_course_rad: Array) -> Array:
    """Compute the same covariances (n, 3, 3) for many steps, from arrays (n,)."""
    variance, square = sigma_course_rad * sigma_course_rad, length_m * length_m
    spread = 1.0 - np.exp(-variance)
    covariance = np.zeros((len(length_m), 3, 3))
    covariance[:, 0, 0] = square * (0.5 * (spread * spread))
    covariance[:, 1, 1] = square * (0.5 * (1.0 - np.exp(-2.0 * variance)))
    return covariance
