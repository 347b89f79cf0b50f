"""Resample the channels of a device onto a uniform grid: a stage that takes `SensorBlock` and emits `ImuBlock`.

Each grid value is the mean of the piecewise linear signal over one grid period. The mean keeps the integral of the
rotation rate exact, protects against aliasing when the input is faster and interpolates when it is slower, whatever
the jitter of the time stamps.
"""

from typing import Annotated

import numpy as np
from annotated_types import Ge, Le
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.params import Positive, params
from pdr_est.preprocessing.channel_integral import ChannelIntegral
from pdr_est.types.sensors import Channel, Gap, Hole, ImuBlock, SensorBlock

_OPTIONAL_LAG_S = 2.0  # how far an optional channel may lag behind the others
_SLOW_GAP_S = {Channel.PRESSURE: 1.5}  # sampled once a second by many phones; less than the time to wait for it
_MAX_POINTS = 1 << 16  # evaluated at once, which bounds the memory that a jump of the clock can ask for


@params
class ResampleParams:
    """Parameters of the resampling onto the uniform grid."""

    rate_hz: Annotated[float, Ge(10.0), Le(1000.0)] = 50.0
    """Working rate, Hz, of the uniform grid."""

    max_gap_s: Positive = 0.5
    """Longest gap between samples, s, that is interpolated; a longer one ends the segment."""


class Resampler:
    """Stage that resamples several channels of one device onto one grid.

    A grid point needs all required channels. A gap of one of them longer than `max_gap_s`, or a restart of its
    clock (a jump back by more than `max_gap_s`), ends the segment; after a restart the next segment begins two
    `max_gap_s` later. Samples that are not finite, beyond the range of any phone
    (`pdr_est.preprocessing.sensor_ranges`), or have a duplicate or slightly backward time stamp are dropped and
    counted.

    Values of optional channels are NaN where those have no sample: in their gaps, before their beginning and after
    their end. Grid, segments and gaps do not depend on them. An optional channel may come any time before the
    required ones and up to 2 s after them without changing an output; what comes later is lost, because a channel
    that has stopped cannot be waited for. Push a whole signal of an optional channel before the others. Gaps of the
    air pressure are interpolated up to 1.5 s.

    Parameters
    ----------
    channels
        Required channels; the specific force must be among them.
    parameters
        Rate and longest gap.
    optional
        Channels that may be absent.
    restarts_s
        Times of the first samples after restarts of the clock that are known beforehand, s, and mended: there the
        duration of a gap means nothing.
    """

    def __init__(
        self,
        channels: tuple[Channel, ...],
        parameters: ResampleParams,
        optional: tuple[Channel, ...] = (),
        restarts_s: tuple[float, ...] = (),
    ) -> None:
        self._period_s = 1.0 / parameters.rate_hz
        self._max_gap_s = parameters.max_gap_s
        self._inputs = {channel: ChannelIntegral(channel, parameters.max_gap_s) for channel in channels}
        self._optional = {
            channel: ChannelIntegral(channel, _SLOW_GAP_S.get(channel, parameters.max_gap_s)) for channel in optional
        }
        self._restarts_s = restarts_s
        self._first_edge_s = float("nan")
        self._next_index = 0
        self._segment = 0
        self._in_gap = False
        self._last_s: float | None = None  # time of the last grid value

    @property
    def latency_s(self) -> float:
        """Return the longest time, s, between a grid point and its output."""
        return self._max_gap_s + 1.5 * self._period_s + (self._wait_s if self._optional else 0.0)

    @property
    def _wait_s(self) -> float:
        """Time to wait for an optional channel: what has not come by then is in a gap of that channel."""
        return _OPTIONAL_LAG_S + self._max_gap_s + 2.0 * self._period_s

    @property
    def gaps(self) -> tuple[Gap, ...]:
        """List gaps and clock restarts of the required channels by their beginning.

        After `flush` the list also has what a channel missed because it began later or ended earlier than the others.
        """
        gaps = [gap for channel in self._inputs.values() for gap in channel.gaps]
        return tuple(sorted(gaps, key=lambda gap: gap.start_s))

    @property
    def dropped(self) -> dict[str, int]:
        """Count the dropped samples by channel and reason."""
        return {
            f"{channel.value}: {reason}": count
            for channel, integral in (self._inputs | self._optional).items()
            for reason, count in integral.dropped.items()
            if count
        }

    def push(self, item: SensorBlock, /) -> list[ImuBlock]:
        """Take samples of one channel; return the grid values that have become complete."""
        channel = self._inputs.get(item.channel) or self._optional.get(item.channel)
        if channel is not None:
            channel.append(item.time_s, item.values)
        return self._emit(self._wait_s)

    def flush(self) -> list[ImuBlock]:
        """Return the remaining grid values; call it once, at the end."""
        present = [channel for channel in self._inputs.values() if len(channel.time_s)]
        if present:
            first = min(channel.first_s for channel in present)
            last = max(float(channel.time_s[-1]) for channel in present)
            for channel in present:
                channel.record_missing_ends(first, last)
        return self._emit(wait_s=0.0)

    def _emit(self, wait_s: float) -> list[ImuBlock]:
        """Compute all complete grid values, waiting at most wait_s for optional channels."""
        inputs = self._inputs.values()
        if not all(len(channel.time_s) for channel in inputs):
            return []
        if np.isnan(self._first_edge_s):
            self._first_edge_s = max(float(channel.time_s[0]) for channel in inputs)
        last = min(float(channel.time_s[-1]) for channel in inputs)
        # One period is held back, so that rounding here never asks for an edge not yet covered.
        end = self._points_before(last) - 1
        for optional in self._optional.values():
            covered_s = float(optional.time_s[-1]) if len(optional.time_s) else -np.inf
            end = min(end, self._points_before(max(covered_s, last - wait_s)) - 1)
        blocks = []
        while self._next_index < end:
            blocks += self._evaluate(min(end - self._next_index, _MAX_POINTS))
            self._skip_gap()
        if blocks:
            for channel in [*inputs, *self._optional.values()]:
                channel.discard_before(self._edge_s(self._next_index))
        return blocks

    def _edge_s(self, index: int) -> float:
        """Return the beginning of the period of a grid point."""
        return self._first_edge_s + self._period_s * index

    def _points_before(self, time_s: float) -> int:
        """Count the grid points whose whole period lies before a time, up to one by rounding."""
        return int(np.floor((time_s - self._first_edge_s) / self._period_s))

    def _evaluate(self, count: int) -> list[ImuBlock]:
        """Compute the next `count` grid values."""
        index = np.arange(self._next_index, self._next_index + count + 1, dtype=np.float64)
        edges: Array = self._first_edge_s + self._period_s * index
        means, observed = {}, np.ones(count, dtype=np.bool_)
        for name, channel in self._inputs.items():
            integral, inside = channel.integral_at(edges)
            means[name] = (integral[1:] - integral[:-1]) / self._period_s
            observed &= ~(inside[:-1] | inside[1:])
        for name, channel in self._optional.items():
            means[name] = np.diff(channel.integral_or_nan(edges), axis=0) / self._period_s
        return self._cut(0.5 * (edges[:-1] + edges[1:]), means, observed)

    def _skip_gap(self) -> None:
        """Jump over a gap, because a clock may jump by years; one point is left to spare."""
        edge_s = self._edge_s(self._next_index)
        behind = max(self._points_before(channel.gap_end_s(edge_s)) - 1 for channel in self._inputs.values())
        self._next_index = max(self._next_index, behind)

    def _cut(self, time: Array, means: dict[Channel, Array], observed: NDArray[np.bool_]) -> list[ImuBlock]:
        """Divide grid points into blocks at gaps, after each of which a new segment begins."""
        blocks = []
        borders = np.flatnonzero(np.diff(observed)) + 1
        for start, stop in zip([0, *borders], [*borders, len(observed)], strict=True):
            if not observed[start]:
                self._in_gap = True
                continue
            hole = None
            if self._in_gap:
                self._segment += 1
                self._in_gap = False
                hole = self._hole_before(float(time[start]))
            self._last_s = float(time[stop - 1])
            blocks.append(
                ImuBlock(
                    first_index=self._next_index + int(start),
                    segment=self._segment,
                    time_s=time[start:stop],
                    specific_force_mps2=means[Channel.SPECIFIC_FORCE][start:stop],
                    rotation_rate_radps=_rows(means.get(Channel.ROTATION_RATE), start, stop),
                    attitude=_unit_quaternions(means.get(Channel.ATTITUDE), start, stop),
                    magnetic_field_ut=_rows(means.get(Channel.MAGNETIC_FIELD), start, stop),
                    pressure_pa=_column(means.get(Channel.PRESSURE), start, stop),
                    hole=hole,
                )
            )
        self._next_index += len(observed)
        return blocks

    def _hole_before(self, time_s: float) -> Hole | None:
        """Describe the gap before the first grid value of a segment; None if there was none before it."""
        last_s = self._last_s
        if last_s is None:
            return None
        restarted = any(channel.restarted_between(last_s, time_s) for channel in self._inputs.values())
        restarted |= any(last_s <= restart_s <= time_s for restart_s in self._restarts_s)
        return Hole(last_s, time_s, duration_known=not restarted)


def _rows(values: Array | None, start: int, stop: int) -> Array | None:
    return None if values is None else values[start:stop]


def _column(values: Array | None, start: int, stop: int) -> Array | None:
    return None if values is None else values[start:stop, 0]


def _unit_quaternions(quaternion: Array | None, start: int, stop: int) -> Array | None:
    if quaternion is None:
        return None
    w, x, y, z = quaternion[start:stop].T
    norm = np.sqrt(w * w + x * x + y * y + z * z)
    return np.stack([w / norm, x / norm, y / norm, z / norm], axis=1)
