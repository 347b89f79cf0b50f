"""Tell sideways and backward walking at the step, by the steps so far.

The chain of the whole walk (`sideways_chain`) runs forward only. It begins where the phone turns, with mean and noise
of the acceleration of the steps before, and ends when the walker moves ahead again for certain. What is not certain
yet, a few steps after each turn, is told as doubt.
"""

from collections import deque
from collections.abc import Sequence

import numpy as np

from pdr_est.frames import Array, wrap_angle
from pdr_est.front_end.heading.course.course_likelihood import (
    LEAST_STEPS,
    LEAST_TURN_RAD,
    RATES,
    TURNS_WITHIN,
    AheadMoments,
    angle_and_doubt,
    log_likelihood,
    robust_moments,
)
from pdr_est.front_end.heading.course.course_params import CourseParams
from pdr_est.front_end.heading.course.leading_acceleration import leading_acceleration, shows_course
from pdr_est.front_end.heading.course.sideways_chain import ANGLES_RAD, moved_on, walking_ahead
from pdr_est.front_end.heading.stride_pairing import stride_averages
from pdr_est.records import changed
from pdr_est.types.steps import Step

_REMEMBERED = 60  # steps ahead that tell mean and noise
_LEAST_RAD = 0.02  # angle and doubt together, below which the walker moves ahead
_CERTAIN = 0.01  # probability of moving otherwise below which the chain ends
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
        self._state: Array | None = None  # probabilities (2, r, 72)
        self._moments: AheadMoments | None = None
        self._waits = 0  # steps until another turn may begin a chain

    def push(self, item: Step, /) -> list[Step]:
        """Return the step with its direction of motion."""
        if item.turn_hypotheses or item.event.segment != self._segment:
            self._segment = item.event.segment
            self._begin()
        last = self._headings[-1] if self._headings else item.heading_rad
        self._headings.append(last + float(wrap_angle(item.heading_rad - last)))
        self._steps.append(item)
        self._waits = max(self._waits - 1, 0)
        if self._state is None:
            if not self._turns() or self._waits:
                self._log_evidence = self._log_evidence + np.log1p(-RATES)
                return [item]
            return [self._first(item)]
        self._observe(*self._latest(self._steps))
        return [self._described(item)]

    def flush(self) -> list[Step]:
        """Return nothing: no step is held back."""
        return []

    def _turns(self) -> bool:
        """Return True for a phone that turned over the last steps."""
        latest = list(self._headings)[-TURNS_WITHIN - 1 :]
        return max(abs(latest[-1] - one) for one in latest) > LEAST_TURN_RAD

    def _first(self, item: Step) -> Step:
        """Begin a chain before the turn."""
        self._waits = TURNS_WITHIN
        steps, heading = list(self._steps), np.array(self._headings)
        acceleration = stride_averages(leading_acceleration(steps) * np.exp(-1j * heading))
        counts = np.array([shows_course(step) for step in steps])
        before = counts[: -TURNS_WITHIN - 1]
        if np.count_nonzero(before) < LEAST_STEPS:
            return item
        moments = robust_moments(acceleration[: len(before)][before])
        if abs(moments.mean[0]) < self._parameters.least_clearness * np.sqrt(moments.variance[0]):
            return item
        self._moments, self._state = moments, walking_ahead(len(RATES))
        turns = np.diff(heading)
        for k in range(len(before), len(steps)):
            self._observe(acceleration[k], bool(counts[k]), float(turns[k - 1]))
        return self._described(item)

    def _latest(self, steps: Sequence[Step]) -> tuple[complex, bool, float]:
        """Return the acceleration of the last stride, whether it counts, and the turn since the step before."""
        pair, heading = [steps[-2], steps[-1]], np.array([self._headings[-2], self._headings[-1]])
        acceleration = (leading_acceleration(pair) * np.exp(-1j * heading)).mean()
        return complex(acceleration), all(map(shows_course, pair)), float(heading[1] - heading[0])

    def _observe(self, acceleration: complex, counts: bool, turn_rad: float) -> None:
        """Move the chain on by a step."""
        if self._state is None or self._moments is None:
            raise ValueError("a step was observed before the chain began")
        state = moved_on(self._state, turn_rad, RATES)
        mean, variance = self._moments.mean, self._moments.variance
        if counts:
            expected = mean[:, None] * _PHASORS
            density = log_likelihood(np.abs(acceleration - expected) ** 2, variance[:, None], self._parameters)
            state = state * np.exp(density - density[:, :1])
        total = state.sum(axis=(0, 2))
        self._state = state / total[:, None]
        self._log_evidence = self._log_evidence + np.log(total)

    def _described(self, item: Step) -> Step:
        """Give a step its direction of motion and doubt, and end the chain when the walker moves ahead."""
        if self._state is None:
            return item
        probability = self._state.sum(axis=0)
        ahead = probability[:, _AHEAD].sum(axis=1)
        probability[:, _AHEAD] = 0.0
        probability[:, 0] = ahead
        mean_rad, sigma_rad = (float(one[0]) for one in angle_and_doubt(probability[None], self._log_evidence))
        if not self._turns() and float(ahead.min()) > 1.0 - _CERTAIN:
            self._state = self._moments = None
        if float(np.abs(mean_rad)) < sigma_rad:  # ahead as likely as not
            mean_rad, sigma_rad = 0.0, float(np.hypot(mean_rad, sigma_rad))
        if np.hypot(mean_rad, sigma_rad) < _LEAST_RAD:
            return item
        return changed(
            item,
            heading_rad=float(wrap_angle(item.heading_rad + mean_rad)),
            course_offset_rad=mean_rad,
            sigma_course_rad=sigma_rad,
        )
