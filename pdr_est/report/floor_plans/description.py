"""Properties of a floor plan in words."""

from math import degrees

import numpy as np

from pdr_est.front_end.heading.whole_walk.wall_directions import wall_directions
from pdr_est.types.floor_plan import FloorPlan

Row = tuple[str, str]


def plan_rows(plan: FloorPlan, start_m: tuple[float, float] | None = None) -> list[Row]:
    """List what there is to know of a plan: labels and values.

    Parameters
    ----------
    plan : FloorPlan
        The plan.
    start_m : (float, float) or None
        A position to judge, m.
    """
    west, south, east, north = plan.bounds_m
    width_m, height_m = east - west, north - south
    share = plan.area_m2 / (width_m * height_m)
    rows = [
        ("plan", plan.name),
        ("floor", plan.floor or "without a name"),
        ("size", f"{width_m:.1f} x {height_m:.1f} m, x {west:.1f} to {east:.1f}, y {south:.1f} to {north:.1f}"),
        ("walkable", f"{plan.area_m2:.0f} m², {100.0 * share:.0f} % of the box around it"),
        ("pieces", _pieces(plan)),
        ("walls", _walls(plan)),
        ("directions of the walls", _directions(plan)),
        ("sigma of the drawing", f"{plan.sigma_m:g} m"),
        ("place on the Earth", _place(plan)),
    ]
    rows += [("note", note) for note in plan.notes]
    return rows if start_m is None else [*rows, ("position", _position(plan, start_m))]


def _pieces(plan: FloorPlan) -> str:
    holes = sum(len(area.holes_m) for area in plan.areas)
    return f"{len(plan.areas)} that do not touch, with {holes} closed pieces inside"


def _walls(plan: FloorPlan) -> str:
    length_m = float(np.linalg.norm(plan.barriers_m[:, 1] - plan.barriers_m[:, 0], axis=1).sum())
    return f"{length_m:.0f} m in {len(plan.barriers_m)} straight pieces"


def _directions(plan: FloorPlan) -> str:
    found = wall_directions(plan)
    if found is None:
        return "none in particular"
    spacing_deg = 360.0 / found.number
    first_deg = degrees(found.direction_rad) % spacing_deg
    angles = ", ".join(f"{first_deg + spacing_deg * k:.0f}°" for k in range(found.number))
    return f"{angles} counter-clockwise from east, followed by {100.0 * found.share:.0f} % of their length"


def _place(plan: FloorPlan) -> str:
    if plan.origin is None:
        return "not known: local metres"
    return f"origin at {plan.origin.latitude_deg:.6f}°, {plan.origin.longitude_deg:.6f}°"


def _position(plan: FloorPlan, start_m: tuple[float, float]) -> str:
    off_m = float(plan.distance_outside_m(np.array([start_m]))[0])
    words = "on the walkable floor" if off_m == 0.0 else f"{off_m:.1f} m off the walkable floor"
    return f"({start_m[0]:g}, {start_m[1]:g}) lies {words}"
