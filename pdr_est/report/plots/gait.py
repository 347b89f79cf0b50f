"""Figure of heading, step length and cadence over time."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator, MultipleLocator

from pdr_est.frames import wrap_angle
from pdr_est.pipeline import SmoothedWalk
from pdr_est.report.plots import figure as svg
from pdr_est.report.plots.mode_style import draw_strip, mode_runs, strips_height_in
from pdr_est.report.plots.time_axis import RASTER_FROM, TimeAxis, draw_dots
from pdr_est.types.track import Track

SIGMA_95 = 1.959963984540054  # half width of the 95 % interval in standard deviations
BOTTOM_IN, GAP_IN = 0.5, 0.28


def plot_gait(walk: SmoothedWalk, axis: TimeAxis) -> Figure:
    """Draw heading with its 95 % interval, step length and cadence of every step of every device.

    One strip for each device above them shows the carrying modes, the first device's on top.
    """
    heights_in = (1.5, 1.05, 1.05)
    figure = svg.new_figure(BOTTOM_IN + sum(heights_in) + 2 * GAP_IN + strips_height_in(len(walk.devices)))
    cadence = svg.add_axes(figure, BOTTOM_IN, heights_in[2])
    length = svg.add_axes(figure, BOTTOM_IN + heights_in[2] + GAP_IN, heights_in[1], cadence)
    heading = svg.add_axes(figure, BOTTOM_IN + sum(heights_in[1:]) + 2 * GAP_IN, heights_in[0], cadence)
    for place, device in enumerate(walk.devices):
        colour = svg.device_colour(place)
        track = walk.track.of_device(device.device)
        _headings(heading, track, axis, colour)
        draw_dots(length, axis(track.time_s[1:]), track.step_length_m[1:], colour)
        steps_s = np.array([step.event.time_s for step in device.steps])
        per_minute = 60.0 * np.array([step.frequency_hz for step in device.steps])
        walking = per_minute > 0.0  # the first step after a standstill has no cadence
        draw_dots(cadence, axis(steps_s[walking]), per_minute[walking], colour)
    gaps = [gap for device in walk.devices for gap in device.gaps]
    for axes in (heading, length, cadence):
        axis.apply(axes, gaps)
    _draw_strips(heading, walk, axis)
    _set_scales(heading, length, cadence)
    svg.label_axes(heading, y="heading (°)")
    svg.label_axes(length, y="length (m)")
    svg.label_axes(cadence, axis.label, "cadence (1/min)")
    return figure


def _draw_strips(axes: Axes, walk: SmoothedWalk, axis: TimeAxis) -> None:
    several = len(walk.devices) > 1
    for place, device in enumerate(walk.devices):
        row = len(walk.devices) - 1 - place
        draw_strip(axes, mode_runs(device), axis, row, svg.device_colour(place) if several else "")


def _set_scales(heading: Axes, length: Axes, cadence: Axes) -> None:
    heading.set_ylim(-180.0, 180.0)
    heading.yaxis.set_major_locator(MultipleLocator(90.0))
    for axes, least_top in ((length, 1.0), (cadence, 140.0)):
        axes.set_ylim(0.0, max(least_top, 1.05 * axes.dataLim.ymax) if np.isfinite(axes.dataLim.ymax) else least_top)
        axes.yaxis.set_major_locator(MaxNLocator(4))
    for axes in (heading, length):
        axes.tick_params(labelbottom=False)


def _headings(axes: Axes, track: Track, axis: TimeAxis, colour: str) -> None:
    """Draw headings wrapped to half a turn either way; an interval across the seam continues on the other side."""
    time, heading = axis(track.time_s), np.degrees(wrap_angle(track.heading_rad))
    half = np.minimum(np.degrees(SIGMA_95 * track.sigma_heading_rad), 180.0)
    dense = len(track) > RASTER_FROM
    alpha = 0.08 if dense else 0.22
    for turn in (-360.0, 0.0, 360.0):
        low, high = heading + turn - half, heading + turn + half
        seen = (high > -180.0) & (low < 180.0) & (half > 0.0)
        # One line with breaks: thousands of single lines take much longer.
        ends = np.column_stack([low[seen], high[seen], np.full(seen.sum(), np.nan)]).ravel()
        axes.plot(np.repeat(time[seen], 3), ends, color=colour, alpha=alpha, linewidth=1.4, rasterized=dense)
    draw_dots(axes, time, heading, colour)
