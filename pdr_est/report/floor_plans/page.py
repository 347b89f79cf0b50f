"""The page of a floor plan: one HTML file that needs nothing but a browser."""

from collections.abc import Sequence

from markupsafe import Markup

from pdr_est.report.floor_plans.description import Row
from pdr_est.report.page_templates import template_environment
from pdr_est.report.plots import figure as svg
from pdr_est.report.plots.legend import LegendEntry
from pdr_est.report.plots.whole_plan import plot_plan
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
