"""Watch the vertical motion, and compare hypotheses only around what may be the beginning or the end of a flight.

Most walks have no stairs, and the hypotheses cost as much as the rest of the front end. What they would say of a
stretch in which the vertical velocity hardly changes is known beforehand: level.
"""

import math
from collections import deque

from pdr_est.front_end.step_length.stairs.flight_hypotheses import UNSETTLED_STEPS, FlightHypotheses
from pdr_est.front_end.step_length.stairs.stair_params import StairParams
from pdr_est.front_end.step_length.stairs.vertical_motion import VerticalMotion

_RECENT_STEPS = 12  # before a change, which the hypotheses learn the error of the acceleration from
_AWAKE_STEPS = 20  # after the last change
_CHANGE = 0.5  # of the velocity, over that on stairs, that wakes the hypotheses
_VELOCITIES = 4  # that a change is taken from, two before and two after it
_LEAST_CHANGES = 3  # for their mean
_CLIMB_STEPS, _CLIMB = 8, 0.5  # steps, and their change of height over that on stairs, that wakes them
_LEVEL = 1e-3  # probability of stairs below which they may sleep


class FlightWatch:
    """Probability of each step to lie on stairs, in the order of the steps.

    Parameters
    ----------
    parameters : StairParams
        Dimensions of stairs, and noise.
    """

    def __init__(self, parameters: StairParams) -> None:
        self._rise_m = parameters.rise_m
        self._hypotheses = FlightHypotheses(parameters)
        self._recent: deque[VerticalMotion] = deque(maxlen=_RECENT_STEPS)
        self._changes_mps: deque[float] = deque(maxlen=_RECENT_STEPS)
        self._level = 0  # latest steps that were not given to the hypotheses; their probability is 0 unless they wake
        self._awake = 0  # steps for which the hypotheses are still needed
        self._is_watched = False  # by the hypotheses
        self._known_already = 0  # first steps that they were given and whose probabilities were returned before

    def add(self, motion: VerticalMotion) -> list[float]:
        """Take in the next step; return the probabilities of the steps that have become final."""
        final: list[float] = []
        if motion.begins:
            final = self.finish()
            self._recent.clear()
            self._changes_mps.clear()
        if not self._awake and self._level == _RECENT_STEPS:
            final.append(0.0)
            self._level -= 1
        self._recent.append(motion)
        self._level += 1
        if self._changes():
            self._awake = _AWAKE_STEPS
        if not self._awake:
            return final
        fresh = list(self._recent)[-self._level :]
        if not self._is_watched:  # the steps before them are final, but tell the error of the acceleration
            fresh = list(self._recent)
            self._known_already = len(fresh) - self._level
            self._is_watched = True
        final += self._new([found for step in fresh for found in self._hypotheses.add(step)])
        self._level = 0
        self._awake = max(self._awake - 1, 1)
        if self._awake == 1 and self._hypotheses.probability < _LEVEL:
            final += self._sleep()
        return final

    def finish(self) -> list[float]:
        """Return the probabilities of the other steps."""
        final = [*self._sleep(), *[0.0] * self._level]
        self._level = 0
        return final

    def _sleep(self) -> list[float]:
        """Return what the hypotheses say of the steps that they were given."""
        self._awake, self._is_watched = 0, False
        return self._new(self._hypotheses.finish())

    def _new(self, found: list[float]) -> list[float]:
        """Leave out the probabilities of steps that are final."""
        left_out = min(self._known_already, len(found))
        self._known_already -= left_out
        return found[left_out:]

    def _changes(self) -> bool:
        """Tell whether the vertical motion of the last steps may be that of the begin or the end of a flight."""
        recent = self._recent
        if len(recent) < UNSETTLED_STEPS + _VELOCITIES:
            return False
        after_mps = recent[-2].velocity_mps + recent[-1].velocity_mps
        change_mps = 0.5 * (after_mps - recent[-4].velocity_mps - recent[-3].velocity_mps)
        usual_mps = 0.0
        if len(self._changes_mps) >= _LEAST_CHANGES:
            usual_mps = math.fsum(self._changes_mps) / len(self._changes_mps)
        if math.isfinite(change_mps):
            self._changes_mps.append(change_mps)
        climbed_m = abs(recent[-1].height_m - recent[-min(_CLIMB_STEPS, len(recent))].height_m)
        is_change = abs(change_mps - usual_mps) > _CHANGE * self._rise_m / recent[-1].pace_s
        return is_change or climbed_m > _CLIMB * self._rise_m * (_CLIMB_STEPS - 1)
