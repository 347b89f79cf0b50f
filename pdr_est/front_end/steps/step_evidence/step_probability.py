"""Weigh the rise of a peak against its time: how probable is it that the peak is a step?

A weak peak when the next step is due is a step on soft ground, on stairs or in a turn; the same peak halfway between
two steps is a ripple. No threshold of height separates them, but the odds do. They are those of a logistic
regression on the logarithms of three numbers, with other weights for early and for late peaks.
"""

import math

# Fitted to the 17,000 peaks of the walks with annotated steps (oxford-steps, weallwalk) and of further walks of the
# tuned sets (known-distance, stride-length, phone-gps, oxiod, motionsense, ipin2023), whose steps were those of the
# detector before this one. No walk of awinda or of another set of `walks` took part.
_CONSTANT = 2.68
_RISE, _RISE_RATIO = 2.3, 1.78
_EARLY, _LATE = 5.17, -1.71
# A peak beyond these limits of the ratios and of the rise tells no more than one at the limit.
_LEAST_RATIO, _HIGHEST_RATIO = math.exp(-3.0), math.exp(0.5)
_LEAST_RISE_MPS2, _HIGHEST_RISE_MPS2 = math.exp(-3.0), math.exp(1.5)
_LEAST_INTERVAL_RATIO, _LONGEST_INTERVAL_RATIO = 0.2, 4.0


def peak_log_odds(rise_mps2: float, usual_rise_mps2: float, interval_ratio: float) -> float:
    """Compute the logarithm of the odds that a peak is a step of somebody who walks.

    Parameters
    ----------
    rise_mps2 : float
        Rise of the signal from its lowest value since the last step to the peak, m/s^2.
    usual_rise_mps2 : float
        Mean rise of the recent steps, m/s^2.
    interval_ratio : float
        Time since the last step as a multiple of the recent intervals between steps; 1 where there are none.

    Returns
    -------
    float
        Above 0 for a peak that is rather a step than not.
    """
    ratio = min(max(rise_mps2 / usual_rise_mps2, _LEAST_RATIO), _HIGHEST_RATIO)
    rise = min(max(rise_mps2, _LEAST_RISE_MPS2), _HIGHEST_RISE_MPS2)
    timing = math.log(min(max(interval_ratio, _LEAST_INTERVAL_RATIO), _LONGEST_INTERVAL_RATIO))
    return (
        _CONSTANT
        + _RISE * math.log(rise)
        + _RISE_RATIO * math.log(ratio)
        + _EARLY * min(timing, 0.0)
        + _LATE * max(timing, 0.0)
    )


def probability(log_odds: float) -> float:
    """Return the probability that belongs to the logarithm of odds."""
    return 1.0 / (1.0 + math.exp(-log_odds))
