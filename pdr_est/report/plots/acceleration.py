"""Figure of the vertical acceleration with the detected steps."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from pdr_est.frames import Array
from pdr_est.pipeline import DeviceWalk
from pdr_est.report.plots import figure as svg
from pdr_est.report.plots.mode_style import draw_strip, mode_runs, strips_height_in
from pdr_est.report.plots.time_axis import TimeAxis, draw_dots

DETAIL_S = 12.0
OVERVIEW_BINS = 1500  # about two a pixel of the page
BOTTOM_IN, DETAIL_IN, BETWEEN_IN, OVERVIEW_IN = 0.5, 1.75, 0.52, 1.15

TimeSeries = tuple[Array, Array]  # times and values


def plot_acceleration(device: DeviceWalk, axis: TimeAxis, colour: str) -> Figure:
    """Draw the whole walk, and some seconds of it large enough to judge the detected steps.

    A strip above each axes shows the carrying modes. A recording of a few seconds is drawn once.

    Parameters
    ----------
    device : DeviceWalk
        Front-end result of one device.
    axis : TimeAxis
        Time axis of the walk.
    colour : str
        Colour of the dots that mark steps.

    Returns
    -------
    matplotlib.figure.Figure
        The figure.
    """
    segments = _segments(device)
    steps = _steps(device, segments)
    short = axis.end_s - axis.begin_s <= 1.5 * DETAIL_S
    runs, strip_in = mode_runs(device), strips_height_in(1)
    upper_in = 0.0 if short else BETWEEN_IN + OVERVIEW_IN + strip_in
    figure = svg.new_figure(BOTTOM_IN + DETAIL_IN + strip_in + upper_in)
    near = axis if short else _detail(steps[0], axis)
    detail = svg.add_axes(figure, BOTTOM_IN, DETAIL_IN)
    _draw(detail, segments, steps, near, colour)
    near.apply(detail, device.gaps)
    draw_strip(detail, runs, near)
    svg.label_axes(
        detail, near.label if short else f"{near.label}: the shaded part above, enlarged", "vertical (m/s²)"
    )
    if not short:
        whole = svg.add_axes(figure, BOTTOM_IN + DETAIL_IN + strip_in + BETWEEN_IN, OVERVIEW_IN)
        whole.axvspan(*axis(np.array([near.begin_s, near.end_s])), facecolor=colour, alpha=0.16, linewidth=0)
        _draw(whole, segments, steps, axis, colour)
        axis.apply(whole, device.gaps)
        draw_strip(whole, runs, axis)
        # The unit of the overview differs from that of the part below in a long recording.
        svg.label_axes(whole, f"({axis.unit[1]})" if axis.unit != near.unit else "", "vertical (m/s²)")
    return figure


def _segments(device: DeviceWalk) -> list[TimeSeries]:
    """Collect time and vertical acceleration of each segment without a gap."""
    blocks = [block for block in device.level if len(block)]
    numbers = np.array([block.segment for block in blocks])
    parts = np.split(np.arange(len(blocks)), np.flatnonzero(np.diff(numbers)) + 1) if blocks else []
    return [
        (np.concatenate([blocks[i].time_s for i in part]), np.concatenate([blocks[i].vertical_mps2 for i in part]))
        for part in parts
    ]


def _steps(device: DeviceWalk, segments: list[TimeSeries]) -> TimeSeries:
    """Collect the times of the steps and the vertical acceleration at them."""
    steps_s = np.array([step.event.time_s for step in device.steps])
    if not segments:
        return steps_s, np.full(len(steps_s), np.nan)
    time_s, vertical = (np.concatenate(column) for column in zip(*segments, strict=True))
    return steps_s, np.asarray(np.interp(steps_s, time_s, vertical), dtype=np.float64)


def _detail(steps_s: Array, axis: TimeAxis) -> TimeAxis:
    """Choose the part of the axis that is enlarged: around the middle step, inside the recording."""
    middle = float(steps_s[len(steps_s) // 2]) if len(steps_s) else (axis.begin_s + axis.end_s) / 2.0
    begin_s = max(min(middle - DETAIL_S / 2.0, axis.end_s - DETAIL_S), axis.begin_s)
    return axis.section(begin_s, begin_s + DETAIL_S)


def _draw(axes: Axes, segments: list[TimeSeries], steps: TimeSeries, axis: TimeAxis, colour: str) -> None:
    """Draw the part of the signal and of the steps that the axis shows."""
    parts = [_within(segment, axis) for segment in segments]
    total = sum(len(time_s) for time_s, _ in parts)
    width = 1.1 if total < 2 * OVERVIEW_BINS else 0.6
    # One line with breaks: thousands of single lines would take minutes.
    broken = (np.array([np.nan]), np.array([np.nan]))
    pieces = [
        piece
        for time_s, vertical in parts
        if len(time_s)
        for piece in (svg.min_max_envelope(time_s, vertical, max(2, OVERVIEW_BINS * len(time_s) // total)), broken)
    ]
    if pieces:
        line_s, line = (np.concatenate(column) for column in zip(*pieces[:-1], strict=True))
        axes.plot(axis(line_s), line, color=svg.MUTED, linewidth=width)
    axes.yaxis.set_major_locator(MaxNLocator(5, steps=[1, 2, 5, 10]))
    shown_s, heights = _within(steps, axis)
    draw_dots(axes, axis(shown_s), heights, colour)


def _within(line: TimeSeries, axis: TimeAxis) -> TimeSeries:
    time_s, values = line
    shown = (time_s >= axis.begin_s) & (time_s <= axis.end_s)
    return time_s[shown], values[shown]
