"""Crossings with hysteresis: a trigger that has to be armed before it fires, and a pause after what was accepted."""

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array

Flags = NDArray[np.bool_]
_ROUNDING_S = 1e-6  # of the difference of two times, also where a clock counts from 1970


class Trigger:
    """Finds where a signal fires after it has armed. Being armed is carried from block to block."""

    def __init__(self) -> None:
        self._armed = False

    def reset(self) -> None:
        """Forget the past, for a new segment."""
        self._armed = False

    def push(self, arms: Flags, fires: Flags) -> NDArray[np.intp]:
        """Positions of the first firing sample after each arming one.

        arms, fires: (n,) what each sample does; a sample that would do both arms.
        """
        marks = np.flatnonzero(arms | fires)
        if not len(marks):
            return marks
        arming = arms[marks]
        armed = np.concatenate([[self._armed], arming[:-1]])
        self._armed = bool(arming[-1])
        return marks[armed & ~arming]


def far_enough(elapsed_s: float, interval_s: float) -> bool:
    """Whether a difference of sample times is at least interval_s; exactly as many samples are, however rounded."""
    return elapsed_s >= interval_s - _ROUNDING_S


class Refractory:
    """Refuses what comes sooner than interval_s after what it accepted last."""

    def __init__(self, interval_s: float) -> None:
        self._interval_s = interval_s
        self._last_s = -np.inf

    def accepts(self, time_s: float) -> bool:
        """Whether something at this time is accepted; times come in order."""
        if not far_enough(time_s - self._last_s, self._interval_s):
            return False
        self._last_s = time_s
        return True


def local_maxima(samples: Array) -> NDArray[np.bool_]:
    """Whether each sample is higher than the one before and not lower than the one after; the ends are not."""
    peaks = np.zeros(len(samples), dtype=np.bool_)
    peaks[1:-1] = (samples[1:-1] > samples[:-2]) & (samples[1:-1] >= samples[2:])
    return peaks


def local_minima(samples: Array) -> NDArray[np.bool_]:
    """Whether each sample is lower than the one before and not higher than the one after; the ends are not."""
    return local_maxima(-samples)
