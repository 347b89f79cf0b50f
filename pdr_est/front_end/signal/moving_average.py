"""Mean over a sliding window, bit-identical however the signal is cut into blocks."""

import numpy as np

from pdr_est.frames import Array


class MovingAverage:
    """Mean of the latest `window_s` of a signal, with a state that is carried from block to block.

    It starts as if the first sample had lasted for ever.

    Parameters
    ----------
    window_s : float
        Length of the window, s; at least one sample is averaged.
    rate_hz : float
        Sampling rate.

    Attributes
    ----------
    delay_s : float
        Group delay, s, the same at every frequency.
    """

    def __init__(self, window_s: float, rate_hz: float) -> None:
        self._width = max(round(window_s * rate_hz), 1)
        self._sums: Array | None = None  # running sums up to each of the latest `width` samples
        self.delay_s = (self._width - 1) / (2.0 * rate_hz)

    def reset(self) -> None:
        """Forget the past, for a new segment."""
        self._sums = None

    def push(self, samples: Array) -> Array:
        """Average samples of shape (n,), or (n, k) column by column."""
        if not len(samples):
            return samples
        if self._sums is None:
            self._sums = np.cumsum(np.repeat(samples[:1], self._width, axis=0), axis=0)
        # The carry is the first term of the sum, so that the additions and their order do not depend on the cuts.
        sums = np.cumsum(np.concatenate([self._sums[-1:], samples]), axis=0)[1:]
        history = np.concatenate([self._sums, sums])
        self._sums = history[-self._width :].copy()
        mean: Array = (sums - history[: len(samples)]) / self._width
        return mean
