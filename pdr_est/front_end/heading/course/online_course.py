"""Tell sideways and backward walking at the step, by the steps so far.

The chain of the whole walk (`sideways_chain`) runs forward only. It begins where the phone turns, with mean and noise
of the acceleration of the steps before, and ends when the walker moves ahead again for certain. What is not certain
yet, a few steps after each turn, is told as doubt.
"""

import cmath
from collections import deque

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array, wrap_angle
from pdr_est.front_end.heading.course.course_likelihood import (
    LEAST_STEPS,
    LEAST_TURN_RAD,
    RATES,
    TURNS_WITHIN,
    angle_and_doubt,
    course_log_likelihood,
    robust_moments,
)
from pdr_est.front_end.heading.course.course_params import CourseParams
from pdr_est.front_end.heading.course.leading_acceleration import leading_acceleration_of, shows_course
from pdr_est.front_end.heading.course.sideways_chain import ANGLES_RAD, moved_on, walking_ahead
from pdr_est.front_end.heading.stride_pairing import stride_averages
from pdr_est.records import changed
from pdr_est.types.steps import Step

_REMEMBERED = 60  # steps ahead that tell mean and noise
_LEAST_RAD = 0.02  # angle and doubt together, below which the walker moves ahead
_NO_DOUBT = 1e-4  # probability of moving otherwise that is not told
_CERTAIN = 0.01  # probability of moving otherwise below which the chain ends
_LOG_GOES_ON = np.log1p(-RATES)
_PHASORS = np.exp(1j * ANGLES_RAD)
_AHEAD = np.abs(ANGLES_RAD) < 0.6  # by so little the hand may turn against the body


class OnlineCourse:
    """Stage Step -> Step that gives steps of sideways and backward walking the direction of motion, or doubt.

    It fills in `course_offset_rad` and `sigma_course_rad`, and turns `heading_rad` by the former.

    Parameters
    ----------
    parameters : CourseParams
        Parameters.
    """

    latency_s = 0.0

    def __init__(self, parameters: CourseParams) -> None:
        self._parameters = parameters
        self._segment: int | None = None
        self._log_evidence: Array = np.zeros(len(RATES))
        self._begin()

    def _begin(self) -> None:
        """Forget the steps in another place of the phone."""
        self._steps: deque[Step] = deque(maxlen=_REMEMBERED)
        self._headings: deque[float] = deque(maxlen=_REMEMBERED)
        self._counts: deque[bool] = deque(maxlen=_REMEMBERED)
        self._accelerations: deque[complex | None] = deque(maxlen=_REMEMBERED)  # None where not computed yet
        self._latest_headings: deque[float] = deque(maxlen=TURNS_WITHIN + 1)
        self._state: Array | None = None  # probabilities (2, r, 72)
        self._expected, self._variance = _PHASORS, 1.0  # acceleration for each angle, and its variance
        self._waits = 0  # steps until another turn may begin a chain

    def push(self, item: Step, /) -> list[Step]:
        """Return the step with its direction of motion."""
        if item.turn_hypotheses or item.event.segment != self._segment:
            self._segment = item.event.segment
            self._begin()
        last = self._headings[-1] if self._headings else item.heading_rad
        heading = last + (item.heading_rad - last + np.pi) % (2.0 * np.pi) - np.pi
        self._headings.append(heading)
        self._latest_headings.append(heading)
        self._steps.append(item)
        self._counts.append(shows_course(item))
        self._accelerations.append(None)
        self._waits = max(self._waits - 1, 0)
        if self._state is None:
            if not self._turns() or self._waits:
                self._log_evidence = self._log_evidence + _LOG_GOES_ON
                return [item]
            return [self._first(item)]
        self._observe(*self._latest())
        return [self._described(item)]

    def flush(self) -> list[Step]:
        """Return nothing: no step is held back."""
        return []

    def _turns(self) -> bool:
        """Return True for a phone that turned over the last steps."""
        last = self._headings[-1]
        return any(abs(last - one) > LEAST_TURN_RAD for one in self._latest_headings)

    def _first(self, item: Step) -> Step:
        """Begin a chain before the turn."""
        self._waits = TURNS_WITHIN
        heading, counts = np.array(self._headings), np.array(self._counts)
        acceleration = stride_averages(self._all_accelerations() * np.exp(-1j * heading))
        before = counts[: -TURNS_WITHIN - 1]
        if np.count_nonzero(before) < LEAST_STEPS:
            return item
        moments = robust_moments(acceleration[: len(before)][before])
        if abs(moments.mean[0]) < self._parameters.least_clearness * np.sqrt(moments.variance[0]):
            return item
        self._expected, self._variance = moments.mean[0] * _PHASORS, float(moments.variance[0])
        self._state = walking_ahead(len(RATES))
        turns = np.diff(heading)
        for k in range(len(before), len(heading)):
            self._observe(acceleration[k], bool(counts[k]), float(turns[k - 1]))
        return self._described(item)

    def _all_accelerations(self) -> NDArray[np.complex128]:
        """Return the leading accelerations of all remembered steps, of which only the latest are not computed yet."""
        known = [one for one in self._accelerations if one is not None]
        new = map(leading_acceleration_of, list(self._steps)[len(known) :])
        self._accelerations = deque([*known, *new], maxlen=_REMEMBERED)
        return np.array(self._accelerations)

    def _latest(self) -> tuple[complex, bool, float]:
        """Return the acceleration of the last stride, whether it counts, and the turn since the step before."""
        self._accelerations[-1] = leading_acceleration_of(self._steps[-1])
        (before, last), headings = (self._accelerations[k] or 0.0 for k in (-2, -1)), self._headings
        acceleration = 0.5 * (before * cmath.exp(-1j * headings[-2]) + last * cmath.exp(-1j * headings[-1]))
        return acceleration, self._counts[-2] and self._counts[-1], headings[-1] - headings[-2]

    def _observe(self, acceleration: complex, counts: bool, turn_rad: float) -> None:
        """Move the chain on by a step."""
        if self._state is None:
            raise ValueError("a step was observed before the chain began")
        state = moved_on(self._state, turn_rad, RATES)
        if counts:
            distance2 = np.abs(acceleration - self._expected) ** 2
            density = course_log_likelihood(distance2, self._variance, self._parameters)
            state *= np.exp(density - density[0])
        total = state.sum(axis=(0, 2))
        self._state = state / total[:, None]
        self._log_evidence = self._log_evidence + np.log(total)

    def _described(self, item: Step) -> Step:
        """Give a step its direction of motion and doubt, and end the chain when the walker moves ahead."""
        if self._state is None:
            return item
        probability = self._state[0] + self._state[1]
        ahead = probability[:, _AHEAD].sum(axis=1)
        least = float(ahead.min())
        if least > 1.0 - _CERTAIN and not self._turns():
            self._state = None
        if least > 1.0 - _NO_DOUBT:
            return item
        probability[:, _AHEAD] = 0.0
        probability[:, 0] = ahead
        mean_rad, sigma_rad = (float(one[0]) for one in angle_and_doubt(probability[None], self._log_evidence))
        if abs(mean_rad) < 2.0 * sigma_rad:  # probability below 0.8, for a right angle
            mean_rad, sigma_rad = 0.0, float(np.hypot(mean_rad, sigma_rad))
        if np.hypot(mean_rad, sigma_rad) < _LEAST_RAD:
            return item
        return changed(
            item,
            heading_rad=float(wrap_angle(item.heading_rad + mean_rad)),
            course_offset_rad=mean_rad,
            sigma_course_rad=sigma_rad,
        )
