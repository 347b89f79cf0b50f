"""Figure of the track on equal axes, with its uncertainty, fixes and truth."""

from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse
from matplotlib.ticker import MultipleLocator

from pdr_est.evaluate.consistency import CHI2_95_2D, radius95_m
from pdr_est.frames import Array
from pdr_est.report.plots import figure as svg
from pdr_est.report.plots.finding_marks import draw_findings
from pdr_est.report.plots.floor_plan import draw_floor_plan
from pdr_est.report.plots.track_line import draw_device_line, draw_mode_bands, draw_mode_line
from pdr_est.types.floor_plan import FloorPlan
from pdr_est.types.measurements import PositionFix
from pdr_est.types.region import ellipses_of_poses
from pdr_est.types.track import Track

ELLIPSES = 28  # about as many in all at most: more hide the track
DENSE_POINTS = 200  # truth with more points is a line without markers
BOTTOM_IN, TOP_IN = 0.72, 0.12
SMALLEST_SPAN_M = 4.0


@dataclass(frozen=True)
class MapWindow:
    """Part of the map that is drawn.

    Attributes
    ----------
    west, east, south, north : float
        Edges in the frame of the track, m.
    height_in : float
        Height of the axes, inches.
    """

    west: float
    east: float
    south: float
    north: float
    height_in: float

    @property
    def width(self) -> float:
        """Return the width of the map, m."""
        return self.east - self.west


def plot_track(
    track: Track,
    fixes: tuple[PositionFix, ...] = (),
    truth_m: Array | None = None,
    in_map_frame: bool = True,
    plan: FloorPlan | None = None,
) -> Figure:
    """Draw the track of every device.

    The line of a single device has the colours of the carrying modes. Several devices have a colour each, and the
    modes are bands under their lines. Doubtful findings of the track are marked where they are.

    Parameters
    ----------
    track : Track
        Track of one device or several.
    fixes : tuple of PositionFix
        Fixes to mark.
    truth_m : Array or None
        True positions (k, 2), m, in the same frame as the track.
    in_map_frame : bool
        Label the axes east and north; otherwise x and y.
    plan : FloorPlan or None
        Floor plan to draw below, as far as it reaches into the picture, in the same frame as the track.
    """
    tracks = [track.of_device(name) for name in track.devices]
    shown = [
        ellipses_of_poses(one.position_m, one.covariance_m2, one.region).of_poses(
            select_ellipses(one, ELLIPSES // len(tracks))
        )
        for one in tracks
    ]
    window = _window(tracks, shown, fixes, truth_m)
    figure, axes = new_map(window)
    if plan is not None:
        draw_floor_plan(axes, plan)
    alone = len(tracks) == 1
    draw_findings(axes, track)
    for number, ellipses in enumerate(shown):
        colour = svg.MUTED if alone else svg.device_colour(number)
        for centre_m, covariance_m2 in ellipses:
            _ellipse(axes, centre_m, covariance_m2, colour)
    if truth_m is not None and len(truth_m):
        _truth(axes, truth_m)
    _lines(axes, tracks, 0.022 * window.width)
    _fixes(axes, fixes)
    for number, one in enumerate(tracks):
        _ends(axes, one, svg.INK if alone else svg.device_colour(number))
    svg.label_axes(axes, *(("east (m)", "north (m)") if in_map_frame else ("x (m)", "y (m)")))
    draw_scale_bar(axes, window)
    return figure


def select_ellipses(track: Track, count: int) -> list[int]:
    """Choose the poses of one device whose ellipses are drawn.

    They are at most about `count`, wider apart where they are large. The last pose is always among them; poses
    without a finite, visible covariance never are.
    """
    radius = radius95_m(track.covariance_m2)
    legs = np.nan_to_num(np.linalg.norm(np.diff(track.position_m, axis=0), axis=1))
    way = np.concatenate([[0.0], np.cumsum(legs)])
    spacing = way[-1] / max(count, 1)
    visible = np.flatnonzero(np.isfinite(radius) & (radius > 0.0))
    if not len(visible):
        return []
    last = int(visible[-1])
    chosen = [last]
    for i in visible[::-1]:  # from the end, so that the last pose is one of an even row
        apart = way[chosen[-1]] - way[i]
        if apart >= max(spacing, 0.5 * min(radius[chosen[-1]], radius[i], way[-1] / 8.0)):
            chosen.append(int(i))
    return chosen[::-1]


def _window(
    tracks: list[Track], shown: list[list[tuple[Array, Array]]], fixes: tuple[PositionFix, ...], truth_m: Array | None
) -> MapWindow:
    """Find the part of the map that holds everything.

    Ellipses may widen the view by half at most, so that the track stays readable.
    """
    points = [track.position_m for track in tracks] + [fix.position_m[None] for fix in fixes]
    if truth_m is not None:
        points.append(truth_m)
    cloud = np.concatenate(points)
    cloud = cloud[np.isfinite(cloud).all(axis=1)]
    low, high = (cloud.min(axis=0), cloud.max(axis=0)) if len(cloud) else (np.zeros(2), np.zeros(2))
    room = max(0.25 * float((high - low).max()), SMALLEST_SPAN_M / 2.0)
    wide_low, wide_high = low.copy(), high.copy()
    for centre_m, covariance_m2 in (one for ellipses in shown for one in ellipses):
        reach = np.sqrt(CHI2_95_2D * np.diagonal(covariance_m2))
        wide_low = np.minimum(wide_low, centre_m - reach)
        wide_high = np.maximum(wide_high, centre_m + reach)
    low, high = np.maximum(wide_low, low - room), np.minimum(wide_high, high + room)
    return fitted_window((low + high) / 2.0, np.maximum((high - low) * 1.08, SMALLEST_SPAN_M), 0.8)


def fitted_window(middle_m: Array, span_m: Array, tallest: float) -> MapWindow:
    """Fit a window as wide as the page around a part of the map.

    Parameters
    ----------
    middle_m, span_m
        (2,) middle and size of the part, east and north, m.
    tallest
        Largest height over the width.
    """
    width_in = svg.WIDTH_IN - svg.LEFT_IN - svg.RIGHT_IN
    height_in = width_in * float(np.clip(span_m[1] / span_m[0], 0.3, tallest))
    metres_per_inch = max(span_m[0] / width_in, span_m[1] / height_in)
    half = 0.5 * metres_per_inch * np.array([width_in, height_in])
    (west, south), (east, north) = middle_m - half, middle_m + half
    return MapWindow(float(west), float(east), float(south), float(north), height_in)


def new_map(window: MapWindow) -> tuple[Figure, Axes]:
    """Make a figure with equal axes that show a window."""
    figure = svg.new_figure(BOTTOM_IN + window.height_in + TOP_IN)
    axes = svg.add_axes(figure, BOTTOM_IN, window.height_in)
    axes.set_xlim(window.west, window.east)
    axes.set_ylim(window.south, window.north)
    axes.set_aspect("equal")
    step = svg.nice_step(window.width, 9)
    axes.xaxis.set_major_locator(MultipleLocator(step))
    axes.yaxis.set_major_locator(MultipleLocator(step))
    return figure, axes


def _ellipse(axes: Axes, centre: Array, covariance: Array, colour: str) -> None:
    """Draw the 95 % ellipse of a normal distribution."""
    variances, directions = np.linalg.eigh(covariance)
    short, long = 2.0 * np.sqrt(CHI2_95_2D * np.maximum(variances, 0.0))
    angle = np.degrees(np.arctan2(directions[1, 1], directions[0, 1]))
    for style in ({"facecolor": colour, "alpha": 0.06}, {"facecolor": "none", "edgecolor": colour, "alpha": 0.45}):
        axes.add_patch(Ellipse((centre[0], centre[1]), long, short, angle=angle, linewidth=0.7, **style))


def _truth(axes: Axes, truth_m: Array) -> None:
    dense = len(truth_m) > DENSE_POINTS
    axes.plot(*truth_m.T, color=svg.MUTED, linewidth=1.0, dashes=(4, 2.5))
    if not dense:
        axes.plot(*truth_m.T, "o", color=svg.PAPER, markeredgecolor=svg.MUTED, markersize=4.0, markeredgewidth=1.0)


def _lines(axes: Axes, tracks: list[Track], arrow_m: float) -> None:
    if len(tracks) == 1:
        draw_mode_line(axes, tracks[0], arrow_m)
        return
    for one in tracks:
        draw_mode_bands(axes, one)
    for number, one in enumerate(tracks):
        draw_device_line(axes, one, svg.device_colour(number), arrow_m)


def _fixes(axes: Axes, fixes: tuple[PositionFix, ...]) -> None:
    if fixes:
        positions = np.array([fix.position_m for fix in fixes])
        axes.plot(
            *positions.T, "D", color=svg.FIX, markeredgecolor=svg.PAPER, markersize=5.5, markeredgewidth=0.8, zorder=3
        )


def _ends(axes: Axes, track: Track, colour: str) -> None:
    """Mark the start by a large open circle and the end by a small full square: both show when they coincide."""
    start, end = track.position_m[0], track.position_m[-1]
    axes.plot(*start, "o", color=svg.PAPER, markeredgecolor=colour, markersize=10.0, markeredgewidth=2.0, zorder=4)
    if len(track) > 1:
        axes.plot(*end, "s", color=colour, markeredgecolor=svg.PAPER, markersize=6.0, markeredgewidth=0.8, zorder=5)


def draw_scale_bar(axes: Axes, window: MapWindow) -> None:
    """Draw a bar of round length below the axes, where it cannot hide anything."""
    length = svg.nice_step(window.width, 9)
    below = -0.44 / window.height_in
    frame = axes.get_xaxis_transform()
    begin, end = window.east - length, window.east
    axes.plot([begin, end], [below, below], color=svg.INK, linewidth=2.0, transform=frame, clip_on=False)
    text = f"{length:g} m"
    axes.text(
        (begin + end) / 2,
        below - 0.06 / window.height_in,
        text,
        color=svg.INK,
        ha="center",
        va="top",
        transform=frame,
    )
