"""Detect events in a sampled signal: local extrema, crossings with hysteresis, and a pause after each event."""

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array

Flags = NDArray[np.bool_]
_ROUNDING_S = 1e-6  # rounding of the difference of two times, also where a clock counts from 1970


class SchmittTrigger:
    """Trigger with hysteresis: it fires once after each time that it was armed.

    Whether it is armed is carried from block to block.
    """

    def __init__(self) -> None:
        self._armed = False

    def reset(self) -> None:
        """Forget the past, for a new segment."""
        self._armed = False

    def push(self, arms: Flags, fires: Flags) -> NDArray[np.intp]:
        """Return the positions of the first firing sample after each arming one.

        Parameters
        ----------
        arms, fires : ndarray of bool, shape (n,)
            Samples that arm the trigger, and samples that fire it; a sample that does both arms it.
        """
        marks = np.flatnonzero(arms | fires)
        if not len(marks):
            return marks
        arming = arms[marks]
        armed = np.concatenate([[self._armed], arming[:-1]])
        self._armed = bool(arming[-1])
        return marks[armed & ~arming]


def has_elapsed(elapsed_s: float, interval_s: float) -> bool:
    """Return True if the difference of two sample times is at least an interval, however the times were rounded.

    Parameters
    ----------
    elapsed_s, interval_s : float
        Difference of two sample times, and the interval. Exactly as many samples as the interval holds are enough.
    """
    return elapsed_s >= interval_s - _ROUNDING_S


class RefractoryPeriod:
    """Refuse events that come too soon after the last accepted one.

    Parameters
    ----------
    interval_s : float
        Least time between two accepted events.
    """

    def __init__(self, interval_s: float) -> None:
        self._interval_s = interval_s
        self._last_s = -np.inf

    def accepts(self, time_s: float) -> bool:
        """Accept or refuse an event at this time; times must not decrease from call to call."""
        if not has_elapsed(time_s - self._last_s, self._interval_s):
            return False
        self._last_s = time_s
        return True


def local_maxima(samples: Array) -> NDArray[np.bool_]:
    """Mark the samples that are higher than the one before and not lower than the one after.

    Of a plateau only the first sample is marked; the first and the last sample of the signal never are.

    Parameters
    ----------
    samples : ndarray, shape (n,)

    Returns
    -------
    ndarray of bool, shape (n,)
    """
    peaks = np.zeros(len(samples), dtype=np.bool_)
    peaks[1:-1] = (samples[1:-1] > samples[:-2]) & (samples[1:-1] >= samples[2:])
    return peaks


def local_minima(samples: Array) -> NDArray[np.bool_]:
    """Mark the samples that are lower than the one before and not higher than the one after.

    See `local_maxima` for plateaus and ends.
    """
    return local_maxima(-samples)
