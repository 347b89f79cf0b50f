"""Write a floor plan as GeoJSON, which `reading` understands and geographic programs show."""

import json
from pathlib import Path
from typing import Any

import numpy as np

from pdr_est.frames import Array
from pdr_est.io.writers.geodesy import DEGREE_DIGITS, longitude_latitude
from pdr_est.output.atomic_output import text_output
from pdr_est.types.floor_plan import FloorPlan


def write_floor_plan(plan: FloorPlan, path: str | Path) -> None:
    """Write the walkable areas as polygons and further walls as lines.

    Coordinates are WGS 84 longitude and latitude for a plan whose place on the Earth is known, else metres east and
    north; the member `coordinate_unit` says which.

    Raises
    ------
    OutputError
        If the file cannot be written.
    """
    floor = {"floor": plan.floor} if plan.floor else {}
    features = [
        _plan_feature(
            "Polygon", [_closed(ring, plan) for ring in (area.outline_m, *area.holes_m)], {"kind": "floor", **floor}
        )
        for area in plan.areas
    ]
    if len(plan.walls_m):
        lines = [_placed(wall, plan).tolist() for wall in plan.walls_m]
        features.append(_plan_feature("MultiLineString", lines, {"kind": "wall", **floor}))
    collection = {
        "type": "FeatureCollection",
        "coordinate_unit": "metre" if plan.origin is None else "degree",
        "sigma_m": plan.sigma_m,
        "features": features,
    }
    with text_output(path) as stream:
        stream.write(json.dumps(collection, ensure_ascii=False, allow_nan=False, separators=(",", ":")))
        stream.write("\n")


def _plan_feature(kind: str, coordinates: Any, properties: dict[str, str]) -> dict[str, Any]:
    return {"type": "Feature", "geometry": {"type": kind, "coordinates": coordinates}, "properties": properties}


def _closed(ring_m: Array, plan: FloorPlan) -> list[list[float]]:
    corners: list[list[float]] = _placed(np.vstack([ring_m, ring_m[:1]]), plan).tolist()
    return corners


def _placed(points_m: Array, plan: FloorPlan) -> Array:
    if plan.origin is None:
        return np.round(points_m, 3)
    return np.round(longitude_latitude(points_m, plan.origin), DEGREE_DIGITS)
