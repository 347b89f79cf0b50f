"""Covariances of the motion of a step, for one step or for many at once, to the last bit the same."""

from typing import TypeVar

import numpy as np

from pdr_est.frames import Array

Number = TypeVar("Number", float, Array)

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
    forward, left, shared, heading = _step_terms(length_m, sigma_length_m, sigma_direction_rad, sigma_heading_rad)
    return np.array([[forward, 0.0, 0.0], [0.0, left, shared], [0.0, shared, heading]])


def step_covariances(
    length_m: Array, sigma_length_m: Array, sigma_direction_rad: float, sigma_heading_rad: Array
) -> Array:
    """Compute the same covariances (n, 3, 3) for many steps, from arrays (n,)."""
    covariance = np.zeros((len(length_m), 3, 3))
    forward, left, shared, heading = _step_terms(length_m, sigma_length_m, sigma_direction_rad, sigma_heading_rad)
    covariance[:, 0, 0], covariance[:, 1, 1], covariance[:, 2, 2] = forward, left, heading
    covariance[:, 1, 2] = covariance[:, 2, 1] = shared
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


def _step_terms(
    length_m: Number, sigma_length_m: Number, sigma_direction_rad: float, sigma_heading_rad: Number
) -> tuple[Number, Number, Number, Number]:
    """Compute the variances of forward and left, the covariance of left and heading, and the heading's variance."""
    turn = sigma_heading_rad * sigma_heading_rad
    left = length_m * length_m * (turn + sigma_direction_rad * sigma_direction_rad) + _LEAST_VARIANCE
    return sigma_length_m * sigma_length_m + _LEAST_VARIANCE, left, length_m * turn, turn + _LEAST_VARIANCE
