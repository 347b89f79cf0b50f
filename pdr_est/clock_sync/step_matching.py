"""Find which step of one device is which step of another: the clock shift to a fraction of a step.

All heel strikes look alike, but steps are not equally long in time while a clock runs evenly: over a walk only the
right shift keeps all steps in phase. That difference is small, and a larger one hides it: the device of each leg
feels its own strikes more strongly, so that shifts by an odd number of steps may agree better than the right one. The
mean of each signal and itself one step earlier has no such alternation, nor the swing of the hip in the turn rate.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pdr_est.clock_sync.common_signals import RATE_HZ, CommonSignals
from pdr_est.clock_sync.step_duration import step_samples_in_window
from pdr_est.clock_sync.windows import correlation_log_likelihood_ratio, window_correlations, window_variances
from pdr_est.frames import Array

# All ours, chosen on WeAllWalk.
_SEARCH_S = 1.5  # about the shift that is known
_SAME_STEP_S = 0.25  # shifts further apart belong to different steps
_STEP_WEIGHT = 3.0  # relative to turns, of which there are fewer
_LOG_INTENSITY_SIGMA = 0.2  # between two legs
_MOST_ALIKE = 0.999  # largest correlation that is believed


@dataclass(frozen=True)
class StepMatch:
    """Clock shift at which the steps of two devices coincide.

    Attributes
    ----------
    shift_s
        Best difference of the clocks (other - reference), s.
    agreement
        Correlation of the step phasors at that shift, at most 1.
    lead
        Score at that shift less the best score of any other step.
    """

    shift_s: float
    agreement: float
    lead: float


def match_steps(one: CommonSignals, two: CommonSignals, rows: NDArray[np.int64], shift_s: float) -> StepMatch:
    """Find the best clock shift within 1.5 s of a known one.

    The score is the log-likelihood ratio of Gaussian signals with correlation r, -log(1 - r^2), summed over step
    phasors and turn rates, less the squared error of the log intensity in standard deviations: starts and stops
    count, while the remaining difference between two legs does not.

    Parameters
    ----------
    one, two
        Signals of the reference device and of the other one.
    rows
        (n,) consecutive sample indices of `one` to compare.
    shift_s
        Known difference of the clocks, s.
    """
    step = step_samples_in_window(one, two, rows, shift_s)
    reach = round(_SEARCH_S * RATE_HZ)
    step_correlation = _correlations(one, two, one.step_phasor, two.step_phasor, rows, shift_s, reach, step)
    score = _STEP_WEIGHT * correlation_log_likelihood_ratio(step_correlation, _MOST_ALIKE)
    if one.turn_rate_radps is not None and two.turn_rate_radps is not None:
        turns, other_turns = one.turn_rate_radps, two.turn_rate_radps
        turn_correlation = _correlations(one, two, turns, other_turns, rows, shift_s, reach, step)
        score += correlation_log_likelihood_ratio(turn_correlation, _MOST_ALIKE)
    intensity_variance = _intensity_difference_variance(one, two, rows, shift_s, reach)
    score = score - 0.5 * intensity_variance / _LOG_INTENSITY_SIGMA**2
    best = int(np.argmax(score))
    other = np.abs(np.arange(len(score)) - best) > _SAME_STEP_S * RATE_HZ
    lag_s = (best - reach) / RATE_HZ
    return StepMatch(shift_s + lag_s, float(step_correlation[best]), float(score[best] - score[other].max()))


def without_alternation(
    signals: CommonSignals, values: NDArray[np.inexact], start_s: float, count: int, step: int
) -> NDArray[Any]:
    """Average values of a device with those one step earlier, at so many samples from a time on.

    Parameters
    ----------
    signals
        Signals of the device.
    values
        (n,) real or complex values at the samples of `signals`; they are zero before and after them.
    start_s
        Time of the first sample, s on the clock of the device.
    count, step
        Number of samples, and duration of a step in samples.
    """
    time_s = start_s + np.arange(-step, count) / RATE_HZ
    there = np.asarray(np.interp(time_s, signals.time_s, values, left=0.0, right=0.0))
    return np.asarray(0.5 * (there[step:] + there[:-step]))


def _correlations(
    one: CommonSignals,
    two: CommonSignals,
    a: NDArray[np.inexact],
    b: NDArray[np.inexact],
    rows: NDArray[np.int64],
    shift_s: float,
    reach: int,
    step: int,
) -> Array:
    """Correlate a of one device with b of the other at lags of -reach to reach samples, (2 reach + 1,)."""
    start_s = one.start_s + rows[0] / RATE_HZ
    here = without_alternation(one, a, start_s, len(rows), step)
    there = without_alternation(two, b, start_s + shift_s - reach / RATE_HZ, len(rows) + 2 * reach, step)
    return window_correlations(here, there)


def _intensity_difference_variance(
    one: CommonSignals, two: CommonSignals, rows: NDArray[np.int64], shift_s: float, reach: int
) -> Array:
    """Compute the variance of the log intensity difference at lags of -reach to reach samples, (2 reach + 1,)."""
    time_s = one.start_s + np.arange(rows[0] - reach, rows[-1] + reach + 1) / RATE_HZ + shift_s
    there = np.interp(time_s, two.time_s, two.log_intensity)
    here = one.log_intensity[rows] - one.log_intensity[rows].mean()
    covariance = np.lib.stride_tricks.sliding_window_view(there, len(rows)) @ here / len(rows)
    return np.asarray(window_variances(there, len(rows)) + float(np.var(here)) - 2.0 * covariance)
