"""Find which step of one device is which step of another: the clock shift to a fraction of a step.

All heel strikes look alike, but steps are not equally long in time while a clock runs evenly: over a walk only the
right shift keeps all steps in phase. That difference is small, and a larger one hides it: the device of each leg
feels its own strikes more strongly, so that shifts by an odd number of steps may agree better than the right one. The
mean over neighbouring shifts, one step apart, with weights 1, 2, 1 cancels that alternation, and the swing of the hip
in the turn rate as well.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pdr_est.clock_sync.common_signals import RATE_HZ, CommonSignals
from pdr_est.frames import Array

# All ours, chosen on WeAllWalk.
_SEARCH_S = 1.5  # about the shift that is known
_STEP_S = (0.35, 0.9)  # durations of a step
_SAME_STEP_S = 0.25  # shifts further apart belong to different steps
_STEP_WEIGHT = 3.0  # relative to turns, of which there are fewer
_LOG_INTENSITY_SIGMA = 0.2  # between two legs


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
    step = _step_samples(one.step_phasor[rows])
    reach = round(_SEARCH_S * RATE_HZ) + step
    step_correlation = _without_alternation(
        _correlations(one, two, one.step_phasor, two.step_phasor, rows, shift_s, reach), step
    )
    score = -_STEP_WEIGHT * np.log1p(-(np.minimum(np.maximum(step_correlation, 0.0), 0.999) ** 2))
    if one.turn_rate_radps is not None and two.turn_rate_radps is not None:
        turn_correlation = _without_alternation(
            _correlations(one, two, one.turn_rate_radps, two.turn_rate_radps, rows, shift_s, reach), step
        )
        score -= np.log1p(-(np.minimum(np.maximum(turn_correlation, 0.0), 0.999) ** 2))
    intensity_variance = _intensity_difference_variance(one, two, rows, shift_s, reach - step)
    score = score - 0.5 * intensity_variance / _LOG_INTENSITY_SIGMA**2
    best = int(np.argmax(score))
    other = np.abs(np.arange(len(score)) - best) > _SAME_STEP_S * RATE_HZ
    lag_s = (best - round(_SEARCH_S * RATE_HZ)) / RATE_HZ
    return StepMatch(shift_s + lag_s, float(step_correlation[best]), float(score[best] - score[other].max()))


def _step_samples(step_phasor: NDArray[np.complex128]) -> int:
    """Find the usual step duration in samples: the lag of the highest autocorrelation."""
    lags = np.arange(round(_STEP_S[0] * RATE_HZ), round(_STEP_S[1] * RATE_HZ) + 1)
    return int(lags[np.argmax([np.vdot(step_phasor[:-lag], step_phasor[lag:]).real for lag in lags])])


def _correlations(
    one: CommonSignals,
    two: CommonSignals,
    a: NDArray[np.inexact],
    b: NDArray[np.inexact],
    rows: NDArray[np.int64],
    shift_s: float,
    reach: int,
) -> Array:
    """Correlate a of one device with b of the other at lags of -reach to reach samples, (2 reach + 1,)."""
    time_s = one.start_s + np.arange(rows[0] - reach, rows[-1] + reach + 1) / RATE_HZ + shift_s
    there = np.interp(time_s, two.time_s, b, left=0.0, right=0.0)
    values = a[rows] - a[rows].mean()
    windows = np.lib.stride_tricks.sliding_window_view(there, len(rows))
    centred_size = np.sqrt(len(rows) * np.maximum(_window_variances(np.asarray(there), len(rows)), 1e-24))
    return np.asarray((windows @ np.conj(values)).real / (centred_size * max(float(np.linalg.norm(values)), 1e-12)))


def _intensity_difference_variance(
    one: CommonSignals, two: CommonSignals, rows: NDArray[np.int64], shift_s: float, reach: int
) -> Array:
    """Compute the variance of the log intensity difference at lags of -reach to reach samples, (2 reach + 1,)."""
    time_s = one.start_s + np.arange(rows[0] - reach, rows[-1] + reach + 1) / RATE_HZ + shift_s
    there = np.interp(time_s, two.time_s, two.log_intensity)
    here = one.log_intensity[rows] - one.log_intensity[rows].mean()
    covariance = np.lib.stride_tricks.sliding_window_view(there, len(rows)) @ here / len(rows)
    return np.asarray(_window_variances(there, len(rows)) + float(np.var(here)) - 2.0 * covariance)


def _window_variances(values: NDArray[Any], size: int) -> Array:
    """Compute the variance of every window of so many real or complex values, by running sums."""
    centred = values - values.mean()

    def window_means(of: NDArray[Any]) -> NDArray[Any]:
        sums = np.concatenate([np.zeros(1, dtype=of.dtype), np.cumsum(of)])
        return np.asarray((sums[size:] - sums[:-size]) / size)

    squares = window_means(np.abs(centred) ** 2)
    return np.asarray(np.maximum(squares - np.abs(window_means(centred)) ** 2, 0.0))


def _without_alternation(correlations: Array, step: int) -> Array:
    """Average lags one step apart with weights 1, 2, 1; the result is shorter by one step at both ends."""
    mean: Array = 0.25 * (correlations[: -2 * step] + 2.0 * correlations[step:-step] + correlations[2 * step :])
    return mean
