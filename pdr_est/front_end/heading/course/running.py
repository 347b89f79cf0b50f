"""Probability that a step is one of a runner, whose acceleration tells the direction of motion otherwise.

A walker exchanges height for speed and is fastest when the trunk is lowest. A runner is slowest then: the leg brakes
and pushes like a spring. So the leading acceleration of a runner points backwards. Measured with a box that stays at
the belt (SisFall, 7 people): from quick walking to jogging it turns by 165 to 184 degrees and mostly grows. In
trouser pockets (MotionSense) it turns by more than 140 degrees for 10 of 14 people: a thigh moves by itself.

Bounce and cadence tell a runner, by themselves and over those that are usual of the same walker. Nobody runs for a
single step: the probability goes on from step to step.
"""

from collections.abc import Iterable, Sequence
from math import exp, log
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.types.steps import Step, StepMotion

MOSTLY = 0.5
"""Probability from which on a step is left out where medians tell what is usual of a walker."""

# Logistic regressions on the logarithms of the root mean square of the vertical acceleration and of the cadence: of
# 4154 walking and 6330 jogging steps of SisFall, and 5977 and 3677 of MotionSense (stairs are walked). The second one
# also has how much larger both are than the median of the walking steps of the same person. It is wrong at 0.6 and
# 0.4 % of these walking steps and 1.2 and 1.1 % of the running ones; in other sets at 0.4 % (DSADS), 0.6 % (Awinda),
# 0.3 % (playing fields) and 0.7 % (YuDa) of the walking steps and 3 % (DSADS) of the running ones.
_BY_ITSELF = (-21.8, 5.9, 12.6)
_OVER_USUAL = (-18.3, 4.9, 7.0, 4.7, 3.8)
# Cadence, Hz, in which they hold: slower ones are mostly missed steps, quicker ones knocks; and the same over the
# usual one.
_SLOWEST_HZ, _QUICKEST_HZ = 1.9, 3.0
_SLOWEST_AT_ALL_HZ, _QUICKEST_AT_ALL_HZ = 1.2, 3.6
_LEAST_BOUNCE_MPS2 = 0.05
_LEAST_WALKED = 10  # steps of a walker that tell what is usual
_CHANGES = 0.002  # probability per step that a walker begins to run or stops running; ours
# Standard deviation in one direction of the leading acceleration of a runner who moves anywhere, in both sets.
_RUNNER_MPS2 = 1.1


class StepPace(NamedTuple):
    """Logarithms of bounce and cadence of a step; `known` is False where they tell nothing."""

    log_bounce: float
    log_cadence: float
    known: bool


_UNKNOWN = StepPace(0.0, 0.0, False)


def pace_of(step: Step, motion: StepMotion) -> StepPace:
    """Return bounce and cadence of a step."""
    if step.frequency_hz == 0.0 or step.event.compensated:
        return _UNKNOWN
    cadence_hz = min(max(step.frequency_hz, _SLOWEST_AT_ALL_HZ), _QUICKEST_AT_ALL_HZ)
    return StepPace(log(max(motion.bounce_mps2, _LEAST_BOUNCE_MPS2)), log(cadence_hz), True)


class RunningBelief:
    """Probability that a person runs, from one step to the next.

    Parameters
    ----------
    before : sequence of StepPace
        Steps that tell what is usual of this walker.
    correlated_steps : float
        Number of neighbouring steps that count as one observation.
    """

    def __init__(self, before: Sequence[StepPace], correlated_steps: float) -> None:
        self._correlated_steps = correlated_steps
        self._usual = _usual(before)
        self._running = MOSTLY

    def push(self, pace: StepPace) -> float:
        """Take the next step and return the probability that it is one of a runner, by the steps so far."""
        prior = _changed(self._running)
        ratio = exp(self.log_odds(pace))
        self._running = prior * ratio / (prior * ratio + 1.0 - prior)
        return self._running

    def log_odds(self, pace: StepPace) -> float:
        """Compute the logarithm of the odds that a step is one of a runner, by itself."""
        return _log_odds(pace, self._usual) / self._correlated_steps


def running_probabilities(paces: Sequence[StepPace], correlated_steps: float) -> Array:
    """Compute the probability that each of some steps (n,) is one of a runner, by all of them."""
    belief = RunningBelief(paces, correlated_steps)
    ahead = [belief.push(pace) for pace in paces]
    found, later = [], 1.0  # likelihood ratio of all later steps
    for running, pace in zip(reversed(ahead), reversed(paces), strict=True):
        found.append(running * later / (running * later + 1.0 - running))
        ratio = later * exp(belief.log_odds(pace))
        later = (ratio * (1.0 - _CHANGES) + _CHANGES) / (ratio * _CHANGES + 1.0 - _CHANGES)
    return np.array(found[::-1])


def runner_density(acceleration: NDArray[np.complex128]) -> Array:
    """Compute the density (n,) of the leading acceleration of a runner in whichever direction, times 2 pi."""
    variance = _RUNNER_MPS2**2
    return np.asarray(np.exp(-(np.abs(acceleration) ** 2) / (2.0 * variance)) / variance)


def _changed(running: float) -> float:
    """Compute the probability of a runner at the next step from that at a step."""
    return running * (1.0 - _CHANGES) + (1.0 - running) * _CHANGES


def _usual(paces: Iterable[StepPace]) -> tuple[float, float] | None:
    """Compute the usual logarithms of bounce and cadence of a walker; None if too few steps tell them."""
    walked = [pace[:2] for pace in paces if pace.known and _log_odds(pace, None) < 0.0]
    if len(walked) < _LEAST_WALKED:
        return None
    bounce, cadence = np.median(np.array(walked), axis=0).tolist()
    return bounce, cadence


def _log_odds(pace: StepPace, usual: tuple[float, float] | None) -> float:
    bounce, cadence, known = pace
    if not known:
        return 0.0
    by_itself = min(max(cadence, log(_SLOWEST_HZ)), log(_QUICKEST_HZ))
    if usual is None:
        constant, by_bounce, by_cadence = _BY_ITSELF
        return constant + by_bounce * bounce + by_cadence * by_itself
    constant, by_bounce, by_cadence, over_bounce, over_cadence = _OVER_USUAL
    over = over_bounce * (bounce - usual[0]) + over_cadence * (cadence - usual[1])
    return constant + by_bounce * bounce + by_cadence * by_itself + over
