"""The windows of a segment: hops of samples, and what two halves of several hops each tell about the mode."""

import numpy as np

from pdr_est.frames import Array
from pdr_est.front_end.mode.window_features import (
    COLUMNS,
    MODES,
    SAMPLE_COLUMNS,
    hop_means,
    likelihoods,
    samples_of,
    turned,
)
from pdr_est.types.sensors import LevelBlock


class Windows:
    """A row a hop: how far gravity turns at its beginning, `turned` (n,), and how likely each mode makes what the
    window about that time shows, `likelihood` (modes, n). About the first hops there is no window: their rows say
    nothing.

    hop: samples of one; half_hops: of half a window; walking_mps2: as of `likelihoods`. Hops lie on the sample index
    of the segment. `past` of the rows belong to hops that have been labelled; they are kept for their neighbours'
    sake.
    """

    def __init__(self, hop: int, half_hops: int, rate_hz: float, walking_mps2: float) -> None:
        self._hop, self._half = hop, half_hops
        self._rate_hz = rate_hz
        self._walking_mps2 = walking_mps2
        self.begin()

    def begin(self) -> None:
        """A new segment."""
        self._fresh: list[LevelBlock] = []  # blocks not looked at, and how many samples of the hop under way
        self._rest: Array = np.empty((0, SAMPLE_COLUMNS))  # they and these, left over before, make
        self._count = 0
        self._means: Array = np.empty((0, COLUMNS))
        self.past = 0
        self.turned: Array = np.zeros(self._half)
        self.likelihood: Array = np.ones((len(MODES), self._half))

    def push(self, block: LevelBlock) -> None:
        """Judge the windows that further complete hops make."""
        self._fresh.append(block)
        self._count += len(block)
        stop = self._count - self._count % self._hop
        if not stop:
            return
        samples = np.concatenate([self._rest, samples_of(self._fresh)])
        self._fresh, self._rest, self._count = [], samples[stop:], self._count - stop
        means = hop_means(samples[:stop], self._hop, self._rate_hz, self._means[-1:])
        self._means = np.concatenate([self._means, means])
        windows = len(self._means) - 2 * self._half + 1
        if windows < 1:
            return
        halves = _running_means(self._means, self._half)
        early, late = halves[:windows], halves[self._half :]
        self._append(turned(early, late), likelihoods(early, late, self._walking_mps2))
        self._means = self._means[windows:]

    def since_hop(self) -> int:
        """How many samples have come since the latest complete hop."""
        return self._count

    def ahead(self) -> int:
        """How many rows are known from the first hop on that is not labelled."""
        return len(self.turned) - self.past

    def end(self, rows: int) -> None:
        """The segment is over: rows that say nothing, until there are so many from the first unlabelled hop on."""
        missing = max(self.past + rows - len(self.turned), 0)
        self._append(np.zeros(missing), np.ones((len(MODES), missing)))

    def labelled(self, count: int, keep: int) -> None:
        """The next `count` hops have been labelled; forget the past but for `keep` rows."""
        stop = self.past + count
        self.past = min(stop, keep)
        self.turned = self.turned[stop - self.past :]
        self.likelihood = self.likelihood[:, stop - self.past :]

    def _append(self, turned_by: Array, likelihood: Array) -> None:
        self.turned = np.concatenate([self.turned, turned_by])
        self.likelihood = np.concatenate([self.likelihood, likelihood], axis=1)


def _running_means(values: Array, width: int) -> Array:
    """Means over each `width` consecutive rows."""
    count = len(values) - width + 1
    total = values[:count].copy()
    for k in range(1, width):
        total += values[k : k + count]
    total /= width
    return total
