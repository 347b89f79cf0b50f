"""Probability that a step is one of a runner, whose acceleration tells the direction of motion otherwise.

A walker exchanges height for speed and is fastest when the trunk is lowest. A runner is slowest then: the leg brakes
and pushes like a spring. So the leading acceleration of a runner points backwards. Measured with a box that stays at
the belt (SisFall, 9 people): from quick walking to jogging it turns by 163 to 187 degrees and grows by half. In
trouser pockets (MotionSense) it mostly turns about as far, but a thigh moves by itself.
"""

from collections.abc import Sequence
from math import exp, log

import numpy as np

from pdr_est.frames import Array
from pdr_est.front_end.heading.step_motion import motions_of
from pdr_est.types.steps import Step, StepMotion

MOSTLY = 0.5
"""Probability from which on a step is left out where medians tell what is usual of a walker."""

# Logistic regression on the root mean square of the vertical acceleration and on the cadence: of 4154 walking and
# 6330 jogging steps of SisFall, and 5977 and 3677 of MotionSense (stairs are walked). In other sets it takes 0.06 %
# (Awinda), 0.13 % (playing fields) and none (DSADS, YuDa) of the walking steps and 97 % of the running ones (DSADS)
# for running.
_CONSTANT, _BY_LOG_BOUNCE, _BY_LOG_CADENCE = -21.8, 5.9, 12.6
# Cadence, Hz, in which the regression holds: slower ones are mostly missed steps, quicker ones knocks.
_SLOWEST_HZ, _QUICKEST_HZ = 1.9, 3.0
_LEAST_BOUNCE_MPS2 = 0.05
# Standard deviation in one direction of the leading acceleration of a runner who moves anywhere, in both sets.
_RUNNER_MPS2 = 1.1


def running_probability(step: Step, motion: StepMotion) -> float:
    """Compute the probability that a step is one of a runner or jogger, by bounce and cadence."""
    bounce = log(max(motion.bounce_mps2, _LEAST_BOUNCE_MPS2))
    cadence = log(min(max(step.frequency_hz, _SLOWEST_HZ), _QUICKEST_HZ))
    return 1.0 / (1.0 + exp(-(_CONSTANT + _BY_LOG_BOUNCE * bounce + _BY_LOG_CADENCE * cadence)))


def running_probabilities(steps: Sequence[Step]) -> Array:
    """Compute the probability that a step is one of a runner or jogger for each of some steps (n,)."""
    return np.array([running_probability(*one) for one in zip(steps, motions_of(steps), strict=True)])


def runner_density(acceleration: Array) -> Array:
    """Compute the density of the leading acceleration (...) of a runner, in whichever direction; times 2 pi."""
    variance = _RUNNER_MPS2**2
    return np.asarray(np.exp(-(np.abs(acceleration) ** 2) / (2.0 * variance)) / variance)
