"""Height and floor of the walker second by second, while the air pressure is recorded."""

from bisect import bisect_right, insort
from collections import deque
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.front_end.height import vertical_moves as modes
from pdr_est.front_end.height.floors import floors_of
from pdr_est.front_end.height.height_params import HeightParams
from pdr_est.front_end.height.level_watch import LevelWatch
from pdr_est.front_end.height.profile import sigma_of
from pdr_est.front_end.height.seconds import NOISE_FROM_DIFFERENCES, Second
from pdr_est.front_end.height.storeys import StoreyCount
from pdr_est.front_end.height.vertical_filter import Numbers
from pdr_est.types.height import WalkerHeight

REVISED_S = 20
"""Time for which what is told about a second may still be revised, s; later it is settled."""

_NOISE_S = 600  # seconds whose noise is looked at
_LEAST_DIFFERENCES = 10
_LONG_GAP_S = 1800  # without pressure for longer, the level begins anew
_MOST_CHANGES = 5000  # of what is told that are remembered


class HeightFollower:
    """Tells the height and the floor of each second, and revises what it told about the last ones.

    The hypotheses are those of `height_profile`; their heights are those of the filter, and are not smoothed. Memory
    does not grow with the walk.

    Parameters
    ----------
    parameters
        Rates of moves, storeys and noise.
    """

    def __init__(self, parameters: HeightParams) -> None:
        self._parameters = parameters
        self._noise = _RunningNoise(parameters.sigma_height_m)
        self._watch = LevelWatch(parameters)
        self._count = StoreyCount.at_start(parameters)
        self._number = 0, 1.0  # of the floor of the last decided second, and its probability
        self._from_m, self._from_m2 = 0.0, 0.0  # height and its variance where the watch began
        self._next: int | None = None  # number of the next second
        self._told: deque[WalkerHeight] = deque(maxlen=REVISED_S + 1)  # about the last seconds
        self._changes: deque[WalkerHeight] = deque(maxlen=_MOST_CHANGES)  # settled seconds unlike those before
        self._begins: deque[float] = deque(maxlen=_MOST_CHANGES)  # their times, s

    @property
    def next_second(self) -> int | None:
        """Return the number of the second that is wanted next, its begin in s; None before the first one."""
        return self._next

    @property
    def latest(self) -> WalkerHeight | None:
        """Return what is known about the last second; None before the first one."""
        return self._told[-1] if self._told else None

    def add(self, number: int, second: Second) -> None:
        """Take in a second after the last one; those between them had no pressure.

        Parameters
        ----------
        number
            Begin of the second, s.
        second
            Its measurements.
        """
        if self._next is not None and number - self._next > _LONG_GAP_S:
            self._begin_anew(number)
        for missing in range(number if self._next is None else self._next, number):
            self._add(missing, Second(float("nan"), None))
        self._add(number, second)

    def add_steps(self, number: int, stepped: bool) -> None:
        """Take in whether there was a step in a second of the past, which was added without knowing."""
        if self._next is not None and number < self._next:
            self._watch.add_steps(self._next - 1 - number, stepped)

    def at(self, time_s: float) -> WalkerHeight | None:
        """Return what is known about a time: of the nearest second that is known; None before the first one."""
        if not self._told:
            return None
        place = int(np.floor(time_s - self._told[0].time_s + 0.5))
        if place >= 0 or not self._changes:
            return replace(self._told[min(max(place, 0), len(self._told) - 1)], time_s=time_s)
        return replace(self._changes[max(bisect_right(list(self._begins), time_s + 0.5) - 1, 0)], time_s=time_s)

    def _add(self, number: int, second: Second) -> None:
        """Take in the next second."""
        self._next = number + 1
        self._watch.add(second, self._noise.after(second.height_m))
        mode, height_m, variance_m2 = self._latest_path()
        floor, probability = self._floors(mode, height_m, variance_m2)
        self._make_room()
        sigma_m = sigma_of(height_m, variance_m2, self._parameters)
        self._tell(number, (height_m, sigma_m, floor, probability, modes.is_moving(mode)))

    def _latest_path(self) -> tuple[Numbers, Array, Array]:
        """Return modes, heights and their variances of the seconds about which the mind may have changed."""
        mode, _, rise_m, rise_m2 = self._watch.latest
        return mode, rise_m + self._from_m, rise_m2 + self._from_m2

    def _floors(self, mode: Numbers, height_m: Array, variance_m2: Array) -> tuple[Numbers, Array]:
        """Find the floors of the seconds that are told now."""
        if not modes.is_moving(mode).any():
            number, probability = self._number
            floor, of_floor = np.full(len(mode), number), np.full(len(mode), probability)
        else:
            floor, of_floor, known = floors_of(mode, height_m, variance_m2, self._count, self._parameters)
            if not self._watch.is_open:
                self._count, self._number = known, known.number()
        if self._watch.is_open:
            of_floor[-1] *= self._watch.agreement(0.5 * self._count.storey_m)
        else:
            self._watch.forget()
        return floor, of_floor

    def _tell(self, last: int, known: tuple[Array, Array, Numbers, Array, NDArray[np.bool_]]) -> None:
        """Put down what is known about seconds, up to the last one: the columns of `WalkerHeight` after its time."""
        count = min(len(known[0]), REVISED_S + 1)
        for _ in range(min(count - 1, len(self._told))):
            self._told.pop()
        rows = zip(*(column[-count:].tolist() for column in known), strict=True)
        for place, row in enumerate(rows, start=last + 1 - count):
            self._told.append(WalkerHeight(place + 0.5, *row))

    def _make_room(self) -> None:
        """Settle the oldest second, if so many are known."""
        if len(self._told) <= REVISED_S:
            return
        oldest = self._told.popleft()
        if not self._changes or not oldest.equals(self._changes[-1]):
            self._changes.append(oldest)
            self._begins.append(oldest.time_s)

    def _begin_anew(self, number: int) -> None:
        """Begin at the present height after a long time without pressure."""
        latest = self._told[-1]
        if self._watch.is_open:
            self._count = floors_of(*self._latest_path(), self._count, self._parameters).known
            self._number = self._count.number()
        self._watch, self._next = LevelWatch(self._parameters), number
        self._from_m, self._from_m2 = latest.height_m, max(latest.sigma_m**2 - self._parameters.sigma_level_m**2, 0.0)
        while self._told:
            oldest = self._told.popleft()
            self._changes.append(oldest)
            self._begins.append(oldest.time_s)


class _RunningNoise:
    """Standard deviation of the noise of heights second by second, from the second differences of the last ones."""

    def __init__(self, least_m: float) -> None:
        self._least_m = least_m
        self._heights = (float("nan"), float("nan"))
        self._in_time: deque[float] = deque()
        self._sorted: list[float] = []

    def after(self, height_m: float) -> float:
        """Take in a height; return the standard deviation, m."""
        before, between = self._heights
        self._heights = between, height_m
        curvature = abs(before - 2.0 * between + height_m)
        if curvature == curvature:
            self._in_time.append(curvature)
            insort(self._sorted, curvature)
            if len(self._in_time) > _NOISE_S:
                del self._sorted[bisect_right(self._sorted, self._in_time.popleft()) - 1]
        if len(self._sorted) < _LEAST_DIFFERENCES:
            return self._least_m
        return max(self._least_m, self._sorted[len(self._sorted) // 2] * NOISE_FROM_DIFFERENCES)
