"""Clean the samples of one channel and integrate the piecewise linear signal through them."""

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.preprocessing.sensor_ranges import SENSOR_RANGES, out_of_range
from pdr_est.types.sensors import Channel, Gap

_ROUNDING_S = 1e-6  # time stamps are rounded: a time of exactly max_gap_s must not become a gap by that


class ChannelIntegral:
    """Cleaned samples of one channel, with the running integral of the piecewise linear signal.

    Samples that are not finite, out of the range of the sensor, or have a duplicate or slightly backward time stamp
    are dropped and counted. A clock that jumps back by more than `max_gap_s` has restarted: later times are moved so
    that the samples after it begin two `max_gap_s` after the samples before it.

    Parameters
    ----------
    channel
        Channel of the samples.
    max_gap_s
        Longest gap between samples, s, that is interpolated.

    Attributes
    ----------
    time_s
        (n,) times of the samples still kept, s, increasing.
    first_s
        Time of the first sample ever, s; NaN before it.
    gaps
        Gaps longer than `max_gap_s`, and restarts of the clock.
    dropped
        Number of dropped samples by reason.
    """

    def __init__(self, channel: Channel, max_gap_s: float) -> None:
        self._channel = channel
        self._max_gap_s = max_gap_s
        self._longest_s = max_gap_s + _ROUNDING_S
        limit = SENSOR_RANGES.get(channel)
        self._largest = float(np.finfo(np.float64).max) if limit is None else limit.largest
        self._last_raw_s: float | None = None
        self._clock_offset_s = 0.0
        self._restarts_s: set[float] = set()
        self.first_s = float("nan")
        self.time_s: Array = np.empty(0)
        self._values: Array = np.empty((0, 0))
        self._integral: Array = np.empty((0, 0))
        self.gaps: list[Gap] = []
        self.dropped = {"not finite": 0, "impossible": 0, "duplicate time": 0, "backward time": 0}

    def append(self, time_s: Array, values: Array) -> None:
        """Append samples with times (n,), s, and values (n, k)."""
        time, values = self._possible(time_s, values)
        if not len(time):
            return
        time, values = self._increasing(self._continuous(time), values)
        if not len(time):
            return
        if self._channel is Channel.ATTITUDE:
            values = _same_hemisphere(self._values[-1] if len(self.time_s) else values[0], values)
        self._extend(time, values)

    def _possible(self, time_s: Array, values: Array) -> tuple[Array, Array]:
        """Drop samples that are not finite or out of range."""
        if bool((np.abs(values) <= self._largest).all() and np.isfinite(time_s).all()):
            return time_s, values
        finite = np.isfinite(time_s) & np.isfinite(values).all(axis=1)
        possible = finite & ~out_of_range(self._channel, values)
        finite_count, count = int(np.count_nonzero(finite)), int(np.count_nonzero(possible))
        self.dropped["not finite"] += len(time_s) - finite_count
        self.dropped["impossible"] += finite_count - count
        return time_s[possible], values[possible]

    def _continuous(self, time: Array) -> Array:
        """Bridge restarts of the clock."""
        previous = np.concatenate([[time[0] if self._last_raw_s is None else self._last_raw_s], time[:-1]])
        back = previous - time
        restart = back > self._max_gap_s
        if not restart.any():
            self._last_raw_s = float(time[-1])
            moved: Array = time + self._clock_offset_s
            return moved
        jump = np.where(restart, back + 2.0 * self._max_gap_s, 0.0)
        # The carry goes in as the first element: that keeps the sum independent of the cutting into blocks.
        offset = np.cumsum(np.concatenate([[self._clock_offset_s], jump]))
        for i in np.flatnonzero(restart):
            start, end = float(previous[i] + offset[i]), float(time[i] + offset[i + 1])
            self._restarts_s.add(end)
            self.gaps.append(Gap(self._channel.value, start, end, f"clock reset by {-back[i]:.3f} s"))
        self._last_raw_s = float(time[-1])
        self._clock_offset_s = float(offset[-1])
        continuous: Array = time + offset[1:]
        return continuous

    def _increasing(self, time: Array, values: Array) -> tuple[Array, Array]:
        """Drop samples whose time is not later than all before them."""
        latest = self.time_s[-1] if len(self.time_s) else -np.inf
        before = np.maximum.accumulate(np.concatenate([[latest], time[:-1]]))
        keep = time > before
        if keep.all():
            return time, values
        self.dropped["duplicate time"] += int((time == before).sum())
        self.dropped["backward time"] += int((time < before).sum())
        return time[keep], values[keep]

    def _extend(self, time: Array, values: Array) -> None:
        """Add cleaned samples to the integral and list the gaps between them."""
        if not len(self.time_s):
            self.first_s = float(time[0])
            self.time_s, self._values = time[:1], values[:1]
            self._integral = np.zeros((1, values.shape[1]))
            time, values = time[1:], values[1:]
        all_time = np.concatenate([self.time_s[-1:], time])
        all_values = np.concatenate([self._values[-1:], values])
        step = all_time[1:] - all_time[:-1]
        too_long = step > self._longest_s
        for i in np.flatnonzero(too_long) if too_long.any() else ():
            start, end = float(all_time[i]), float(all_time[i + 1])
            if end not in self._restarts_s:  # those are listed already
                self.gaps.append(Gap(self._channel.value, start, end, "gap"))
        areas = 0.5 * step[:, None] * (all_values[:-1] + all_values[1:])
        integral = np.concatenate([self._integral[-1:], areas]).cumsum(axis=0)
        self.time_s = np.concatenate([self.time_s, time])
        self._values = np.concatenate([self._values, values])
        self._integral = np.concatenate([self._integral, integral[1:]])

    def integral_at(self, edges: Array) -> tuple[Array, NDArray[np.bool_]]:
        """Evaluate the integral up to each time, and tell whether the time lies inside a gap.

        Parameters
        ----------
        edges
            (m,) times, s, between the first and the last sample kept.

        Returns
        -------
        integral : (m, k)
        in_gap : (m,) bool
        """
        i = np.minimum(np.maximum(self.time_s.searchsorted(edges, side="right") - 1, 0), len(self.time_s) - 2)
        span = self.time_s[i + 1] - self.time_s[i]
        dt = edges - self.time_s[i]
        before = self._values.take(i, axis=0)
        slope = (self._values.take(i + 1, axis=0) - before) / span[:, None]
        integral = self._integral.take(i, axis=0) + dt[:, None] * (before + 0.5 * dt[:, None] * slope)
        return integral, span > self._longest_s

    def integral_or_nan(self, edges: Array) -> Array:
        """Evaluate the integral (m, k) up to each time (m,); NaN where the channel was not recorded."""
        if len(self.time_s) < 2:
            return np.full((len(edges), self._channel.width), np.nan)
        integral, inside = self.integral_at(edges)
        outside = inside | (edges < self.time_s[0]) | (edges >= self.time_s[-1])
        return np.where(outside[:, None], np.nan, integral)

    def gap_end_s(self, time_s: float) -> float:
        """Return the end of the gap that contains a time; the time itself where there is no gap."""
        i = int(np.searchsorted(self.time_s, time_s, side="right"))
        inside = 0 < i < len(self.time_s) and self.time_s[i] - self.time_s[i - 1] > self._longest_s
        return float(self.time_s[i]) if inside else time_s

    def restarted_between(self, start_s: float, end_s: float) -> bool:
        """Return True if the clock of the channel restarted between two times."""
        return any(start_s <= time_s <= end_s for time_s in self._restarts_s)

    def record_missing_ends(self, first_s: float, last_s: float) -> None:
        """List as gaps what this channel missed between the first and the last sample of any channel, s."""
        own_last_s = float(self.time_s[-1])
        if self.first_s - first_s > self._longest_s:
            self.gaps.append(Gap(self._channel.value, first_s, self.first_s, "began later than another channel"))
        if last_s - own_last_s > self._longest_s:
            self.gaps.append(Gap(self._channel.value, own_last_s, last_s, "ended earlier than another channel"))

    def discard_before(self, time_s: float) -> None:
        """Free the samples that are not needed for times from time_s on."""
        keep = max(int(np.searchsorted(self.time_s, time_s, side="right")) - 1, 0)
        self.time_s = self.time_s[keep:]
        self._values = self._values[keep:]
        self._integral = self._integral[keep:]


def _same_hemisphere(reference: Array, quaternion: Array) -> Array:
    """Choose the signs of quaternions so that their mean is defined: q and -q are one attitude."""
    previous = np.concatenate([reference[None, :], quaternion[:-1]])
    dot = (previous * quaternion)[:, 0].copy()
    for k in range(1, 4):
        dot += previous[:, k] * quaternion[:, k]
    sign = np.cumprod(np.where(dot < 0.0, -1.0, 1.0))
    return quaternion * sign[:, None]
