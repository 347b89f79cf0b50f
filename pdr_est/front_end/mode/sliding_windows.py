"""Sliding windows over the hops of a segment, and the evidence of each about the carrying mode."""

import numpy as np

from pdr_est.frames import Array
from pdr_est.front_end.mode.window_features import (
    COLUMNS,
    MODES,
    SAMPLE_COLUMNS,
    gravity_turn,
    hop_means,
    mode_likelihoods,
    sample_columns,
)
from pdr_est.types.sensors import LevelBlock


class SlidingWindows:
    """Evidence about the carrying mode: one row for each hop, from the window around its beginning.

    A window has two halves of several hops. Hops are counted from the beginning of the segment. There is no window
    around the first hops: their rows are neutral. The first rows belong to hops that have been labelled already and
    are kept for their neighbours.

    Parameters
    ----------
    hop : int
        Number of samples of a hop.
    half_hops : int
        Number of hops of half a window.
    rate_hz : float
        Sampling rate.
    walking_mps2 : float
        Least standard deviation of the vertical acceleration of a walk (`mode_likelihoods`).

    Attributes
    ----------
    past : int
        Number of rows whose hops have been labelled.
    gravity_turn : ndarray, shape (n,)
        Turn of gravity at the beginning of each hop, 1 - cos of the angle.
    likelihood : ndarray, shape (modes, n)
        Likelihood of the window around each hop's beginning under each mode.
    """

    def __init__(self, hop: int, half_hops: int, rate_hz: float, walking_mps2: float) -> None:
        self._hop, self._half = hop, half_hops
        self._rate_hz = rate_hz
        self._walking_mps2 = walking_mps2
        self.begin_segment()

    def begin_segment(self) -> None:
        """Forget everything, for a new segment."""
        self._new_blocks: list[LevelBlock] = []  # blocks since the latest complete hop
        self._remainder: Array = np.empty((0, SAMPLE_COLUMNS))  # samples left over from earlier blocks
        self._count = 0
        self._means: Array = np.empty((0, COLUMNS))
        self.past = 0
        self.gravity_turn: Array = np.zeros(self._half)
        self.likelihood: Array = np.ones((len(MODES), self._half))

    def push(self, block: LevelBlock) -> None:
        """Take samples and append a row for each window that they complete."""
        self._new_blocks.append(block)
        self._count += len(block)
        stop = self._count - self._count % self._hop
        if not stop:
            return
        samples = np.concatenate([self._remainder, sample_columns(self._new_blocks)])
        self._new_blocks, self._remainder, self._count = [], samples[stop:], self._count - stop
        means = hop_means(samples[:stop], self._hop, self._rate_hz, self._means[-1:])
        self._means = np.concatenate([self._means, means])
        windows = len(self._means) - 2 * self._half + 1
        if windows < 1:
            return
        halves = _running_means(self._means, self._half)
        early, late = halves[:windows], halves[self._half :]
        self._append(gravity_turn(early, late), mode_likelihoods(early, late, self._walking_mps2))
        self._means = self._means[windows:]

    def samples_since_hop(self) -> int:
        """Return the number of samples since the latest complete hop."""
        return self._count

    def rows_ahead(self) -> int:
        """Return the number of rows from the first unlabelled hop on."""
        return len(self.gravity_turn) - self.past

    def end_segment(self, rows: int) -> None:
        """Append neutral rows until there are `rows` from the first unlabelled hop on."""
        missing = max(self.past + rows - len(self.gravity_turn), 0)
        self._append(np.zeros(missing), np.ones((len(MODES), missing)))

    def mark_labelled(self, count: int, keep: int) -> None:
        """Count the next `count` hops as labelled, and forget past rows but for the last `keep`."""
        stop = self.past + count
        self.past = min(stop, keep)
        self.gravity_turn = self.gravity_turn[stop - self.past :]
        self.likelihood = self.likelihood[:, stop - self.past :]

    def _append(self, turn: Array, likelihood: Array) -> None:
        self.gravity_turn = np.concatenate([self.gravity_turn, turn])
        self.likelihood = np.concatenate([self.likelihood, likelihood], axis=1)


def _running_means(values: Array, width: int) -> Array:
    """Compute the means over each `width` consecutive rows."""
    count = len(values) - width + 1
    total = values[:count].copy()
    for k in range(1, width):
        total += values[k : k + count]
    total /= width
    return total
