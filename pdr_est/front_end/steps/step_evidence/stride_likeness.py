"""Tell how alike the strides are sideways and lengthways.

Somebody who walks repeats with every stride how the trunk is pushed forward and held back, and how it sways: the
horizontal acceleration before a step is like that before the steps of the same foot, one to four strides earlier. A
vehicle shakes up and down at the frequencies of walking, and peaks of that are as regular as steps. But what it does
sideways and lengthways comes from other resonances, and is not bound to those peaks.
"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.front_end.steps.step_evidence.movement import ACCELERATION_COLUMNS, UP_COLUMNS, Movement
from pdr_est.front_end.steps.step_evidence.walking_belief import STRONG_MPS2, USUAL_LIKENESS

_MEAN_S, _MEANS = 0.1, 10  # duration of the means of which a pattern consists, and their number: about a stride
_NOISE = _MEANS * 0.1**2  # sum of the squares, (m/s^2)^2, of a pattern that is too weak to compare; ours
_STRIDES = 4  # how many strides the comparison goes back; all ours


def pattern_samples(rate_hz: float) -> int:
    """Return the number of samples that a pattern covers."""
    return _MEANS * _samples_of_mean(rate_hz)


def horizontal_patterns(
    sums: Array, places: NDArray[np.intp], movements: Sequence[Movement], rate_hz: float
) -> list[Array | None]:
    """Compute the patterns of the horizontal acceleration before peaks; None where only a walker moves so strongly.

    A pattern has the mean accelerations over tenths of a second, three components each in device axes, less their own
    mean and over their root sum of squares, so that the product of two patterns is their correlation. A last
    component draws the product of weak patterns to the likeness that tells nothing.

    Parameters
    ----------
    sums : ndarray, shape (m, MOVEMENT_COLUMNS)
        Rows that `MovementSums` returned.
    places : ndarray, shape (n,)
        Positions of the peaks in them.
    movements : sequence of Movement
        Movement before each peak.
    rate_hz : float
        Sampling rate.
    """
    found: list[Array | None] = [None] * len(movements)
    weak = [k for k, movement in enumerate(movements) if movement.acceleration_mps2 < STRONG_MPS2]
    if weak:
        for k, pattern in zip(weak, _patterns(sums, places[weak], _samples_of_mean(rate_hz)), strict=True):
            found[k] = pattern
    return found


def _patterns(sums: Array, places: NDArray[np.intp], samples: int) -> Array:
    edges = np.maximum(places[:, None] - samples * np.arange(_MEANS, -1, -1), 0)
    at_edges = sums[edges]
    share = 1.0 / samples
    acceleration, up = at_edges[..., ACCELERATION_COLUMNS], at_edges[..., UP_COLUMNS]
    means = (acceleration[:, 1:] - acceleration[:, :-1]) * share
    means -= (acceleration[:, -1:] - acceleration[:, :1]) * (share / _MEANS)
    upwards = (up[:, 1:] - up[:, :-1]) * share
    # Written out, so that the order of the additions does not depend on the number of peaks.
    vertical = means[..., 0] * upwards[..., 0] + means[..., 1] * upwards[..., 1] + means[..., 2] * upwards[..., 2]
    means -= vertical[..., None] * upwards
    patterns = np.empty((len(places), 3 * _MEANS + 1))
    patterns[:, :-1] = means.reshape(len(places), -1)
    squares = (patterns[:, :-1] * patterns[:, :-1]).sum(axis=1) + _NOISE
    patterns[:, -1] = math.sqrt(USUAL_LIKENESS * _NOISE)
    patterns /= np.sqrt(squares)[:, None]
    return patterns


def _samples_of_mean(rate_hz: float) -> int:
    return max(round(_MEAN_S * rate_hz), 1)


class StrideLikeness:
    """Patterns of the recent peaks, each compared with those of the same foot before it."""

    def __init__(self) -> None:
        self._recent: list[Array | None] = []

    def clear(self) -> None:
        """Forget all patterns: the walk begins anew."""
        self._recent.clear()

    def add(self, pattern: Array | None) -> float | None:
        """Add the pattern of a peak, None where it is not known, and return the mean likeness.

        Returns
        -------
        float or None
            Mean of the correlations with the patterns one to four strides earlier, -1 to 1; None if none is known.
        """
        recent = self._recent
        recent.append(pattern)
        del recent[: -2 * _STRIDES - 1]
        if pattern is None:
            return None
        # Every other peak is that of the same foot.
        earlier = [other for other in recent[-3::-2] if other is not None]
        if not earlier:
            return None
        total = earlier[0]
        for other in earlier[1:]:
            total = total + other
        return float((pattern * total).sum()) / len(earlier)
