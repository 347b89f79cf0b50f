"""Keep the samples that a step detector may still need: a filtered signal with its times, indices and modes."""

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.records import made
from pdr_est.types.sensors import LevelBlock
from pdr_est.types.steps import CarryingMode, StepEvent

_MODES = tuple(CarryingMode)


class SampleBuffer:
    """Window of the latest samples of one segment, which grows by blocks and is cut at the front.

    Parameters
    ----------
    rate_hz : float
        Sampling rate.
    delay_s : float
        Delay of the filtered signal behind the movement; taken off the time and the index of a step.
    columns : int, optional
        Number of columns of the signal, which is (n, columns) with it and (n,) without.

    Attributes
    ----------
    segment : int or None
        Segment of the samples; None before the first one.
    signal : ndarray, shape (n,) or (n, columns)
        Filtered signal.
    mode : ndarray of int8, shape (n,)
        Carrying mode.
    """

    def __init__(self, rate_hz: float, delay_s: float, columns: int | None = None) -> None:
        self._delay_s = delay_s
        self._delay = round(delay_s * rate_hz)
        self.segment: int | None = None
        self._first_index = 0
        self.signal: Array = np.empty(0 if columns is None else (0, columns))
        self.mode: NDArray[np.int8] = np.empty(0, dtype=np.int8)
        self._time_s: Array = np.empty(0)
        self._mode_probability: Array = np.empty(0)

    def begin(self, block: LevelBlock) -> None:
        """Start a segment with an empty window."""
        self.clear()
        self.segment, self._first_index = block.segment, block.first_index

    def append(self, block: LevelBlock, signal: Array) -> None:
        """Add a block and the filtered signal of the same samples."""
        if not len(self.mode):
            self.signal, self.mode = signal, block.mode
            self._time_s, self._mode_probability = block.time_s, block.mode_probability
            return
        self.signal = np.concatenate([self.signal, signal])
        self.mode = np.concatenate([self.mode, block.mode])
        self._time_s = np.concatenate([self._time_s, block.time_s])
        self._mode_probability = np.concatenate([self._mode_probability, block.mode_probability])

    def clear(self) -> None:
        """Forget all samples."""
        self.drop(len(self.signal))

    def drop(self, count: int) -> None:
        """Forget the oldest samples."""
        self._first_index += count
        self.signal, self.mode = self.signal[count:], self.mode[count:]
        self._time_s, self._mode_probability = self._time_s[count:], self._mode_probability[count:]

    def time_s(self, i: int) -> float:
        """Return the time of the movement at position i: the sample's time less the delay."""
        return self._time_s.item(i) - self._delay_s

    def times_s(self, places: NDArray[np.intp]) -> list[float]:
        """Return `time_s` of several positions (n,)."""
        times: list[float] = (self._time_s[places] - self._delay_s).tolist()
        return times

    def event(self, i: int, confidence: float = 1.0) -> StepEvent:
        """Make the step event at position i of the window."""
        return made(
            StepEvent,
            index=self._first_index + i - self._delay,
            time_s=self._time_s.item(i) - self._delay_s,
            segment=self.segment or 0,
            mode=_MODES[self.mode.item(i)],
            confidence=confidence,
            mode_probability=self._mode_probability.item(i),
            compensated=False,
        )
