"""From recorder time stamps to a uniform grid: a stage that consumes SensorBlock and emits ImuBlock.

Each grid value is the mean of the piecewise linear signal over one grid period. The mean keeps the integral of
the rotation rate exact, smooths faster input against aliasing and interpolates slower input, whatever the jitter.
"""

from typing import Annotated

import numpy as np
from annotated_types import Ge, Le
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.io.limits import impossible
from pdr_est.params import Positive, params
from pdr_est.records import Channel, Gap, ImuBlock, SensorBlock

_ROUNDING_S = 1e-6  # time stamps are rounded: a pause of exactly max_gap_s must not become a gap by that
_MOST_POINTS = 1 << 16  # evaluated at once, which bounds the memory that a jump of the clock can ask for


@params
class ResampleParams:
    """rate_hz: working rate. max_gap_s: longest pause between samples that is interpolated; a longer one ends
    the segment."""

    rate_hz: Annotated[float, Ge(10.0), Le(1000.0)] = 50.0
    max_gap_s: Positive = 0.5


class Resampler:
    """Several channels of one device onto one grid; the specific force must be among them.

    Samples with values that are not finite or that no phone can measure (`limits`), and those with duplicate or
    slightly backward time stamps, are dropped and counted in `dropped`. A clock that
    jumps back by more than `max_gap_s` was restarted: the samples after it are kept, as a new segment that begins
    two `max_gap_s` later. Gaps and restarts are collected in `gaps`, and at `flush` what a channel missed because it
    began later or ended earlier than the others.
    """

    def __init__(self, channels: tuple[Channel, ...], parameters: ResampleParams) -> None:
        self._period_s = 1.0 / parameters.rate_hz
        self._max_gap_s = parameters.max_gap_s
        self._inputs = {channel: _ChannelIntegral(channel, parameters.max_gap_s) for channel in channels}
        self._first_edge_s = float("nan")
        self._next_index = 0
        self._segment = 0
        self._in_gap = False

    @property
    def latency_s(self) -> float:
        return self._max_gap_s + 1.5 * self._period_s

    @property
    def gaps(self) -> tuple[Gap, ...]:
        """What was not recorded, in the order of its beginning."""
        gaps = [gap for channel in self._inputs.values() for gap in channel.gaps]
        return tuple(sorted(gaps, key=lambda gap: gap.start_s))

    @property
    def dropped(self) -> dict[str, int]:
        """Samples left out, by channel and reason."""
        return {
            f"{channel.value}: {reason}": count
            for channel, integral in self._inputs.items()
            for reason, count in integral.dropped.items()
            if count
        }

    def push(self, item: SensorBlock, /) -> list[ImuBlock]:
        if item.channel in self._inputs:
            self._inputs[item.channel].append(item.time_s, item.values)
        return self._emit()

    def flush(self) -> list[ImuBlock]:
        present = [channel for channel in self._inputs.values() if len(channel.time_s)]
        if present:
            first = min(channel.first_s for channel in present)
            last = max(float(channel.time_s[-1]) for channel in present)
            for channel in present:
                channel.list_missing_ends(first, last)
        return []

    def _emit(self) -> list[ImuBlock]:
        """All grid values that every channel covers, cut into blocks at gaps."""
        inputs = self._inputs.values()
        if not all(len(channel.time_s) for channel in inputs):
            return []
        if np.isnan(self._first_edge_s):
            self._first_edge_s = max(float(channel.time_s[0]) for channel in inputs)
        last = min(float(channel.time_s[-1]) for channel in inputs)
        # One period is held back, so that rounding here never asks for an edge not yet covered.
        end = self._points_before(last) - 1
        blocks = []
        while self._next_index < end:
            blocks += self._evaluate(min(end - self._next_index, _MOST_POINTS))
            self._skip_gap()
        if blocks:
            for channel in inputs:
                channel.forget_before(self._edge_s(self._next_index))
        return blocks

    def _edge_s(self, index: int) -> float:
        """Where the period of a grid point begins."""
        return self._first_edge_s + self._period_s * index

    def _points_before(self, time_s: float) -> int:
        """Grid points whose whole period lies before a time, give or take one by rounding."""
        return int(np.floor((time_s - self._first_edge_s) / self._period_s))

    def _evaluate(self, count: int) -> list[ImuBlock]:
        """The next grid values."""
        index = np.arange(self._next_index, self._next_index + count + 1, dtype=np.float64)
        edges: Array = self._first_edge_s + self._period_s * index
        means, observed = {}, np.ones(count, dtype=np.bool_)
        for name, channel in self._inputs.items():
            integral, inside = channel.at(edges)
            means[name] = np.diff(integral, axis=0) / self._period_s
            observed &= ~(inside[:-1] | inside[1:])
        return self._cut(0.5 * (edges[:-1] + edges[1:]), means, observed)

    def _skip_gap(self) -> None:
        """Go on behind a gap, with a point to spare: a clock may jump by years."""
        edge_s = self._edge_s(self._next_index)
        behind = max(self._points_before(channel.gap_end_s(edge_s)) - 1 for channel in self._inputs.values())
        self._next_index = max(self._next_index, behind)

    def _cut(self, time: Array, means: dict[Channel, Array], observed: NDArray[np.bool_]) -> list[ImuBlock]:
        """Blocks of consecutive observed grid points; every stretch after a gap is a new segment."""
        blocks = []
        borders = np.flatnonzero(np.diff(observed)) + 1
        for start, stop in zip([0, *borders], [*borders, len(observed)], strict=True):
            if not observed[start]:
                self._in_gap = True
                continue
            if self._in_gap:
                self._segment += 1
                self._in_gap = False
            blocks.append(
                ImuBlock(
                    first_index=self._next_index + int(start),
                    segment=self._segment,
                    time_s=time[start:stop],
                    specific_force_mps2=means[Channel.SPECIFIC_FORCE][start:stop],
                    rotation_rate_radps=_part(means.get(Channel.ROTATION_RATE), start, stop),
                    attitude=_unit(means.get(Channel.ATTITUDE), start, stop),
                    magnetic_field_ut=_part(means.get(Channel.MAGNETIC_FIELD), start, stop),
                )
            )
        self._next_index += len(observed)
        return blocks


def _part(values: Array | None, start: int, stop: int) -> Array | None:
    return None if values is None else values[start:stop]


def _unit(quaternion: Array | None, start: int, stop: int) -> Array | None:
    if quaternion is None:
        return None
    w, x, y, z = quaternion[start:stop].T
    norm = np.sqrt(w * w + x * x + y * y + z * z)
    return np.stack([w / norm, x / norm, y / norm, z / norm], axis=1)


class _ChannelIntegral:
    """One channel's samples, cleaned, with the running integral of the line through them."""

    def __init__(self, channel: Channel, max_gap_s: float) -> None:
        self._channel = channel
        self._max_gap_s = max_gap_s
        self._longest_s = max_gap_s + _ROUNDING_S
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
        finite = np.isfinite(time_s) & np.isfinite(values).all(axis=1)
        possible = finite & ~impossible(self._channel, values)
        self.dropped["not finite"] += int(len(time_s) - finite.sum())
        self.dropped["impossible"] += int(finite.sum() - possible.sum())
        time, values = time_s[possible], values[possible]
        if not len(time):
            return
        time, values = self._increasing(self._continuous(time), values)
        if not len(time):
            return
        if self._channel is Channel.ATTITUDE:
            values = _same_hemisphere(self._values[-1] if len(self.time_s) else values[0], values)
        self._extend(time, values)

    def _continuous(self, time: Array) -> Array:
        """Time stamps with restarts of the clock bridged."""
        previous = np.concatenate([[time[0] if self._last_raw_s is None else self._last_raw_s], time[:-1]])
        back = previous - time
        restart = back > self._max_gap_s
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
        latest = self.time_s[-1] if len(self.time_s) else -np.inf
        before = np.maximum.accumulate(np.concatenate([[latest], time[:-1]]))
        self.dropped["duplicate time"] += int((time == before).sum())
        self.dropped["backward time"] += int((time < before).sum())
        keep = time > before
        return time[keep], values[keep]

    def _extend(self, time: Array, values: Array) -> None:
        if not len(self.time_s):
            self.first_s = float(time[0])
            self.time_s, self._values = time[:1], values[:1]
            self._integral = np.zeros((1, values.shape[1]))
            time, values = time[1:], values[1:]
        all_time = np.concatenate([self.time_s[-1:], time])
        all_values = np.concatenate([self._values[-1:], values])
        step = np.diff(all_time)
        for i in np.flatnonzero(step > self._longest_s):
            start, end = float(all_time[i]), float(all_time[i + 1])
            if end not in self._restarts_s:  # those are listed already
                self.gaps.append(Gap(self._channel.value, start, end, "gap"))
        areas = 0.5 * step[:, None] * (all_values[:-1] + all_values[1:])
        integral = np.cumsum(np.concatenate([self._integral[-1:], areas]), axis=0)
        self.time_s = np.concatenate([self.time_s, time])
        self._values = np.concatenate([self._values, values])
        self._integral = np.concatenate([self._integral, integral[1:]])

    def at(self, edges: Array) -> tuple[Array, NDArray[np.bool_]]:
        """Integral up to each edge, (m, k), and whether the edge lies inside a gap."""
        i = np.clip(np.searchsorted(self.time_s, edges, side="right") - 1, 0, len(self.time_s) - 2)
        span = self.time_s[i + 1] - self.time_s[i]
        dt = edges - self.time_s[i]
        slope = (self._values[i + 1] - self._values[i]) / span[:, None]
        integral = self._integral[i] + dt[:, None] * (self._values[i] + 0.5 * dt[:, None] * slope)
        return integral, span > self._longest_s

    def gap_end_s(self, time_s: float) -> float:
        """When the gap that a time lies in ends; the time itself where there is none."""
        i = int(np.searchsorted(self.time_s, time_s, side="right"))
        inside = 0 < i < len(self.time_s) and self.time_s[i] - self.time_s[i - 1] > self._longest_s
        return float(self.time_s[i]) if inside else time_s

    def list_missing_ends(self, first_s: float, last_s: float) -> None:
        """Add to the gaps what this channel missed between the first and the last sample of any channel."""
        own_last_s = float(self.time_s[-1])
        if self.first_s - first_s > self._longest_s:
            self.gaps.append(Gap(self._channel.value, first_s, self.first_s, "began later than another channel"))
        if last_s - own_last_s > self._longest_s:
            self.gaps.append(Gap(self._channel.value, own_last_s, last_s, "ended earlier than another channel"))

    def forget_before(self, time_s: float) -> None:
        keep = max(int(np.searchsorted(self.time_s, time_s, side="right")) - 1, 0)
        self.time_s = self.time_s[keep:]
        self._values = self._values[keep:]
        self._integral = self._integral[keep:]


def _same_hemisphere(reference: Array, quaternion: Array) -> Array:
    """Signs such that consecutive quaternions point the same way: q and -q are one attitude, their mean is none."""
    previous = np.concatenate([reference[None, :], quaternion[:-1]])
    dot = (previous * quaternion)[:, 0].copy()
    for k in range(1, 4):
        dot += previous[:, k] * quaternion[:, k]
    sign = np.cumprod(np.where(dot < 0.0, -1.0, 1.0))
    return quaternion * sign[:, None]
