"""Tell from the movement of a phone and from its peaks how probable it is that its carrier walks.

Peaks at the rhythm of steps are also felt in a bus, in a train, and while a phone is handled. A walker differs from a
passenger by how strongly the phone is accelerated in all directions and, where a rough road and a gentle walker do it
equally, by strides that are alike (`stride_likeness`). From somebody who handles a phone he differs by the vertical
share of the acceleration, by the rhythm, and by how far the phone goes: a trunk rises and falls by a few centimetres,
and a limb swings in one plane, while a hand that turns a phone over moves it up and down and in all directions. Each
peak adds its evidence to the logarithm of the odds, which forgets slowly, because people start and
stop.
"""

import math
from typing import NamedTuple

from pdr_est.front_end.steps.step_evidence.movement import Movement
from pdr_est.front_end.steps.step_evidence.step_probability import probability

_WEAK_MPS2, _LEAST_MPS2 = 0.9, 0.2  # acceleration below which somebody rather rides; what is below tells no more
_USUAL_SHARE, _LEAST_SHARE = 0.4, 0.05  # of the vertical direction
_STEADY, _UNSTEADY = 0.05, 0.6  # limits of the change of the interval, a logarithm
_UNKNOWN_CHANGE = 0.3  # where there are no two intervals to compare
_USUAL_INTERVAL_S, _LONG_INTERVAL_S = 0.6, 1.5
_BOUNCE_INTERVAL_S = 0.3, 0.9  # limits of the period by which a rise is turned into a height
_MOST_BOUNCE_M = 0.2
_USUAL_REACH_M_RAD = 0.045 * 0.07  # bounce times sideways tilt that some walkers reach

# Fitted so that the belief that is filtered from peak to peak is right within the time that a step may wait, and then
# shifted and rounded in favour of walkers. Walkers: oxford-steps, weallwalk, awinda (all also at 10 to 20 Hz),
# known-distance, stride-length, oxiod, phone-gps, motionsense, ipin2023, ilc20, sisfall and other sets of `walks`. No
# walkers: who stands (motionsense) or sits (geotec), puts a phone away or takes it out (hyperimu; oxford-steps before
# the first and after the last step), shakes it to calibrate it (ipin2023 before the first surveyed point), and rides
# in made-up vehicles (vertical vibration of 1 to 3 Hz with 0.3 and 0.4 m/s^2, sideways half of it). With one of
# oxford-steps and hyperimu left out, a third and a half of its false steps go in any case; no set but ipin2023 knows
# shaken phones with a gyroscope, so that the weight of the reach rests on that one.
_CONSTANT, _WEAKNESS, _SHARE, _CHANGE, _SLOWNESS, _REACH = 2.7, 6.0, 1.2, -3.5, -0.9, -1.9
_MOST_EVIDENCE = 2.0  # of one peak: the windows of neighbouring peaks overlap
_START, _STOP = 0.001, 0.01  # probabilities that walking starts and stops from one peak to the next
_AT_FIRST = -1.0  # logarithm of the odds at the first peak after a standstill
_SURE_RIDE = -4.0  # logarithm of the odds of walking below which somebody surely rides


# What the likeness of strides tells is fitted to the same walkers, and to simulated passengers of buses, cars and
# trains (`pdr_est.simulate.riding`, on their usual roads and on twice as rough ones). The logistic regression has
# 13.6 for the likeness times the logarithm of how much weaker than STRONG_MPS2 the movement is, and 13.3 to 13.9 with
# any one set of real walkers left out. Half of that is taken, because the windows of neighbouring peaks overlap. The
# likeness that tells as much as an unknown one is fitted, too (0.44, and 0.44 to 0.51 with one set left out). A
# higher one counts for little more: what repeats itself exactly is rather a machine.
STRONG_MPS2 = 2.0
"""Acceleration, m/s^2, above which nobody rides (ours): the likeness of strides does not count."""
_DOUBT = 7.0
USUAL_LIKENESS = 0.45
"""Likeness of strides that tells nothing."""
_MOST_LIKENESS = 0.5


class PeakRhythm(NamedTuple):
    """Times between a peak and the ones before it, s, and its rise; infinite where there are none.

    Attributes
    ----------
    interval_s, previous_s, one_before_s : float
        Latest interval between peaks, and the two before it.
    rise_mps2 : float
        Rise of the signal since the last peak.
    """

    interval_s: float
    previous_s: float
    one_before_s: float
    rise_mps2: float

    def followed_by(self, interval_s: float, rise_mps2: float) -> "PeakRhythm":
        """Return the rhythm at the next peak."""
        return PeakRhythm(interval_s, self.interval_s, self.previous_s, rise_mps2)

    @property
    def change(self) -> float:
        """Absolute logarithm of the ratio of the interval to the nearer one of the two before it.

        Feet may differ, so that the same foot's interval counts as well.
        """
        interval_s, previous_s, one_before_s, _ = self
        if interval_s == math.inf or previous_s == math.inf:
            return _UNKNOWN_CHANGE
        change = abs(math.log(interval_s / previous_s))
        if change > _STEADY and one_before_s < math.inf:
            change = min(change, abs(math.log(interval_s / one_before_s)))
        return min(max(change, _STEADY), _UNSTEADY)

    @property
    def bounce_m(self) -> float:
        """Height by which a sine of this rise and of the shortest interval goes up and down, m."""
        shortest_s = min(self.interval_s, self.previous_s, self.one_before_s)
        period_s = min(max(shortest_s, _BOUNCE_INTERVAL_S[0]), _BOUNCE_INTERVAL_S[1])
        return min(self.rise_mps2 * (period_s / (2.0 * math.pi)) ** 2, _MOST_BOUNCE_M)


def walking_evidence(movement: Movement, rhythm: PeakRhythm, likeness: float | None = None) -> float:
    """Compute the logarithm of the odds of walking that a peak adds.

    Parameters
    ----------
    movement : Movement
        Movement before the peak.
    rhythm : PeakRhythm
        Times and rise of the peak.
    likeness : float, optional
        How alike the horizontal acceleration is from stride to stride (see `StrideLikeness`), -1 to 1; None where it
        is not known.
    """
    evidence = _CONSTANT + _CHANGE * rhythm.change
    strength, vertical_share, tilt_rad = movement
    if strength < _WEAK_MPS2:
        evidence += _WEAKNESS * math.log(max(strength, _LEAST_MPS2) / _WEAK_MPS2)
    if vertical_share < _USUAL_SHARE:
        evidence += _SHARE * math.log(max(vertical_share, _LEAST_SHARE) / _USUAL_SHARE)
    if rhythm.interval_s > _USUAL_INTERVAL_S:
        evidence += _SLOWNESS * math.log(min(rhythm.interval_s, _LONG_INTERVAL_S) / _USUAL_INTERVAL_S)
    if likeness is not None and strength < STRONG_MPS2:
        doubt = _DOUBT * math.log(STRONG_MPS2 / max(strength, _WEAK_MPS2))
        evidence += doubt * (min(likeness, _MOST_LIKENESS) - USUAL_LIKENESS)
    reach = rhythm.bounce_m * tilt_rad
    if reach > _USUAL_REACH_M_RAD:
        evidence += _REACH * math.log(reach / _USUAL_REACH_M_RAD)
    return min(max(evidence, -_MOST_EVIDENCE), _MOST_EVIDENCE)


class WalkingBelief:
    """Logarithm of the odds that somebody walks, carried from peak to peak.

    Attributes
    ----------
    log_odds : float
        Above 0 while it is more probable that somebody walks.
    rode : bool
        True after a standstill before which somebody surely rode.
    """

    def __init__(self) -> None:
        self.reset()

    def reset(self) -> None:
        """Forget the past, for a new segment."""
        self.log_odds, self.rode = _AT_FIRST, False

    def stand(self) -> None:
        """Take it that a standstill came before the next peak: half of what spoke against walking is forgotten."""
        self.rode = self.log_odds < _SURE_RIDE
        self.log_odds = _AT_FIRST + 0.5 * min(self.log_odds - _AT_FIRST, 0.0)

    def add(self, evidence: float) -> None:
        """Add the evidence of a peak."""
        walking = probability(self.log_odds)
        walking += (1.0 - walking) * _START - walking * _STOP
        self.log_odds = math.log(walking / (1.0 - walking)) + evidence
