"""What happened over time: acceleration with the detected steps, and heading, step length and cadence."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator, MultipleLocator

from pdr_est.frames import Array, wrap_angle
from pdr_est.pipeline import DeviceWalk, SmoothedWalk
from pdr_est.records import Gap
from pdr_est.report import svg
from pdr_est.track import Track

OVERVIEW_BINS = 1500  # about two a pixel of the page
DETAIL_S = 12.0
RASTER_FROM = 2500  # marks; more are drawn as an image
SIGMA_95 = 1.959963984540054
BOTTOM_IN, TOP_IN, GAP_IN = 0.55, 0.1, 0.28


@dataclass(frozen=True)
class TimeAxis:
    """The stretch of time that all plots share, in a unit that suits its length."""

    start_s: float
    end_s: float

    @property
    def unit(self) -> tuple[float, str]:
        """Seconds in the unit, and its sign."""
        duration_s = self.end_s - self.start_s
        if duration_s < 200.0:
            return 1.0, "s"
        return (60.0, "min") if duration_s < 3 * 3600.0 else (3600.0, "h")

    @property
    def label(self) -> str:
        return f"time since the start of the recording ({self.unit[1]})"

    def __call__(self, time_s: Array | float) -> Array:
        """Times of the recording in the axis' unit, counted from its start."""
        return (np.asarray(time_s, dtype=np.float64) - self.start_s) / self.unit[0]

    def apply(self, axes: Axes, gaps: Sequence[Gap]) -> None:
        """Set the limits and shade what was not recorded."""
        axes.set_xlim(0.0, float(self(self.end_s)))
        axes.xaxis.set_major_locator(
            MaxNLocator(10, steps=[1, 2, 5, 10] if self.unit[0] == 1.0 else [1, 1.5, 3, 6, 10])
        )
        for gap in gaps:
            axes.axvspan(*self(np.array([gap.start_s, gap.end_s])), facecolor=svg.MUTED, alpha=0.18, linewidth=0)


def time_axis(walk: SmoothedWalk) -> TimeAxis:
    """From the first to the last sample or pose."""
    times = [walk.track.time_s] + [block.time_s for device in walk.devices for block in device.level]
    ends = np.array([t for time_s in times if len(time_s) for t in (time_s[0], time_s[-1])] or [0.0])
    return TimeAxis(float(ends.min()), float(max(ends.max(), ends.min() + 1.0)))


def plot_acceleration(device: DeviceWalk, axis: TimeAxis, colour: str) -> Figure:
    """Vertical acceleration with the detected steps: the whole walk, and some seconds large enough to judge."""
    time_s, vertical = _vertical(device)
    steps_s = np.array([step.event.time_s for step in device.steps])
    heights_in = (1.15, 1.75)
    figure = svg.new_figure(BOTTOM_IN + sum(heights_in) + 2 * GAP_IN + TOP_IN + 0.2)
    detail = svg.add_axes(figure, BOTTOM_IN, heights_in[1])
    whole = svg.add_axes(figure, BOTTOM_IN + heights_in[1] + 2 * GAP_IN + 0.2, heights_in[0])
    at_steps = _at(steps_s, time_s, vertical)

    line_s, line = svg.envelope(time_s, vertical, OVERVIEW_BINS)
    whole.plot(axis(line_s), line, color=svg.MUTED, linewidth=0.6, alpha=0.8)
    size = 2.4 if len(steps_s) < 500 else 1.4
    whole.plot(axis(steps_s), at_steps, "o", color=colour, markersize=size, rasterized=len(steps_s) > RASTER_FROM)
    axis.apply(whole, device.gaps)
    svg.label_axes(whole, y="m/s²")

    begin_s = _busiest(steps_s, axis)
    end_s = begin_s + DETAIL_S
    whole.axvspan(*axis(np.array([begin_s, end_s])), facecolor=colour, alpha=0.13, linewidth=0)
    near = (time_s >= begin_s) & (time_s <= end_s)
    detail.plot(time_s[near] - axis.start_s, vertical[near], color=svg.MUTED, linewidth=1.1)
    inside = (steps_s >= begin_s) & (steps_s <= end_s)
    detail.plot(
        steps_s[inside] - axis.start_s, at_steps[inside], "o", color=colour, markeredgecolor=svg.PAPER, markersize=6.5
    )
    detail.set_xlim(begin_s - axis.start_s, end_s - axis.start_s)
    detail.xaxis.set_major_locator(MultipleLocator(1.0))
    svg.label_axes(detail, "time since the start of the recording (s): the shaded part above, enlarged", "m/s²")
    return figure


def _vertical(device: DeviceWalk) -> tuple[Array, Array]:
    """Time and vertical acceleration of a device; a NaN parts what a gap parts."""
    blocks = [block for block in device.level if len(block)]
    if not blocks:
        return np.zeros(0), np.zeros(0)
    times, values = [blocks[0].time_s], [blocks[0].vertical_mps2]
    for before, block in pairwise(blocks):
        if block.segment != before.segment:
            times.append(before.time_s[-1:])
            values.append(np.array([np.nan]))
        times.append(block.time_s)
        values.append(block.vertical_mps2)
    return np.concatenate(times), np.concatenate(values)


def _at(when_s: Array, time_s: Array, values: Array) -> Array:
    known = np.isfinite(values)
    if not known.any():
        return np.full(len(when_s), np.nan)
    return np.asarray(np.interp(when_s, time_s[known], values[known]), dtype=np.float64)


def _busiest(steps_s: Array, axis: TimeAxis) -> float:
    """Start of the enlarged stretch: around the middle step, inside the recording where it is long enough."""
    middle = float(steps_s[len(steps_s) // 2]) if len(steps_s) else (axis.start_s + axis.end_s) / 2.0
    return max(min(middle - DETAIL_S / 2.0, axis.end_s - DETAIL_S), axis.start_s)


def plot_gait(walk: SmoothedWalk, axis: TimeAxis) -> Figure:
    """Heading with its 95 % interval, step length and cadence of every step of every device."""
    heights_in = (1.5, 1.05, 1.05)
    figure = svg.new_figure(BOTTOM_IN + sum(heights_in) + 2 * GAP_IN + TOP_IN)
    cadence = svg.add_axes(figure, BOTTOM_IN, heights_in[2])
    length = svg.add_axes(figure, BOTTOM_IN + heights_in[2] + GAP_IN, heights_in[1], cadence)
    heading = svg.add_axes(figure, BOTTOM_IN + sum(heights_in[1:]) + 2 * GAP_IN, heights_in[0], cadence)
    colours = {name: svg.series_colour(number) for number, name in enumerate(walk.track.devices)}
    for name, colour in colours.items():
        track = walk.track.of_device(name)
        _headings(heading, track, axis, colour)
        _dots(length, axis(track.time_s[1:]), track.step_length_m[1:], colour)
    for device in walk.devices:
        steps_s = np.array([step.event.time_s for step in device.steps])
        per_minute = 60.0 * np.array([step.frequency_hz for step in device.steps])
        per_minute[per_minute <= 0.0] = np.nan  # the first step after a standstill has no cadence
        _dots(cadence, axis(steps_s), per_minute, colours.get(device.device, svg.MUTED))
    gaps = [gap for device in walk.devices for gap in device.gaps]
    for axes in (heading, length, cadence):
        axis.apply(axes, gaps)
    _set_scales(heading, length, cadence)
    svg.label_axes(heading, y="heading (°)")
    svg.label_axes(length, y="length (m)")
    svg.label_axes(cadence, axis.label, "steps/min")
    return figure


def _set_scales(heading: Axes, length: Axes, cadence: Axes) -> None:
    heading.set_ylim(-180.0, 180.0)
    heading.yaxis.set_major_locator(MultipleLocator(90.0))
    for axes, least_top in ((length, 1.0), (cadence, 140.0)):
        axes.set_ylim(0.0, max(least_top, 1.05 * axes.dataLim.ymax) if np.isfinite(axes.dataLim.ymax) else least_top)
        axes.yaxis.set_major_locator(MaxNLocator(4))
    for axes in (heading, length):
        axes.tick_params(labelbottom=False)


def _headings(axes: Axes, track: Track, axis: TimeAxis, colour: str) -> None:
    """Headings wrapped to half a turn either way; an interval across the seam continues on the other side."""
    time, heading = axis(track.time_s), np.degrees(wrap_angle(track.heading_rad))
    half = np.minimum(np.degrees(SIGMA_95 * track.sigma_heading_rad), 180.0)
    dense = len(track) > RASTER_FROM
    for turn in (-360.0, 0.0, 360.0):
        low, high = heading + turn - half, heading + turn + half
        seen = (high > -180.0) & (low < 180.0) & (half > 0.0)
        axes.vlines(time[seen], low[seen], high[seen], color=colour, alpha=0.22, linewidth=1.4, rasterized=dense)
    _dots(axes, time, heading, colour)


def _dots(axes: Axes, x: Array, y: Array, colour: str) -> None:
    size = 2.6 if len(x) < 600 else 1.6
    axes.plot(x, y, "o", color=colour, markersize=size, markeredgewidth=0, rasterized=len(x) > RASTER_FROM)
