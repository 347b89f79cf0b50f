"""Tell sideways and backward walking at the step, by the steps so far.

The chain of the whole walk (`sideways_chain`) runs forward only. It begins where the phone turns, with mean and noise
of the acceleration of the steps before, and ends when the walker moves ahead again for certain. What is not certain
yet, a few steps after each turn, is in the standard deviation of the direction.
"""

from cmath import rect
from collections import deque
from collections.abc import Sequence
from itertools import pairwise
from math import hypot, sqrt
from typing import NamedTuple

import numpy as np

from pdr_est.front_end.heading.course.course_likelihood import (
    LEAST_STEPS,
    LEAST_TURN_RAD,
    RATES,
    TURNS_WITHIN,
    is_clear,
    robust_moments,
)
from pdr_est.front_end.heading.course.course_params import CourseParams
from pdr_est.front_end.heading.course.leading_acceleration import shows_course
from pdr_est.front_end.heading.course.online_chain import OnlineChain
from pdr_est.front_end.heading.course.running import MOSTLY, RunningBelief, StepPace, pace_of
from pdr_est.front_end.heading.phone_posture import wrapped
from pdr_est.front_end.heading.step_motion import motions_of
from pdr_est.front_end.heading.stride_pairing import stride_averages
from pdr_est.records import changed
from pdr_est.types.steps import Step, StepMotion

_REMEMBERED = 60  # steps ahead that tell mean and noise
_LEAST_RAD = 0.02  # angle and doubt together, below which the walker moves ahead
_NO_DOUBT = 1e-4  # probability of moving otherwise that is not told
_CERTAIN = 0.01  # probability of moving otherwise below which the chain ends
_LOG_GOES_ON = np.log1p(-RATES).tolist()


class _Seen(NamedTuple):
    """Direction, acceleration and gait of a step.

    Attributes
    ----------
    heading_rad : float
        Its heading, continuous.
    acceleration : complex
        Its leading acceleration, m/s^2, turned back by the heading.
    pace : StepPace
        Its bounce and cadence.
    counts : bool
        True if that shows the direction of motion.
    turns : bool
        True if the phone turned over the last steps.
    """

    heading_rad: float
    acceleration: complex
    pace: StepPace
    counts: bool
    turns: bool


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
        self._log_evidence = [0.0] * len(RATES)
        self._begin()

    def _begin(self) -> None:
        """Forget the steps in another place of the phone."""
        self._seen: list[_Seen] = []
        self._latest_headings: deque[float] = deque(maxlen=TURNS_WITHIN + 1)
        self._chain: OnlineChain | None = None
        self._running = RunningBelief((), self._parameters.correlated_steps)  # of the steps that the chain takes
        self._waits = 0  # steps until another turn may begin a chain

    def push(self, item: Step, /) -> list[Step]:
        """Return the step with its direction of motion."""
        return self.push_all([item])

    def push_all(self, items: Sequence[Step], /) -> list[Step]:
        """Return the steps with their directions of motion."""
        motions = motions_of(items)
        done: list[Step] = []
        for first, last in self._places(items):
            if items[first].turn_hypotheses or items[first].event.segment != self._segment:
                self._segment = items[first].event.segment
                self._begin()
            done += self._in_place(items[first:last], motions[first:last])
        return done

    def flush(self) -> list[Step]:
        """Return nothing: no step is held back."""
        return []

    @staticmethod
    def _places(items: Sequence[Step]) -> list[tuple[int, int]]:
        """Divide steps, from and to (exclusive), where the phone was put elsewhere or a segment begins."""
        borders = [
            k
            for k, (before, item) in enumerate(pairwise(items), start=1)
            if item.turn_hypotheses or item.event.segment != before.event.segment
        ]
        return list(pairwise([0, *borders, len(items)])) if items else []

    def _in_place(self, items: Sequence[Step], motions: Sequence[StepMotion]) -> list[Step]:
        """Take steps with the phone in one place."""
        known = len(self._seen)
        for item, motion in zip(items, motions, strict=True):
            self._see(item, motion)
        seen, done = self._seen, list[Step]()
        while len(done) < len(items):
            k, at = len(done), known + len(done)
            if self._chain is None:
                done.append(self._look(items[k], at))
            else:
                done += self._follow(self._chain, items[k:], seen[at - 1 :])
        self._seen = seen[-_REMEMBERED:]
        return done

    def _see(self, item: Step, motion: StepMotion) -> None:
        """Add what a step shows to that of the steps before."""
        last = self._seen[-1].heading_rad if self._seen else item.heading_rad
        heading = last + wrapped(item.heading_rad - last)
        latest = self._latest_headings
        latest.append(heading)
        turns = max(latest) - heading > LEAST_TURN_RAD or heading - min(latest) > LEAST_TURN_RAD
        acceleration = complex(*motion.leading_mps2) * rect(1.0, -heading)
        self._seen.append(_Seen(heading, acceleration, pace_of(item, motion), shows_course(item), turns))

    def _look(self, item: Step, at: int) -> Step:
        """Take a step, number `at` of those seen, of a walker who moves ahead; begin a chain if the phone turned."""
        self._waits = max(self._waits - 1, 0)
        if self._seen[at].turns and not self._waits:
            return self._first(item, self._seen[max(at + 1 - _REMEMBERED, 0) : at + 1])
        self._log_evidence = [one + more for one, more in zip(self._log_evidence, _LOG_GOES_ON, strict=True)]
        return item

    def _first(self, item: Step, seen: Sequence[_Seen]) -> Step:
        """Begin a chain before the turn."""
        self._waits = TURNS_WITHIN
        acceleration = stride_averages(np.array([one.acceleration for one in seen], dtype=np.complex128))
        paces = [one.pace for one in seen]
        belief = RunningBelief(paces, self._parameters.correlated_steps)
        running = stride_averages(np.array([belief.push(pace) for pace in paces]))
        before = np.array([one.counts for one in seen[: -TURNS_WITHIN - 1]], dtype=bool)
        before &= running[: len(before)] < MOSTLY
        if np.count_nonzero(before) < LEAST_STEPS:
            return item
        moments = robust_moments(acceleration[: len(before)][before])
        mean, variance, count = complex(moments.mean[0]), float(moments.variance[0]), int(np.count_nonzero(before))
        if not is_clear(mean, variance, count, self._parameters):
            return item
        chain = OnlineChain(mean, variance, count, self._log_evidence, self._parameters)
        first = len(before)
        for k, (last, at) in enumerate(pairwise(seen[first - 1 :]), start=first):
            likelihood = chain.likelihood(complex(acceleration[k]), float(running[k])) if at.counts else None
            chain.move(at.heading_rad - last.heading_rad, likelihood)
        self._running = belief
        return self._described(item, seen[-1], chain)

    def _follow(self, chain: OnlineChain, items: Sequence[Step], seen: Sequence[_Seen]) -> list[Step]:
        """Move the chain on by steps until it ends; `seen` begins with the step before."""
        done: list[Step] = []
        for item, (last, at) in zip(items, pairwise(seen), strict=True):
            self._waits = max(self._waits - 1, 0)
            done.append(self._followed(chain, item, last, at))
            if self._chain is None:
                break
        return done

    def _followed(self, chain: OnlineChain, item: Step, last: _Seen, at: _Seen) -> Step:
        """Move the chain on by a step; end it where the acceleration turns out not to tell the direction."""
        turn_rad, running = at.heading_rad - last.heading_rad, self._running.push(at.pace)
        if not (last.counts and at.counts):
            chain.move(turn_rad, None)
            return self._described(item, at, chain)
        acceleration = 0.5 * (last.acceleration + at.acceleration)
        chain.move(turn_rad, chain.likelihood(acceleration, running))
        chain.learn(acceleration, running)
        if abs(chain.mean) < self._parameters.least_clearness * sqrt(chain.variance):
            self._chain = None
            return item
        return self._described(item, at, chain)

    def _described(self, item: Step, seen: _Seen, chain: OnlineChain) -> Step:
        """Give a step its direction of motion and doubt, and end the chain when the walker moves ahead."""
        ends = chain.ahead > 1.0 - _CERTAIN and not seen.turns
        self._chain, self._log_evidence = None if ends else chain, chain.log_evidence
        if chain.ahead > 1.0 - _NO_DOUBT:
            return item
        mean_rad, sigma_rad = chain.angle_and_doubt()
        if abs(mean_rad) < 2.0 * sigma_rad:  # probability below 0.8, for a right angle
            mean_rad, sigma_rad = 0.0, hypot(mean_rad, sigma_rad)
        if hypot(mean_rad, sigma_rad) < _LEAST_RAD:
            return item
        return changed(
            item,
            heading_rad=wrapped(item.heading_rad + mean_rad),
            course_offset_rad=mean_rad,
            sigma_course_rad=sigma_rad,
        )
