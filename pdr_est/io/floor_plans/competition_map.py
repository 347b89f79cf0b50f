"""Read the map of a floor of the Indoor Location Competition 2.0: `geojson_map.json` beside `floor_info.json`.

The first feature of the map is the floor, the others are the shops and rooms on it. Coordinates are longitude and
latitude, but positions on the floor are metres from the lower left corner of the map: the box around the floor is
stretched to the width and height that `floor_info.json` states.
"""

import json
import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from pdr_est.errors import FloorPlanError
from pdr_est.io.floor_plans.geojson_plan import polygons_of
from pdr_est.io.floor_plans.plan_units import stretched_to
from pdr_est.io.floor_plans.shapes import DrawnFloor

MAP, INFO = "geojson_map.json", "floor_info.json"
"""Names of the two files of a floor."""


def competition_floor(
    document: Mapping[str, Any], info: bytes, place: str, info_place: str
) -> tuple[DrawnFloor, tuple[str, ...]]:
    """Make the drawing of the floor in metres.

    Parameters
    ----------
    document
        Content of the map.
    info
        Content of the other file.
    place, info_place
        What to call the two in messages.

    Returns
    -------
    drawn : DrawnFloor
        The floor, and what stands on it.
    notes : tuple of str
        How many features were left out, which nobody can mend.

    Raises
    ------
    FloorPlanError
        For a map without outline of the floor, and a floor without width or height.
    """
    width_height_m = _size_m(info, info_place)
    first, *others = document["features"]
    outline = polygons_of(first.get("geometry"), "feature 1", place)
    if not outline:
        raise FloorPlanError(
            f"{place}: the first feature is no polygon of the floor: give the map of the competition"
        )
    drawn, left_out = DrawnFloor(floor=outline), 0
    for number, feature in enumerate(others, start=2):
        try:
            drawn.closed += polygons_of(feature.get("geometry"), f"feature {number}", place)
        except FloorPlanError:
            left_out += 1
    notes = (f"{left_out} features are no polygons and are left out",) if left_out else ()
    corners = np.concatenate([ring for one in drawn.floor for ring in one.rings])
    low, extent = corners.min(axis=0), np.ptp(corners, axis=0)
    if (extent <= 0.0).any():
        raise FloorPlanError(f"{place}: the outline of the floor has no area: give the map of the competition")
    return stretched_to(drawn, low, width_height_m / extent), notes


def _size_m(info: bytes, place: str) -> Any:
    """Return width and height (2,), m."""
    try:
        stated = json.loads(info)["map_info"]
        size_m = np.array([float(stated["width"]), float(stated["height"])])
    except (ValueError, KeyError, TypeError, RecursionError) as error:
        raise FloorPlanError(
            f"{place}: has no width and height of the floor in map_info ({error!r}): give the file of the competition"
        ) from error
    if not all(0.0 < one < math.inf for one in size_m.tolist()):
        raise FloorPlanError(f"{place}: width and height {size_m.tolist()} m: both must be positive: correct them")
    return size_m
