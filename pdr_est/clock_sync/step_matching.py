"""Which step of one device is which of another's: the shift of two clocks to a fraction of a step.

Heel strikes are alike, but steps are not equally long in time, and a clock is even: over a walk only the right shift
keeps all steps in phase. It is a small difference, and there is a larger one in its way: each leg's device feels its
own strikes more and otherwise, so that shifts by an odd number of steps may agree better than the right one. The
mean over neighbouring shifts with weights 1, 2, 1, one step apart, is blind to that alternation, and to the swing of
the hip in the rate of turn.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pdr_est.clock_sync.common_signals import RATE_HZ, CommonSignals
from pdr_est.frames import Array

# All ours, chosen on WeAllWalk.
_SEARCH_S = 1.5  # about the shift that is known
_STEP_S = (0.35, 0.9)
_APART_S = 0.25  # shifts this far apart belong to different steps
_WEIGHT_OF_BEAT = 3.0  # more of the walk is steps than turns
_EFFORT_SIGMA = 0.2  # of the logarithm, between two legs


@dataclass(frozen=True)
class SameStep:
    """shift_s: the best; agreement: correlation of the beat there; lead: of its score over that of any other step."""

    shift_s: float
    agreement: float
    lead: float


def same_step(one: CommonSignals, two: CommonSignals, rows: NDArray[np.int64], shift_s: float) -> SameStep:
    """The shift within 1.5 s of a known one. rows: consecutive samples of `one` to compare.

    The score is that of Gaussian signals with a correlation r, -log(1 - r^2), summed over beat and turns, and for
    effort that of a known error: starts and stops count, what is left of the leg's own effort does not.
    """
    step = _step_samples(one.beat[rows])
    reach = round(_SEARCH_S * RATE_HZ) + step
    beat = _of_neighbours(_correlations(one, two, one.beat, two.beat, rows, shift_s, reach), step)
    score = -_WEIGHT_OF_BEAT * np.log1p(-(np.minimum(np.maximum(beat, 0.0), 0.999) ** 2))
    if one.turn is not None and two.turn is not None:
        turn = _of_neighbours(_correlations(one, two, one.turn, two.turn, rows, shift_s, reach), step)
        score -= np.log1p(-(np.minimum(np.maximum(turn, 0.0), 0.999) ** 2))
    score = score - 0.5 * _effort_apart(one, two, rows, shift_s, reach - step) / _EFFORT_SIGMA**2
    best = int(np.argmax(score))
    other = np.abs(np.arange(len(score)) - best) > _APART_S * RATE_HZ
    lag_s = (best - round(_SEARCH_S * RATE_HZ)) / RATE_HZ
    return SameStep(shift_s + lag_s, float(beat[best]), float(score[best] - score[other].max()))


def _step_samples(beat: NDArray[np.complex128]) -> int:
    """The usual time of a step: the shift at which the beat is most like itself."""
    lags = np.arange(round(_STEP_S[0] * RATE_HZ), round(_STEP_S[1] * RATE_HZ) + 1)
    return int(lags[np.argmax([np.vdot(beat[:-lag], beat[lag:]).real for lag in lags])])


def _correlations(
    one: CommonSignals,
    two: CommonSignals,
    a: NDArray[np.inexact],
    b: NDArray[np.inexact],
    rows: NDArray[np.int64],
    shift_s: float,
    reach: int,
) -> Array:
    """At whole samples from -reach to reach about a shift, (2 reach + 1,)."""
    time_s = one.start_s + np.arange(rows[0] - reach, rows[-1] + reach + 1) / RATE_HZ + shift_s
    there = np.interp(time_s, two.time_s, b, left=0.0, right=0.0)
    values = a[rows] - a[rows].mean()
    windows = np.lib.stride_tricks.sliding_window_view(there, len(rows))
    centred_size = np.sqrt(len(rows) * np.maximum(np.var(windows, axis=1), 1e-24))
    return np.asarray((windows @ np.conj(values)).real / (centred_size * max(float(np.linalg.norm(values)), 1e-12)))


def _effort_apart(
    one: CommonSignals, two: CommonSignals, rows: NDArray[np.int64], shift_s: float, reach: int
) -> Array:
    """Variance of the difference of effort at whole samples from -reach to reach about a shift, (2 reach + 1,)."""
    time_s = one.start_s + np.arange(rows[0] - reach, rows[-1] + reach + 1) / RATE_HZ + shift_s
    windows = np.lib.stride_tricks.sliding_window_view(np.interp(time_s, two.time_s, two.effort), len(rows))
    return np.array([np.var(window - one.effort[rows]) for window in windows])


def _of_neighbours(correlations: Array, step: int) -> Array:
    """Means with weights 1, 2, 1 of shifts one step apart; shorter by a step at both ends."""
    blind: Array = 0.25 * (correlations[: -2 * step] + 2.0 * correlations[step:-step] + correlations[2 * step :])
    return blind
