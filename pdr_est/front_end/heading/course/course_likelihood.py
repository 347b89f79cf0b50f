"""Compute how likely a leading acceleration is for each direction of motion, and what follows for the direction."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import SIGMA_UNIFORM_RAD, Array
from pdr_est.front_end.heading.course.course_params import CourseParams
from pdr_est.front_end.heading.course.sideways_chain import ANGLES_RAD

RATES: Array = np.array([3e-4, 3e-3, 3e-2])
"""Probabilities per step that the body begins to turn alone: few people ever do it, some often."""
RATES.flags.writeable = False
LEAST_STEPS = 10
"""Least number of steps that tell a direction, for a mean."""
TURNS_WITHIN = 6
"""Number of steps of a turn that is searched."""
LEAST_TURN_RAD = 0.25
"""Least angle of such a turn, rad."""
LEAST_VARIANCE = 1e-4
"""Least variance of the acceleration in one direction, (m/s^2)^2."""
RATE_PROBABILITY = (0.7, 0.25, 0.05)
"""Their prior probabilities."""
LEAST_SPREAD_LENGTH = 1e-3
"""Length of a mean unit vector below which an angle may be any."""

_WILD, _WILDER = 0.1, 3.0  # share of steps with larger errors, and how much larger
_PHASORS = np.exp(1j * ANGLES_RAD)


@dataclass(frozen=True)
class AheadMoments:
    """Mean (r,) and variance in one direction (r,) of the acceleration of a walker who moves ahead, for each rate."""

    mean: NDArray[np.complex128]
    variance: Array


def robust_moments(acceleration: NDArray[np.complex128]) -> AheadMoments:
    """Compute mean and variance, the same for each rate, from medians: most steps lead ahead."""
    mean = complex(_median(acceleration.real), _median(acceleration.imag))
    variance = max(_median(np.abs(acceleration - mean) ** 2) / (2.0 * np.log(2.0)), LEAST_VARIANCE)
    return AheadMoments(np.full(len(RATES), mean), np.full(len(RATES), variance))


def _median(values: Array) -> float:
    """Return the median of some finite values (n,), at a fraction of the cost of `np.median` for a few of them."""
    ordered = np.sort(values)
    middle = len(ordered) // 2
    return 0.5 * (ordered.item(middle) + ordered.item(-middle - 1))


def is_clear(mean: complex, variance: float, count: int, parameters: CourseParams) -> bool:
    """Return True if the acceleration of one step tells its direction, as nearly certain by so many steps.

    The ratio of the mean to the standard deviation has to be above the least one by its own standard deviation, which
    is large for few steps: else the phones whose ratio is above it by chance are those that are believed. It follows
    from those of medians of normal errors, where neighbouring steps have the same ones.
    """
    ratio = abs(mean) / np.sqrt(variance)
    observations = count / parameters.correlated_steps
    error = np.sqrt((0.5 * np.pi + (0.5 * ratio / np.log(2.0)) ** 2) / observations)
    return bool(ratio - error >= parameters.least_clearness)


def course_log_likelihood(
    distance2: Array,
    variance: Array | float,
    parameters: CourseParams,
    walks: Array | float = 1.0,
    runs: Array | float = 0.0,
) -> Array:
    """Compute the logarithm of the likelihood of accelerations for a direction of motion.

    Parameters
    ----------
    distance2 : ndarray
        Squared distances from the acceleration that is expected of a walker, (m/s^2)^2.
    variance : ndarray or float
        Variance of it in one direction.
    parameters : CourseParams
        Parameters.
    walks : ndarray or float
        Probability of each step that it is one of a walker.
    runs : ndarray or float
        Probability that it is one of a runner, times the density of the acceleration of a runner, which tells
        nothing about the direction.
    """
    near = (1.0 - _WILD) * np.exp(-distance2 / (2.0 * variance))
    far = _WILD / _WILDER**2 * np.exp(-distance2 / (2.0 * _WILDER**2 * variance))
    density: Array = np.log(walks * (near + far) / variance + runs + 1e-300)
    return density / parameters.correlated_steps


def angle_and_doubt(probability: Array, log_evidence: Array) -> tuple[Array, Array]:
    """Compute mean and standard deviation (n,), rad, of the angle between motion and body.

    Parameters
    ----------
    probability : ndarray, shape (n, r, 72)
        Probability of each angle for each rate.
    log_evidence : ndarray, shape (r,)
        Logarithm of the evidence of each rate.
    """
    weight = np.array(RATE_PROBABILITY) * np.exp(log_evidence - log_evidence.max())
    angle = (probability @ _PHASORS) @ (weight / weight.sum())
    spread = np.sqrt(-2.0 * np.log(np.clip(np.abs(angle), LEAST_SPREAD_LENGTH, 1.0)))
    return np.angle(angle), np.minimum(spread, SIGMA_UNIFORM_RAD)
