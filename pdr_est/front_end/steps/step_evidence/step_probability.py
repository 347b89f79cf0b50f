"""Weigh the rise of a peak against its time, to tell how probable it is that the peak is a step.

A weak peak when the next step is due is a step on soft ground, on stairs or in a turn; the same peak halfway between
two steps is a ripple, and one in a phone that has come to rest is the last echo of a step. No threshold of height
separates them, but the odds do. They are those of a logistic regression on the logarithms of four numbers, with other
weights for early and for late peaks.
"""

from math import exp, log
from typing import NamedTuple

# Fitted to the 30,000 peaks of the walks with annotated steps (oxford-steps, weallwalk) and of further walks of the
# tuned sets (known-distance, stride-length, phone-gps, oxiod, motionsense, ipin2023), whose steps were those of the
# detector before this one. No walk of awinda or of another set of `walks` took part.
_CONSTANT = 3.04
_RISE, _RISE_RATIO, _STRENGTH_RATIO = 2.02, 1.94, 0.97
_EARLY, _LATE = 4.11, -1.56
# Peaks beyond these limits tell no more than those at the limits.
_RISE_LIMITS = exp(-3.0), exp(1.5)
_RISE_RATIO_LIMITS = exp(-3.0), exp(0.5)
_STRENGTH_RATIO_LIMITS = exp(-2.0), exp(0.3)
_INTERVAL_RATIO_LIMITS = 0.2, 4.0


class PeakShape(NamedTuple):
    """Shape of a peak, all in m/s^2."""

    height: float
    """Height of the signal at the peak."""
    rise: float
    """Rise of the signal from its lowest value since the last step to the peak."""
    strength: float
    """Standard deviation of the acceleration just before the peak is found, all directions together."""

    def blended(self, other: "PeakShape", weight: float) -> "PeakShape":
        """Return the mean of this shape, with a weight from 0 to 1, and of another one."""
        (a, b, c), (x, y, z), rest = self, other, 1.0 - weight
        return PeakShape(weight * a + rest * x, weight * b + rest * y, weight * c + rest * z)


def peak_log_odds(peak: PeakShape, usual: PeakShape, interval_ratio: float) -> float:
    """Compute the logarithm of the odds that a peak is a step of somebody who walks.

    Parameters
    ----------
    peak, usual : PeakShape
        The peak, and the mean of the recent steps.
    interval_ratio : float
        Time since the last step as a multiple of the recent intervals between steps; 1 where there are none.

    Returns
    -------
    float
        Above 0 for a peak that is rather a step than not.
    """
    timing = log(min(max(interval_ratio, _INTERVAL_RATIO_LIMITS[0]), _INTERVAL_RATIO_LIMITS[1]))
    _, rise, strength = peak
    _, usual_rise, usual_strength = usual
    return (
        _CONSTANT
        + _RISE * log(min(max(rise, _RISE_LIMITS[0]), _RISE_LIMITS[1]))
        + _RISE_RATIO * log(min(max(rise / usual_rise, _RISE_RATIO_LIMITS[0]), _RISE_RATIO_LIMITS[1]))
        + _STRENGTH_RATIO
        * log(min(max(strength / usual_strength, _STRENGTH_RATIO_LIMITS[0]), _STRENGTH_RATIO_LIMITS[1]))
        + (_EARLY if timing < 0.0 else _LATE) * timing
    )


def probability(log_odds: float) -> float:
    """Return the probability that belongs to the logarithm of odds."""
    return 1.0 / (1.0 + exp(-log_odds))
