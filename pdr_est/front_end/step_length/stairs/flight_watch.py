"""Watch the vertical motion, and compare hypotheses only around what may be the beginning or the end of a flight.

Most walks have no stairs, and the hypotheses cost as much as the rest of the front end. They sleep while the walk is
level: while its vertical velocity and its air pressure change by no more than their own noise. The noise is that of
the steps before; that of the first steps is learnt from these themselves before they are judged, so that an unsteady
hand is no flight at the beginning of a recording either.

The constants below are ours. The probability that wakes and the number of first steps were compared on level walks of
eleven sets with the velocities of flights added to them; what was best on ten sets served the other one as well.
"""

import math
from collections import deque
from collections.abc import Sequence

from pdr_est.front_end.step_length.stairs.flight_hypotheses import UNSETTLED_STEPS, FlightHypotheses
from pdr_est.front_end.step_length.stairs.stair_params import StairParams
from pdr_est.front_end.step_length.stairs.velocity_changes import CHANGE_VARIANCE, VelocityChanges
from pdr_est.front_end.step_length.stairs.vertical_motion import VerticalMotion
from pdr_est.front_end.step_length.stairs.walk_noise import WalkNoise

_TEACHING_STEPS = 24  # first ones of a recording, whose noise is learnt before any of them is judged
_RECENT_STEPS = 16  # up to a suspicious one, which the hypotheses begin with
_LEVEL_STEPS = 12  # before these, which tell the errors of the velocity
_LEAST_LEVEL_STEPS = 4  # that are enough for it
_AWAKE_STEPS = 8  # after the last suspicious one
_SUSPICIOUS = 0.07  # probability of the beginning or end of a flight that wakes the hypotheses
_LEVEL = 1e-3  # probability of stairs below which they may sleep
_CLIMB_STEPS = 7  # over which the height is compared
_LARGEST_LOG_ODDS = 50.0


class FlightWatch:
    """Probability of each step to lie on stairs, in the order of the steps.

    Parameters
    ----------
    parameters : StairParams
        Dimensions of stairs, and noise.
    """

    def __init__(self, parameters: StairParams) -> None:
        self._rise_m = parameters.rise_m
        self._velocity_variance = CHANGE_VARIANCE * parameters.sigma_velocity_mps**2  # of changes, by the parameters
        self._height_variance = 2.0 * parameters.sigma_height_m**2
        self._height_variance_per_s = parameters.sigma_height_drift_m_per_sqrt_s**2
        self._height_noise = WalkNoise()
        self._log_prior = math.log(1.0 / parameters.steps_between_flights)  # for up and for down each
        self._hypotheses = FlightHypotheses(parameters)
        self._changes = VelocityChanges(UNSETTLED_STEPS)
        self._recent: deque[VerticalMotion] = deque(maxlen=_LEVEL_STEPS + _RECENT_STEPS)
        self._untaught: list[VerticalMotion] | None = []  # the first steps, until their noise has been learnt
        self._walked = 0  # steps of the stretch
        self._level = 0  # latest steps that were not given to the hypotheses; their probability is 0 unless they wake
        self._awake = 0  # steps for which the hypotheses are still needed
        self._known_already = 0  # first steps that they were given and whose probabilities were returned before

    def add(self, motions: Sequence[VerticalMotion]) -> list[float]:
        """Take in the next steps, at least one; return the probabilities of the steps that have become final."""
        if self._untaught is not None:
            self._untaught += motions
            return [] if len(self._untaught) < _TEACHING_STEPS else self._taught()
        final: list[float] = []
        for motion, late_mps, early_mps in zip(motions, *self._changes.after(motions).tolist(), strict=True):
            final += self._with(motion, late_mps, early_mps)
        return final

    def finish(self) -> list[float]:
        """Return the probabilities of the other steps."""
        final = [] if self._untaught is None else self._taught()
        return final + self._end()

    def _taught(self) -> list[float]:
        """Learn the noise of the first steps, and judge these."""
        motions, self._untaught = self._untaught or [], None
        if not motions:
            return []
        first = motions[:_TEACHING_STEPS]
        for motion, change_mps in zip(first, VelocityChanges(UNSETTLED_STEPS).after(first)[0].tolist(), strict=True):
            self._learn(change_mps, self._change_probability(change_mps, motion))
        return self.add(motions)

    def _with(self, motion: VerticalMotion, late_mps: float, early_mps: float) -> list[float]:
        """Take in one step, with the sizes of the changes that it completes."""
        final: list[float] = []
        if motion.begins:
            final = self._end()
            self._recent.clear()
            self._walked = 0
        if not self._awake and self._level == _RECENT_STEPS:
            final.append(0.0)
        else:
            self._level += 1
        self._recent.append(motion)
        self._walked += 1
        probability = self._change_probability(max(late_mps, early_mps), motion)
        is_suspicious = max(probability, self._climb_probability(motion)) > _SUSPICIOUS
        if not self._awake:
            self._learn(late_mps, probability)
            return final + self._wake() if is_suspicious else final
        if is_suspicious:
            self._awake = _AWAKE_STEPS
        return final + self._ask([motion])

    def _change_probability(self, change_mps: float, motion: VerticalMotion) -> float:
        """Compute the probability that a change of the velocity of this size is the beginning or end of a flight.

        It is 0 for NaN.
        """
        if change_mps != change_mps:
            return 0.0
        variance = self._velocity_variance * self._hypotheses.noise.variance
        return self._probability(change_mps, self._rise_m / motion.pace_s, variance)

    def _learn(self, change_mps: float, probability: float) -> None:
        """Learn the noise from a change of the velocity, which is that of a flight with this probability."""
        if change_mps == change_mps:
            noise = self._hypotheses.noise
            noise.learn(change_mps * change_mps / (self._velocity_variance * noise.variance), 1.0 - probability)

    def _climb_probability(self, motion: VerticalMotion) -> float:
        """Compute the probability of a flight by the air pressure, and learn the noise of that; 0 without any."""
        if motion.height_m != motion.height_m or len(self._recent) <= _CLIMB_STEPS:
            return 0.0
        climb_m = abs(motion.height_m - self._recent[-1 - _CLIMB_STEPS].height_m)
        if not math.isfinite(climb_m + motion.velocity_mps):
            return 0.0
        variance = self._height_variance + self._height_variance_per_s * _CLIMB_STEPS * motion.pace_s
        variance *= self._height_noise.variance
        probability = self._probability(climb_m, self._rise_m * _CLIMB_STEPS, variance)
        self._height_noise.learn(climb_m * climb_m / variance, 1.0 - probability)
        return probability

    def _probability(self, size: float, expected: float, variance: float) -> float:
        """Compute the probability that something is a flight by its size and variance, and the size at a flight."""
        log_odds = expected * (size - 0.5 * expected) / variance + self._log_prior
        return 1.0 / (1.0 + math.exp(-max(log_odds, -_LARGEST_LOG_ODDS)))

    def _wake(self) -> list[float]:
        """Give the hypotheses the last steps, and those before as level; return what they say of further ones."""
        recent = list(self._recent)
        unsettled = max(UNSETTLED_STEPS - (self._walked - len(recent)), 0)
        begin = max(len(recent) - _RECENT_STEPS, 0)
        if begin - unsettled < _LEAST_LEVEL_STEPS:
            begin = 0  # where the stretch does, too
        else:
            self._hypotheses.begin_level(recent[unsettled:begin])
        self._known_already = len(recent) - begin - self._level
        self._awake = _AWAKE_STEPS
        return self._ask(recent[begin:])

    def _ask(self, motions: Sequence[VerticalMotion]) -> list[float]:
        """Give the hypotheses the next steps; return what they say, for good."""
        final = self._new([found for motion in motions for found in self._hypotheses.add(motion)])
        self._level = 0
        self._awake = max(self._awake - 1, 1)
        if self._awake == 1 and self._hypotheses.probability < _LEVEL:
            final += self._sleep()
        return final

    def _end(self) -> list[float]:
        """Return the probabilities of the steps of the stretch that are not final yet."""
        final = [*self._sleep(), *[0.0] * self._level]
        self._level = 0
        return final

    def _sleep(self) -> list[float]:
        """Return what the hypotheses say of the steps that they were given."""
        self._awake = 0
        return self._new(self._hypotheses.finish())

    def _new(self, found: list[float]) -> list[float]:
        """Leave out the probabilities of steps that are final."""
        left_out = min(self._known_already, len(found))
        self._known_already -= left_out
        return found[left_out:]
