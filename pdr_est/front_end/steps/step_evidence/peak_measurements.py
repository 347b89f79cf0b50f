"""Measure what is known of the peaks of a signal before anything is decided about them."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.front_end.steps.step_evidence.movement import (
    Movement,
    movement_between,
    movements_between,
    strength_between,
    strengths_between,
)
from pdr_est.front_end.steps.step_evidence.stride_likeness import horizontal_patterns, pattern_samples

_IMPACT_S = 0.4  # length of the movement before a peak that tells whether the phone still moves
_FEW = 4  # peaks that are quicker measured one by one


class MeasuredPeak(NamedTuple):
    """Peak of the buffered signal, and what is known of it.

    Attributes
    ----------
    place : int
        Position in the buffered signal.
    strength_mps2 : float
        Standard deviation of the acceleration just before.
    movement : Movement
        Movement in the time before.
    pattern : ndarray or None
        Pattern of the horizontal acceleration before (see `horizontal_patterns`), where the movement is not strong.
    """

    place: int
    strength_mps2: float
    movement: Movement
    pattern: Array | None


class PeakMeasurements:
    """Measurements of peaks over fixed times before them.

    Parameters
    ----------
    rate_hz : float
        Sampling rate.
    window_s : float
        Length of the movement before a peak, s.

    Attributes
    ----------
    samples : int
        Number of samples before a peak that they need.
    """

    def __init__(self, rate_hz: float, window_s: float) -> None:
        self._rate_hz = rate_hz
        self._impact = max(round(_IMPACT_S * rate_hz), 1)
        self._half_window = max(round(0.5 * window_s * rate_hz), 1)
        self.samples = max(2 * self._half_window, self._impact, pattern_samples(rate_hz))

    def measure(self, sums: Array, places: NDArray[np.intp]) -> list[MeasuredPeak]:
        """Measure peaks.

        Parameters
        ----------
        sums : ndarray, shape (m, MOVEMENT_COLUMNS)
            Rows that `MovementSums` returned.
        places : ndarray, shape (n,)
            Positions of the peaks in them.
        """
        peaks: list[int] = places.tolist()
        if len(peaks) < _FEW:
            strengths = [self._strength_before(sums, i) for i in peaks]
            movements = [self._movement_before(sums, i) for i in peaks]
        else:
            impact, half = np.minimum(self._impact, places), np.minimum(self._half_window, places // 2)
            ends = sums[places]
            strengths = strengths_between(sums[places - impact], ends, np.maximum(impact, 1))
            movements = movements_between(sums[places - 2 * half], sums[places - half], ends, np.maximum(2 * half, 1))
        patterns = horizontal_patterns(sums, places, movements, self._rate_hz)
        return [MeasuredPeak(*known) for known in zip(peaks, strengths, movements, patterns, strict=True)]

    def _strength_before(self, sums: Array, i: int) -> float:
        samples = min(self._impact, i)
        return strength_between(sums[i - samples], sums[i], max(samples, 1))

    def _movement_before(self, sums: Array, i: int) -> Movement:
        half = min(self._half_window, i // 2)
        return movement_between(sums[i - 2 * half], sums[i - half], sums[i], max(2 * half, 1))
