"""The samples that a step detector may still need: a filtered signal with its times, indices and modes."""

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.records import CarryingMode, LevelBlock, StepEvent


class UndecidedSamples:
    """A growing and shrinking window of one segment. delay_s: how long before its sign in
    the filtered signal a step happened."""

    def __init__(self, rate_hz: float, delay_s: float) -> None:
        self._delay_s = delay_s
        self._delay = round(delay_s * rate_hz)
        self.segment: int | None = None
        self._first_index = 0
        self.signal: Array = np.empty(0)
        self._time_s: Array = np.empty(0)
        self._mode: NDArray[np.int8] = np.empty(0, dtype=np.int8)
        self._mode_probability: Array = np.empty(0)

    def begin(self, block: LevelBlock) -> None:
        """Start a segment with an empty window."""
        self.segment, self._first_index = block.segment, block.first_index
        self.drop(len(self.signal), moved=False)

    def append(self, block: LevelBlock, signal: Array) -> None:
        """Add a block and the filtered signal of the same samples."""
        self.signal = np.concatenate([self.signal, signal])
        self._time_s = np.concatenate([self._time_s, block.time_s])
        self._mode = np.concatenate([self._mode, block.mode])
        self._mode_probability = np.concatenate([self._mode_probability, block.mode_probability])

    def drop(self, count: int, moved: bool = True) -> None:
        """Forget the oldest samples."""
        self._first_index += count if moved else 0
        self.signal, self._time_s = self.signal[count:], self._time_s[count:]
        self._mode, self._mode_probability = self._mode[count:], self._mode_probability[count:]

    def time_s(self, i: int) -> float:
        """When the feature at position i happened: the sample's time less the delay."""
        return float(self._time_s[i]) - self._delay_s

    def event(self, i: int) -> StepEvent:
        """The step at position i of the window."""
        return StepEvent(
            index=self._first_index + i - self._delay,
            time_s=self.time_s(i),
            segment=self.segment or 0,
            mode=CarryingMode(int(self._mode[i])),
            mode_probability=float(self._mode_probability[i]),
        )
