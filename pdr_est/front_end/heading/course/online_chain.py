"""The chain of `sideways_chain` at the step, forward only, with what it tells of the direction of motion so far."""

from cmath import phase
from collections.abc import Sequence
from math import exp, log, sqrt

import numpy as np

from pdr_est.frames import SIGMA_UNIFORM_RAD, Array
from pdr_est.front_end.heading.course.course_likelihood import (
    LEAST_SPREAD_LENGTH,
    LEAST_VARIANCE,
    RATE_PROBABILITY,
    RATES,
    course_log_likelihood,
)
from pdr_est.front_end.heading.course.course_params import CourseParams
from pdr_est.front_end.heading.course.running import runner_density
from pdr_est.front_end.heading.course.sideways_chain import ANGLES, ANGLES_RAD, moved_on, walking_ahead

_COS, _SIN = np.cos(ANGLES_RAD), np.sin(ANGLES_RAD)
_AHEAD = np.abs(ANGLES_RAD) < 0.6  # by so little the hand may turn against the body
# Sums over the angles that tell what is to be known: of all, of those ahead, and of the unit vectors of the others.
_SUMS = np.stack([np.ones(ANGLES), _AHEAD, np.where(_AHEAD, 0.0, _COS), np.where(_AHEAD, 0.0, _SIN)], axis=1)


class OnlineChain:
    """Probabilities of the angle between motion and body, from one step to the next.

    Parameters
    ----------
    mean : complex
        Mean acceleration of a walker who moves ahead, m/s^2, by the steps before.
    variance : float
        Its variance in one direction.
    count : int
        Number of the steps that told both.
    log_evidence : sequence of float
        Logarithm of the evidence of each rate so far.
    parameters : CourseParams
        Parameters.

    Attributes
    ----------
    log_evidence : list of float
        Logarithm of the evidence of each rate.
    ahead : float
        Probability that the walker moves ahead, for the rate at which it is least.
    mean : complex
        Mean acceleration of a walker who moves ahead, m/s^2.
    variance : float
        Its variance in one direction, (m/s^2)^2.
    """

    def __init__(
        self, mean: complex, variance: float, count: int, log_evidence: Sequence[float], parameters: CourseParams
    ) -> None:
        self.mean, self.variance = mean, variance
        # Number of steps and the sums over them of the acceleration turned ahead, and of its square.
        self._count = float(count)
        self._sum, self._sum_squared = count * mean, count * (abs(mean) ** 2 + 2.0 * variance)
        self._parameters = parameters
        self._state = walking_ahead(len(RATES))
        self.log_evidence = list(log_evidence)
        self.ahead = 1.0
        self._sums: list[list[float]] = []  # of the products of the probabilities with _SUMS, for each rate

    def likelihood(self, acceleration: complex, running: float) -> Array:
        """Compute the likelihood (72,) of an acceleration at each angle, over that ahead.

        `running` is the probability that the step is one of a runner.
        """
        east = acceleration.real - (self.mean.real * _COS - self.mean.imag * _SIN)
        north = acceleration.imag - (self.mean.real * _SIN + self.mean.imag * _COS)
        runs = running * runner_density(np.array(acceleration))
        distance2 = east * east + north * north
        density = course_log_likelihood(distance2, self.variance, self._parameters, 1.0 - running, runs)
        return np.asarray(np.exp(density - density[0]))

    def learn(self, acceleration: complex, running: float) -> None:
        """Correct mean and variance by the acceleration of the latest step, at the angles that it may have.

        A mean of few steps has an error, which is common to all later steps and looks like an angle. Where the angle
        stays in doubt, the mean shrinks and the variance grows, until the acceleration tells nothing any more. A step
        counts by the probability that it is not one of a runner.
        """
        walks = 1.0 - running
        turned = acceleration * self._phasor().conjugate()
        self._count += walks
        self._sum += walks * turned
        self._sum_squared += walks * abs(acceleration) ** 2
        self.mean = self._sum / self._count
        self.variance = max(0.5 * (self._sum_squared / self._count - abs(self.mean) ** 2), LEAST_VARIANCE)

    def move(self, turn_rad: float, likelihood: Array | None) -> None:
        """Move on by a step with its turn and likelihood (72,) of its acceleration, None if that tells nothing."""
        state = moved_on(self._state, turn_rad, RATES)
        if likelihood is not None:
            state *= likelihood
        sums = (state[0] + state[1]).dot(_SUMS)
        state /= sums[:, :1]
        self._state, self._sums = state, sums.tolist()
        self.log_evidence = [known + log(one[0]) for known, one in zip(self.log_evidence, self._sums, strict=True)]
        self.ahead = min([ahead / total for total, ahead, _, _ in self._sums])

    def angle_and_doubt(self) -> tuple[float, float]:
        """Compute mean and standard deviation of the angle, rad; what is nearly ahead counts as straight ahead."""
        phasor = self._phasor()
        length = min(max(abs(phasor), LEAST_SPREAD_LENGTH), 1.0)
        return phase(phasor), min(sqrt(-2.0 * log(length)), SIGMA_UNIFORM_RAD)

    def _phasor(self) -> complex:
        """Compute the mean unit vector of the angle."""
        best = max(self.log_evidence)
        weights = [share * exp(one - best) for share, one in zip(RATE_PROBABILITY, self.log_evidence, strict=True)]
        phasor = 0j
        for weight, (total, ahead, east, north) in zip(weights, self._sums, strict=True):
            phasor += weight / total * complex(ahead + east, north)
        return phasor / sum(weights)
