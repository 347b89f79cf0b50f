"""Picture of a whole floor plan, and of the places on it where a walk may have been."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from pdr_est.report.plots import figure as svg
from pdr_est.report.plots.floor_plan import draw_floor_plan
from pdr_est.report.plots.track import draw_scale_bar, fitted_window, new_map
from pdr_est.types.floor_plan import FloorPlan
from pdr_est.types.on_plan.places import PlaceMode, PlaceSearch

_LEAST_M = 1.0  # radius of a circle


def plot_plan(plan: FloorPlan, start_m: tuple[float, float] | None = None) -> Figure:
    """Draw a plan with axes in metres and a bar of scale."""
    west, south, east, north = plan.bounds_m
    room_m = 0.04 * max(east - west, north - south)
    span_m = np.array([east - west, north - south]) + 2.0 * room_m
    window = fitted_window(np.array([east + west, north + south]) / 2.0, span_m, 1.2)
    figure, axes = new_map(window)
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
