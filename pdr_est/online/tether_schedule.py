"""When tethers are asked for: at multiples of an interval on the common clock, while both devices record."""

from collections.abc import Sequence
from itertools import combinations
from math import ceil, floor, inf

from pdr_est.estimators.common.timeline import SAME_S
from pdr_est.online.step_log import DeviceLog

Pair = tuple[int, int]


class Tethering:
    """The moments of all pairs of devices. every_s: None for no tethers; logs: of the devices, None before they
    start, a list that goes on."""

    def __init__(self, every_s: float | None, logs: Sequence[DeviceLog | None]) -> None:
        self._every_s, self._logs = every_s, logs

    def extend(self, device: int, end_s: float) -> float:
        """Let the samples of a device reach up to a time; return the first moment that came in reach, or infinity."""
        log = self._logs[device]
        if log is None:
            return inf
        before_s, log.end_s = log.end_s, max(log.end_s, end_s)
        return min(
            (self._first_after(pair, device, before_s) for pair in self._pairs() if device in pair), default=inf
        )

    def moments_between(self, begin_s: float, end_s: float) -> list[float]:
        """Moments inside a step at which tethers of any pair are asked for."""
        pairs, every_s = self._pairs(), self._every_s
        if not pairs or every_s is None:
            return []
        numbers = range(ceil(begin_s / every_s), floor(end_s / every_s) + 1)
        return [k * every_s for k in numbers if any(self._is_wanted(pair, k) for pair in pairs)]

    def asked_for(self, number: int, last_s: float, before_s: float) -> tuple[list[Pair], int]:
        """The pairs of all moments from a number on, up to a time and before another; and the number that follows."""
        every_s = self._every_s
        if every_s is None:
            return [], number
        found: list[Pair] = []
        number = max(number, ceil(min(log.start_s for log in self._logs if log is not None) / every_s))
        last = floor(last_s / every_s)
        while number <= last and number * every_s + SAME_S < before_s:
            found += [pair for pair in self._pairs() if self._is_wanted(pair, number)]
            number += 1
        return found, number

    def _pairs(self) -> list[Pair]:
        return [] if self._every_s is None else list(combinations(range(len(self._logs)), 2))

    def _is_wanted(self, pair: Pair, number: int) -> bool:
        a, b = self._logs[pair[0]], self._logs[pair[1]]
        if a is None or b is None or self._every_s is None:
            return False
        first = ceil(max(a.start_s, b.start_s) / self._every_s)
        return first <= number <= floor(min(a.end_s, b.end_s) / self._every_s)

    def _first_after(self, pair: Pair, device: int, before_s: float) -> float:
        """The first moment of a pair that is new now that a device, which reached up to a time before, goes on."""
        a, b = self._logs[pair[0]], self._logs[pair[1]]
        if a is None or b is None or self._every_s is None:
            return inf
        reached_s = min(before_s, (b if pair[0] == device else a).end_s)
        number = ceil(max(a.start_s, b.start_s) / self._every_s)
        if reached_s > -inf:
            number = max(number, floor(reached_s / self._every_s) + 1)
        return number * self._every_s if self._is_wanted(pair, number) else inf
