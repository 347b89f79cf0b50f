"""Schedule of tethers: multiples of an interval on the common clock, while both devices of a pair record."""

from itertools import combinations
from math import ceil, floor, inf

from pdr_est.estimators.common.nodes import SAME_S

Pair = tuple[int, int]
"""Numbers of two devices, the smaller one first."""


class TetherSchedule:
    """Times at which the devices of each pair are tethered, while the recordings of the devices grow.

    Parameters
    ----------
    interval_s
        Time between two tethers of a pair; None for devices without tethers.

    Attributes
    ----------
    spans_s
        Begin and end of the recording of each device so far; None before it begins.
    """

    def __init__(self, interval_s: float | None) -> None:
        self._interval_s = interval_s
        self.spans_s: list[tuple[float, float] | None] = []

    def extend(self, device: int, begin_s: float, end_s: float) -> float:
        """Let the recording of a device reach up to a later time.

        Parameters
        ----------
        device
            Number of the device.
        begin_s
            Time at which its recording began.
        end_s
            Time up to which it now reaches.

        Returns
        -------
        float
            First tether time that this adds to the schedule; infinity if there is none.
        """
        before = self.spans_s[device]
        self.spans_s[device] = (begin_s, end_s if before is None else max(before[1], end_s))
        before_s = -inf if before is None else before[1]
        own_pairs = [pair for pair in self._pairs() if device in pair]
        return min((self._first_after(pair, device, before_s) for pair in own_pairs), default=inf)

    def times_of(self, pair: Pair) -> list[float]:
        """Return all tether times of a pair."""
        return [] if self._interval_s is None else [k * self._interval_s for k in self._numbers(pair)]

    def times_between(self, begin_s: float, end_s: float) -> list[float]:
        """Return the times between two times at which any pair is tethered."""
        pairs, interval_s = self._pairs(), self._interval_s
        if not pairs or interval_s is None:
            return []
        numbers = range(ceil(begin_s / interval_s), floor(end_s / interval_s) + 1)
        return [k * interval_s for k in numbers if any(k in self._numbers(pair) for pair in pairs)]

    def due(self, number: int, last_s: float, before_s: float) -> tuple[list[Pair], int]:
        """Return the pairs whose tethers are due, one entry a tether, in order of time.

        Parameters
        ----------
        number
            Number of the first tether time to look at; tether k has the time k times the interval.
        last_s
            Latest time to look at.
        before_s
            Time before which the tethers must lie.

        Returns
        -------
        list of Pair
            Pairs to tether.
        int
            Number of the tether time that follows.
        """
        interval_s, begins_s = self._interval_s, [span[0] for span in self.spans_s if span is not None]
        if interval_s is None or not begins_s:
            return [], number
        found: list[Pair] = []
        number = max(number, ceil(min(begins_s) / interval_s))
        last = floor(last_s / interval_s)
        while number <= last and number * interval_s + SAME_S < before_s:
            found += [pair for pair in self._pairs() if number in self._numbers(pair)]
            number += 1
        return found, number

    def _pairs(self) -> list[Pair]:
        return [] if self._interval_s is None else list(combinations(range(len(self.spans_s)), 2))

    def _numbers(self, pair: Pair) -> range:
        """Return the numbers of the tether times of a pair."""
        a, b = self.spans_s[pair[0]], self.spans_s[pair[1]]
        if a is None or b is None or self._interval_s is None:
            return range(0)
        return range(ceil(max(a[0], b[0]) / self._interval_s), floor(min(a[1], b[1]) / self._interval_s) + 1)

    def _first_after(self, pair: Pair, device: int, before_s: float) -> float:
        """Return the first tether time of a pair that is new since a device reached up to an earlier time."""
        other = self.spans_s[pair[1] if pair[0] == device else pair[0]]
        if other is None or self._interval_s is None:
            return inf
        numbers, reached_s = self._numbers(pair), min(before_s, other[1])
        number = numbers.start
        if reached_s > -inf:
            number = max(number, floor(reached_s / self._interval_s) + 1)
        return number * self._interval_s if number in numbers else inf
