"""Tell from all movement of a phone how probable it is that its carrier walks.

Peaks at the rhythm of steps are also felt in a bus, in a train, and while a phone is handled. A walker differs from a
passenger by how strongly the phone is accelerated in all directions, and from somebody who handles a phone by how far
it turns over: a swinging arm tilts it by half a right angle at most, and back. Each peak adds its evidence to the
logarithm of the odds, which forgets slowly, because people start and stop.
"""

import math
from dataclasses import dataclass

import numpy as np

from pdr_est.frames import Array
from pdr_est.front_end.steps.step_evidence.step_probability import probability
from pdr_est.types.sensors import LevelBlock

MOVEMENT_COLUMNS = 7
_ACCELERATION, _SQUARE, _UP = slice(0, 3), 3, slice(4, 7)
_LEAST_STRENGTH_MPS2 = 0.02  # below the noise of phones
_SMOOTHING_S = 0.1  # averages out what engines and wheels shake above the frequencies of gait

# Logistic regression on the peaks of walkers (oxford-steps, weallwalk, known-distance, stride-length, oxiod,
# phone-gps, motionsense, ipin2023, ilc20, sisfall) against those of people who stand (motionsense), sit down or stand
# up (geotec), shake the phone to calibrate it (ipin2023 before the first surveyed point), and ride in made-up
# vehicles (vertical vibration of 1 to 3 Hz with 0.3 and 0.4 m/s^2, sideways half of it, slow accelerations). The
# constant is 1.64 above the fitted one: the loss of a weak walker's steps weighs more than a false step.
_CONSTANT, _STRENGTH, _TILTING, _TURNING = 1.6, 3.19, -7.34, -13.19
_LEAST_MPS2, _HIGHEST_MPS2 = 0.2, 2.0  # of the acceleration; what is beyond tells no more
_USUAL_TILTING = 0.4  # as far as a swinging arm tilts the phone
_MOST_TURNING = 0.5
_MOST_EVIDENCE = 2.0  # of one peak: the windows of neighbouring peaks overlap
_START, _STOP = 0.01, 0.01  # probabilities that walking starts and stops from one peak to the next
_AT_FIRST = -0.5  # logarithm of the odds at the first peak after a standstill


@dataclass(frozen=True)
class Movement:
    """Movement of a phone in the recent past.

    Attributes
    ----------
    acceleration_mps2 : float
        Standard deviation of the acceleration within half of the time, all directions together, m/s^2.
    tilting : float
        Square root of 1 less the length of the mean unit vector upwards in device axes: 0 for a phone that keeps its
        tilt.
    turning : float
        1 less the cosine of the angle between the mean upward vectors of the first and the second half: a phone that
        is tilted back and forth by every stride has 0.
    """

    acceleration_mps2: float
    tilting: float
    turning: float

    @property
    def log_odds(self) -> float:
        """Logarithm of the odds of walking that the movement adds."""
        strength = min(max(self.acceleration_mps2, _LEAST_MPS2), _HIGHEST_MPS2)
        evidence = (
            _CONSTANT
            + _STRENGTH * math.log(strength)
            + _TILTING * math.log(max(self.tilting / _USUAL_TILTING, 1.0))
            + _TURNING * min(self.turning, _MOST_TURNING)
        )
        return min(max(evidence, -_MOST_EVIDENCE), _MOST_EVIDENCE)


class MovementSums:
    """Running sums over a segment, from differences of which the movement in any span follows.

    Parameters
    ----------
    rate_hz : float
        Sampling rate.
    """

    def __init__(self, rate_hz: float) -> None:
        self._width = max(round(_SMOOTHING_S * rate_hz), 1)
        self.reset()

    def reset(self) -> None:
        """Forget the past, for a new segment."""
        self._plain: Array | None = None  # (3, width) running sums of the acceleration at the latest samples
        self._last: Array = np.zeros((MOVEMENT_COLUMNS, 1))

    def push(self, block: LevelBlock) -> Array:
        """Return the sums (n, MOVEMENT_COLUMNS) up to and with each sample of a block."""
        rows = np.empty((MOVEMENT_COLUMNS, len(block) + 1))
        rows[:, :1] = self._last
        acceleration = self._smoothed(block.acceleration_mps2)
        rows[_ACCELERATION, 1:] = acceleration
        acceleration *= acceleration
        acceleration.sum(axis=0, out=rows[_SQUARE, 1:])
        rows[_UP, 1:] = block.up.T
        # The carry is the first term of the sum, so that the order of the additions does not depend on the cuts.
        sums: Array = np.cumsum(rows, axis=1)
        self._last = sums[:, -1:]
        return sums[:, 1:].T

    def _smoothed(self, acceleration: Array) -> Array:
        """Average the latest samples of the acceleration (n, 3); the first one lasted for ever. Return (3, n)."""
        width = self._width
        if not len(acceleration):
            return np.empty((3, 0))
        if self._plain is None:
            self._plain = np.cumsum(np.repeat(acceleration[:1].T, width, axis=1), axis=1)
        known = np.concatenate([self._plain, acceleration.T], axis=1)
        np.cumsum(known[:, width - 1 :], axis=1, out=known[:, width - 1 :])
        self._plain = known[:, -width:]
        mean: Array = (known[:, width:] - known[:, :-width]) / width
        return mean


def movement_between(before: Array, middle: Array, end: Array, samples: int) -> Movement:
    """Compute the movement in a span from the running sums before it, in its middle and at its end.

    Parameters
    ----------
    before, middle, end : ndarray, shape (MOVEMENT_COLUMNS,)
        Rows that `MovementSums` returned.
    samples : int
        Number of samples of the span, at least 1.
    """
    ax, ay, az, first_square, ux, uy, uz = ((middle - before) * (2.0 / samples)).tolist()
    bx, by, bz, second_square, vx, vy, vz = ((end - middle) * (2.0 / samples)).tolist()
    # Each half has its own mean, so that a slow acceleration, such as a vehicle's, does not count.
    squared_means = ax * ax + ay * ay + az * az + bx * bx + by * by + bz * bz
    variance = 0.5 * (first_square + second_square - squared_means)
    first, second, both = ux * ux + uy * uy + uz * uz, vx * vx + vy * vy + vz * vz, ux * vx + uy * vy + uz * vz
    return Movement(
        acceleration_mps2=math.sqrt(max(variance, 0.0)),
        tilting=math.sqrt(max(1.0 - 0.5 * math.sqrt(first + second + 2.0 * both), 0.0)),
        turning=1.0 - both / max(math.sqrt(first * second), 1e-12),
    )


def strength_between(before: Array, end: Array, samples: int) -> float:
    """Compute the standard deviation of the acceleration in a span, all directions together, m/s^2.

    Parameters
    ----------
    before, end : ndarray, shape (MOVEMENT_COLUMNS,)
        Rows that `MovementSums` returned.
    samples : int
        Number of samples of the span, at least 1.
    """
    x, y, z, square, *_ = ((end - before) / samples).tolist()
    return math.sqrt(max(square - x * x - y * y - z * z, _LEAST_STRENGTH_MPS2**2))


class WalkingBelief:
    """Logarithm of the odds that somebody walks, carried from peak to peak.

    Attributes
    ----------
    log_odds : float
        Above 0 while it is more probable that somebody walks.
    """

    def __init__(self) -> None:
        self.reset()

    def reset(self) -> None:
        """Forget the past, for a new segment."""
        self.log_odds = _AT_FIRST

    def stand(self) -> None:
        """Take it that a standstill came before the next peak."""
        self.log_odds = min(self.log_odds, _AT_FIRST)

    def add(self, movement: Movement) -> None:
        """Add the evidence of a peak."""
        walking = probability(self.log_odds)
        walking += (1.0 - walking) * _START - walking * _STOP
        self.log_odds = math.log(walking / (1.0 - walking)) + movement.log_odds
