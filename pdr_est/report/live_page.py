"""The live page: one document with everything inside, and the policy that allows its own scripts only."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from pdr_est.report.background.kinds import plan_background
from pdr_est.report.background.placement import MapPlacement
from pdr_est.report.inline_assets import TRACK_MAP_SCRIPTS, inline_assets, inline_json
from pdr_est.report.page_templates import template_environment
from pdr_est.types.floor_plan import BuildingPlan, FloorPlan

_SCRIPTS = (
    "packed_columns.js",
    "map_background.js",
    "dom.js",
    "live_link.js",
    "live_phone.js",
    "live_track.js",
    "live_page.js",
)
_NO_FRAMES = "frame-src 'self'; frame-ancestors 'none'; base-uri 'none'; form-action 'none'"


def render_live_page(modes: Sequence[str], plan: FloorPlan | BuildingPlan | None = None) -> tuple[str, str]:
    """Render the page.

    Parameters
    ----------
    modes
        Names of the carrying modes by their number.
    plan
        Floor plan that is drawn below the track, or those of several floors, of which the present one is drawn.

    Returns
    -------
    tuple of str
        HTML, and the value of the header Content-Security-Policy, by which the page runs its own scripts, connects to
        its own server and shows the report of that server, and nothing else.
    """
    assets = inline_assets(["leaflet"], [*TRACK_MAP_SCRIPTS, *_SCRIPTS])
    template = template_environment().get_template("live.html.j2")
    page = template.render(assets=assets, modes=inline_json(list(modes)), plans=inline_json(_plans(plan)))
    policy = assets.policy(connect=["'self'"])
    return page, f"{policy}; {_NO_FRAMES}"


def _plans(plan: FloorPlan | BuildingPlan | None) -> list[dict[str, Any]]:
    """Describe the plan of each floor, and its number counted from the floor at the start: None for a single plan."""
    if plan is None:
        return []
    numbers: list[int | None] = [None]
    if isinstance(plan, BuildingPlan):
        numbers, drawn = [number - (plan.start or 0) for number in plan.numbers], plan.plans
    else:
        drawn = (plan,)
    here = MapPlacement(np.zeros(2), None, "")
    return [
        {"floor": number, "name": one.floor, "plan": plan_background(one).placed(here, np.zeros(2), np.zeros(2))}
        for number, one in zip(numbers, drawn, strict=True)
    ]
