"""The page of a floor plan: one HTML file that needs nothing but a browser."""

from collections.abc import Sequence

import numpy as np
from markupsafe import Markup
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

from pdr_est.report.floor_plans.description import Row
from pdr_est.report.page_templates import template_environment
from pdr_est.report.plots import figure as svg
from pdr_est.report.plots.floor_plan import draw_floor_plan
from pdr_est.report.plots.legend import LegendEntry
from pdr_est.report.plots.track import BOTTOM_IN, TOP_IN, MapWindow, draw_scale_bar
from pdr_est.report.walk.panels import Panel
from pdr_est.types.floor_plan import FloorPlan


def render_plan(plan: FloorPlan, rows: Sequence[Row], start_m: tuple[float, float] | None = None) -> str:
    """Render the page as text.

    Parameters
    ----------
    plan : FloorPlan
        The plan.
    rows : sequence of (str, str)
        Its properties, by `plan_rows`.
    start_m : (float, float) or None
        A position to mark, m.
    """
    legend = [LegendEntry("shade", "muted", "walkable floor")]
    if start_m is not None:
        legend.append(LegendEntry("start", "ink", "position"))
    drawing = Markup(svg.to_svg(plot_plan(plan, start_m), "plan", "Floor plan"))
    panel = Panel("Plan", drawing, tuple(legend))
    title = f"{plan.name}, floor {plan.floor}" if plan.floor and plan.floor != plan.name else plan.name
    return template_environment().get_template("plan.html.j2").render(title=title, rows=rows, panel=panel)


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
