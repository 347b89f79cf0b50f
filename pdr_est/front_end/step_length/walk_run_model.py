"""Our step-length model with two laws: walking by the range of the acceleration, running by intensity and cadence.

Both are proportional to the height, and the stage blends them by the share of running (jogging counts as it). A
running step is never shorter than a walking one with the same acceleration.

Walking is `range-power`, MMPDR eq. 3 with a free exponent: across phones and people the range of the acceleration
varies far more than the step, so that a smaller exponent than 1/4 carries over better. It was compared, on walks of
known length, with a form of cadence, raw range and the ratio of two differently smoothed ranges. Fitted without the
floor of ILC 2.0 that is scored, that form has a spread (p90 - p10) of distance ratios of 0.23 in place of 0.26, or of
0.20 when the fit weighs this set most. But the scatter on the loops of OxIOD rises from 2.5 to 4 %, the mean error on
IPIN 2023 from 5 to 9 %, and fitted without ILC 2.0 it spreads more there (0.31). So the simpler one stays. Counting
long intervals as several steps was tried as well: errors rose on most sets, for such steps are hesitant ones.
"""

import math
from typing import Annotated

from annotated_types import Ge, Gt, Le

from pdr_est.frames import Array
from pdr_est.front_end.step_length.cadence import Pace
from pdr_est.front_end.step_length.equations import range_power_length_m
from pdr_est.params import Positive, params
from pdr_est.types.steps import Step

_HEIGHT_M = 1.73  # height of a person for whom the constants hold
_MOST_RANGE_MPS2 = 60.0  # largest range of a runner's acceleration; larger ones are knocks on the phone
_SLOWEST_RUN_HZ = (2.0, 2.25)  # steps per second: below the first nobody runs or jogs, above the second one may


@params
class RunningParams:
    """Length of a running step, which grows with cadence and intensity; the constants are set and not fitted.

    Cadence alone hardly tells running speeds apart. There is no recording of runners whose speed is known: with these
    constants the slow and quick jogs of SisFall come out at 2.3 and 3.1 m/s, the jogging of MotionSense at 3.4 m/s,
    and a single person's at 3.9 m/s at most.
    """

    length_m: Positive = 1.0
    """Length, m, of a running step of someone 1.73 m tall at the reference cadence and range; ours."""
    reference_cadence_hz: Positive = 2.6
    """Cadence, steps per second, at which a running step has this length; ours."""
    reference_range_mps2: Positive = 27.0
    """Range of the vertical acceleration, m/s^2, at which a running step has this length; ours."""
    cadence_exponent: Annotated[float, Ge(0.0), Le(2.0)] = 0.5
    """Power of the cadence; ours."""
    range_exponent: Annotated[float, Gt(0.0), Le(2.0)] = 0.6
    """Power of the range of the vertical acceleration; ours."""


def share_of_running(step: Step, cadence_hz: float) -> float:
    """Compute the weight of running in the length of a step; 0 where the gait is unknown.

    It is the classifier's probability of jogging or running, where the cadence allows for it. The classifier was
    trained on phones in pockets and on belts. Of the steps of ILC 2.0, walked with the phone held, it takes 4 % for
    running ones, a quarter of them below 2.2 steps per second, where only 1 % of the steps of joggers are
    (MotionSense, SisFall).
    """
    _, jogging, running = step.gait_probability
    if math.isnan(jogging + running):
        return 0.0
    slowest, surely = _SLOWEST_RUN_HZ
    return min(jogging + running, 1.0) * min(max((cadence_hz - slowest) / (surely - slowest), 0.0), 1.0)


def walking_length_m(k: float, exponent: float, height_m: float, vertical_mps2: Array) -> float:
    """Compute `range-power` for a person of that height from the smoothed vertical acceleration (n,) of one step."""
    return range_power_length_m(k, exponent, vertical_mps2) * height_m / _HEIGHT_M


def running_length_m(parameters: RunningParams, height_m: float, pace: Pace) -> float:
    """Compute the length of a running step of a person of that height."""
    p = parameters
    intensity_mps2 = min(pace.range_mps2, _MOST_RANGE_MPS2)
    by_cadence = (pace.cadence_hz / p.reference_cadence_hz) ** p.cadence_exponent
    by_intensity = (intensity_mps2 / p.reference_range_mps2) ** p.range_exponent
    return p.length_m * height_m / _HEIGHT_M * float(by_cadence * by_intensity)
