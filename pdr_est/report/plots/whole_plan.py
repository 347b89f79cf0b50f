"""Picture of a whole floor plan, and of the places on it where a walk may have been."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle
from matplotlib.ticker import MultipleLocator

from pdr_est.report.plots import figure as svg
from pdr_est.report.plots.floor_plan import draw_floor_plan
from pdr_est.report.plots.track import BOTTOM_IN, TOP_IN, MapWindow, draw_scale_bar
from pdr_est.types.floor_plan import FloorPlan
from pdr_est.types.on_plan.places import PlaceMode, PlaceSearch

_LEAST_M = 1.0  # radius of a circle


def plot_plan(plan: FloorPlan, start_m: tuple[float, float] | None = None) -> Figure:
    """Draw a plan with axes in metres and a bar of scale."""
    west, south, east, north = plan.bounds_m
    room_m = 0.04 * max(east - west, north - south)
    width_in = svg.WIDTH_IN - svg.LEFT_IN - svg.RIGHT_IN
    span = np.array([east - west, north - south]) + 2.0 * room_m
    height_in = width_in * float(np.clip(span[1] / span[0], 0.3, 1.2))
    metres_per_inch = max(span[0] / width_in, span[1] / height_in)
    half = 0.5 * metres_per_inch * np.array([width_in, height_in])
    (low_x, low_y), (high_x, high_y) = (
        np.array([east + west, north + south]) / 2.0 - half,
        np.array([east + west, north + south]) / 2.0 + half,
    )
    window = MapWindow(float(low_x), float(high_x), float(low_y), float(high_y), height_in)
    figure = svg.new_figure(BOTTOM_IN + height_in + TOP_IN)
    axes = svg.add_axes(figure, BOTTOM_IN, height_in)
    axes.set_xlim(window.west, window.east)
    axes.set_ylim(window.south, window.north)
    axes.set_aspect("equal")
    step = svg.nice_step(window.width, 9)
    axes.xaxis.set_major_locator(MultipleLocator(step))
    axes.yaxis.set_major_locator(MultipleLocator(step))
    draw_floor_plan(axes, plan)
    if start_m is not None:
        axes.plot(*start_m, "o", color=svg.PAPER, markeredgecolor=svg.INK, markersize=10.0, markeredgewidth=2.0)
    svg.label_axes(axes, "east (m)", "north (m)")
    draw_scale_bar(axes, window)
    return figure


def plot_places(plan: FloorPlan, search: PlaceSearch) -> Figure:
    """Draw the places where a walk may have begun and ended, as circles of two standard deviations."""
    figure = plot_plan(plan)
    axes = figure.axes[0]
    for mode in search.start.modes:
        _circle(axes, mode, svg.MUTED, 0.0, "--")
    for mode in search.end.modes:
        _circle(axes, mode, svg.device_colour(0), 0.1 + 0.5 * mode.probability, "-")
        axes.annotate(
            f"{mode.probability:.0%}".replace("%", " %"),
            mode.position_m,
            ha="center",
            va="center",
            fontsize=8.0,
            color=svg.INK,
        )
    return figure


def _circle(axes: Axes, mode: PlaceMode, colour: str, alpha: float, line: str) -> None:
    radius_m = max(2.0 * mode.sigma_m, _LEAST_M)
    axes.add_patch(Circle(mode.position_m, radius_m, facecolor=colour, edgecolor="none", alpha=alpha))
    axes.add_patch(Circle(mode.position_m, radius_m, fill=False, edgecolor=colour, linestyle=line, linewidth=1.2))
