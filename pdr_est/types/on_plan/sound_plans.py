"""Checks of floor plans that a user made in Python, with errors that name plan, place, value and remedy."""

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from pdr_est.errors import FloorPlanError
from pdr_est.frames import Array, GeoOrigin
from pdr_est.types.floor_plan import BuildingPlan, FloorPlan, PresentFloor, WalkableArea

LARGEST_SIGMA_DRAWING_M = 10.0
"""Largest standard deviation of a drawing, m (ours): with walls that may be farther off, a plan tells nothing."""

_LARGEST_M = 100_000.0  # extent of a plan: no building is as large, and longer walls do not fit into the memory
_SAME_ORIGIN_DEG = 1e-6  # 0.1 m


def require_sound_plan(plan: FloorPlan | BuildingPlan) -> None:
    """Raise FloorPlanError for plans whose arrays or floors cannot be used, and for floors in different frames."""
    if isinstance(plan, FloorPlan):
        _require_sound_floor(plan)
        return
    place = f"building plan {plan.name}"
    if not plan.plans:
        raise FloorPlanError(f"{place}: has no plans: give at least one")
    for one in plan.plans:
        if not isinstance(one, FloorPlan):
            raise FloorPlanError(f"{place}: plans hold a {type(one).__name__}: give a FloorPlan for each floor")
        _require_sound_floor(one)
        if not same_origin(one.origin, plan.origin):
            raise FloorPlanError(
                f"{place}: its floors have different origins on the Earth: read them together "
                "(pdr_est.read_building_plan), or with one origin"
            )
    numbers = list(plan.numbers)
    if len(numbers) != len(plan.plans) or sorted(set(numbers)) != numbers:
        raise FloorPlanError(
            f"{place}: numbers = {numbers} of {len(plan.plans)} plans: give a number for each, rising"
        )
    if plan.start is not None and plan.start not in numbers:
        raise FloorPlanError(f"{place}: start = {plan.start!r} is none of its floors {numbers}: choose one of them")


def require_sound_floors(floors: Sequence[PresentFloor]) -> None:
    """Raise FloorPlanError for floors that are not in order of time, and for plans that cannot be used."""
    for number, one in enumerate(floors):
        if one.plan is not None:
            require_sound_plan(one.plan)
        if np.isnan(one.time_s):
            raise FloorPlanError(f"plan[{number}]: time_s = {one.time_s}: give the time from which on it counts")
        if not 0.0 < one.probability <= 1.0:
            raise FloorPlanError(
                f"plan[{number}]: probability = {one.probability}: give one above 0 and up to 1, and None as plan "
                "where none counts"
            )
    for number, (before, one) in enumerate(pairwise(floors), start=1):
        if not before.time_s < one.time_s:
            raise FloorPlanError(
                f"plan[{number}]: time_s = {one.time_s} comes after {before.time_s}: give the floors in order of time"
            )


def same_origin(first: GeoOrigin | None, second: GeoOrigin | None) -> bool:
    """Tell whether two map frames have the same place on the Earth, or both none."""
    if first is None or second is None:
        return first is second
    latitude_deg = first.latitude_deg - second.latitude_deg
    return max(abs(latitude_deg), abs(first.longitude_deg - second.longitude_deg)) <= _SAME_ORIGIN_DEG


def _require_sound_floor(plan: FloorPlan) -> None:
    place = f"plan {plan.name}"
    if not plan.areas:
        raise FloorPlanError(f"{place}: has no walkable area: give it one, or leave the plan out")
    for number, area in enumerate(plan.areas):
        if not isinstance(area, WalkableArea):
            raise FloorPlanError(f"{place}: areas[{number}] is a {type(area).__name__}: give a WalkableArea")
        rings = {"outline_m": area.outline_m} | {f"holes_m[{k}]": hole for k, hole in enumerate(area.holes_m)}
        for name, ring in rings.items():
            _require_ring(ring, f"{place}: areas[{number}].{name}")
    walls_m = _as_numbers(plan.walls_m, f"{place}: walls_m")
    if walls_m.size and walls_m.shape[1:] != (2, 2):
        raise FloorPlanError(f"{place}: walls_m has shape {walls_m.shape}: give begin and end of each, (n, 2, 2)")
    extent_m = float(np.ptp(plan.barriers_m, axis=(0, 1)).max())
    if extent_m > _LARGEST_M:
        raise FloorPlanError(f"{place}: is {extent_m / 1000.0:.4g} km long: give areas and walls in metres")
    if not plan.area_m2 > 0.0:
        raise FloorPlanError(f"{place}: has a walkable area of {plan.area_m2:.4g} m²: correct outlines and holes")
    if not isinstance(plan.sigma_m, int | float) or not 0.0 <= plan.sigma_m <= LARGEST_SIGMA_DRAWING_M:
        raise FloorPlanError(
            f"{place}: sigma_m = {plan.sigma_m!r}: give a number of metres up to {LARGEST_SIGMA_DRAWING_M:g}"
        )


def _require_ring(ring: Any, place: str) -> None:
    corners = _as_numbers(ring, place)
    if corners.ndim != 2 or corners.shape[1] != 2 or len(corners) < 3:
        raise FloorPlanError(f"{place} has shape {corners.shape}: give at least 3 corners as an array (n, 2)")


def _as_numbers(values: Any, place: str) -> Array:
    if not isinstance(values, np.ndarray):
        raise FloorPlanError(f"{place} is a {type(values).__name__}: give a numpy array")
    try:
        found = values.astype(np.float64)
    except (TypeError, ValueError) as error:
        raise FloorPlanError(f"{place} holds no numbers ({error}): correct it") from error
    bad = np.argwhere(~np.isfinite(found))
    if len(bad):
        index = ", ".join(map(str, bad[0].tolist()))
        raise FloorPlanError(f"{place}[{index}] is {found[tuple(bad[0])]}: correct it")
    return found
