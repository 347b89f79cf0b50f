"""Seconds of air pressure and steps, as soon as all that belongs to them is known."""

from bisect import bisect_left, insort
from collections.abc import Iterable, Iterator
from math import floor, inf

import numpy as np

from pdr_est.frames import Array
from pdr_est.front_end.signal.barometric_height import height_by_pressure
from pdr_est.types.sensors import SensorBlock

_MOST_WAITING_S = 600  # seconds that wait for the steps in them


class PressureSeconds:
    """Collects the air pressure and the steps of a device, and gives them second by second.

    The steps become known some seconds later than the pressure, which does not wait for them. Samples that come after
    their second was given are left out.

    Parameters
    ----------
    steps_late_s
        Time by which steps are given later, whole s.
    """

    def __init__(self, steps_late_s: int) -> None:
        self._steps_late_s = steps_late_s
        self._times_s: list[Array] = []
        self._heights_m: list[Array] = []
        self._steps_s: list[float] = []
        self._newest_s = -inf  # time of the newest sample
        self._given = -inf  # begin of the second that is wanted next
        self._known_s = -inf  # time up to which all steps are known

    @property
    def has_pressure(self) -> bool:
        """Tell whether a usable sample has come."""
        return self._newest_s > -inf

    def push(self, block: SensorBlock) -> None:
        """Add samples of the air pressure."""
        time_s, pressure_pa = np.asarray(block.time_s, dtype=np.float64), np.asarray(block.values[:, 0])
        usable = np.isfinite(time_s) & np.isfinite(pressure_pa) & (pressure_pa > 0.0) & (time_s >= self._given)
        if usable.any():
            self._times_s.append(time_s[usable])
            self._heights_m.append(height_by_pressure(pressure_pa[usable]))
            self._newest_s = max(self._newest_s, float(self._times_s[-1].max()))

    def add_steps(self, times_s: Iterable[float], known_s: float) -> None:
        """Add steps; those up to a time are all known then."""
        for time_s in times_s:
            insort(self._steps_s, time_s)
        self._known_s = max(self._known_s, known_s)
        del self._steps_s[: bisect_left(self._steps_s, self._known_s - _MOST_WAITING_S)]

    def take(self, at_end: bool = False) -> Iterator[tuple[int, float, bool]]:
        """Give the seconds that are complete; at the end all of them.

        Yields
        ------
        tuple of int, float and bool
            Begin of the second, s; mean height in it, m; whether there was a step `steps_late_s` before.
        """
        before_s = self._newest_s if at_end else min(self._newest_s, self._known_s + self._steps_late_s)
        if not at_end and self._newest_s - before_s > _MOST_WAITING_S:
            before_s = self._newest_s - _MOST_WAITING_S
        if not self._times_s or before_s == -inf or (not at_end and before_s < self._given + 1.0):
            return
        before = floor(before_s) + at_end
        time_s, height_m = np.concatenate(self._times_s), np.concatenate(self._heights_m)
        ready = time_s < before
        self._times_s, self._heights_m = [time_s[~ready]], [height_m[~ready]]
        numbers, second = np.unique(np.floor(time_s[ready]).astype(np.int64), return_inverse=True)
        mean_m = np.bincount(second, weights=height_m[ready]) / np.maximum(np.bincount(second), 1)
        self._given = max(self._given, float(before))
        for number, mean in zip(numbers.tolist(), mean_m.tolist(), strict=True):
            earlier = number - self._steps_late_s
            place = bisect_left(self._steps_s, float(earlier))
            yield number, mean, place < len(self._steps_s) and self._steps_s[place] < earlier + 1.0
        del self._steps_s[: bisect_left(self._steps_s, float(before - self._steps_late_s))]
