"""Read what a GeoJSON document (RFC 7946) draws of each floor of a building.

Polygons are pieces of floor, lines are walls. The property `kind` of a feature says "floor", "closed" or "wall". A
polygon without it is floor if it is an outermost one, and closed if it lies inside of another. The property
`floor` or `level` names the storey; a feature without it belongs to all of them.
"""

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from pdr_est.errors import FloorPlanError
from pdr_est.frames import Array
from pdr_est.io.floor_plans.plan_units import required_sigma_m
from pdr_est.io.floor_plans.shapes import DrawnFloor, DrawnPolygon
from pdr_est.io.text.geojson import features_of, properties_of, simple_geometries

KINDS = ("floor", "closed", "wall")
"""Values of the property `kind`: walkable, not walkable, and a line or polygon that is a wall."""

_GEOMETRIES = ("Point", "MultiPoint", "LineString", "MultiLineString", "Polygon", "MultiPolygon")
_FLOOR_TITLES = ("floor", "level")
_REMEDY = "give a GeoJSON FeatureCollection with polygons of the floor"


@dataclass(frozen=True)
class GeoJsonPlan:
    """Drawing of a document, floor by floor.

    Attributes
    ----------
    floors
        Name of each floor -> what is drawn of it, in the document's units; one without name if none is named.
    unit
        Member `coordinate_unit` of the document, "metre" or "degree"; None where it does not say.
    sigma_m
        Member `sigma_m`: standard deviation of the drawing, m; None where it does not say.
    """

    floors: Mapping[str, DrawnFloor]
    unit: str | None
    sigma_m: float | None


def parse_geojson(data: bytes, place: str) -> Mapping[str, Any]:
    """Parse a document with features.

    Raises
    ------
    FloorPlanError
        For something else.
    """
    try:
        document = json.loads(data)
    except (ValueError, RecursionError) as error:
        raise FloorPlanError(f"{place}: is no JSON ({error}): {_REMEDY}, or a picture") from error
    features = features_of(document)
    if not features:
        raise FloorPlanError(f"{place}: has no list of features: {_REMEDY}")
    return {**document, "features": features}


def read_geojson_plan(document: Mapping[str, Any], place: str) -> GeoJsonPlan:
    """Collect the drawing of each floor from a document of `parse_geojson`.

    Raises
    ------
    FloorPlanError
        For shapes, kinds and units that cannot be used.
    """
    floors: dict[str, DrawnFloor] = {}
    everywhere = DrawnFloor()
    for number, feature in enumerate(document["features"], start=1):
        properties = properties_of(feature)
        storey = _storey(properties)
        target = everywhere if storey is None else floors.setdefault(storey, DrawnFloor())
        _add(target, feature.get("geometry"), properties.get("kind"), _feature_name(number, properties), place)
    for drawn in floors.values():
        for name in ("floor", "closed", "undecided", "walls"):
            getattr(drawn, name).extend(getattr(everywhere, name))
    return GeoJsonPlan(floors or {"": everywhere}, _unit(document, place), _sigma_m(document, place))


def _feature_name(number: int, properties: Mapping[str, Any]) -> str:
    """Name a feature in messages, such as `feature 3 ("lift")`."""
    title = properties.get("name")
    words = "".join(one for one in title[:40] if one.isprintable()) if isinstance(title, str) else ""
    return f"feature {number}" + (f' ("{words}")' if words else "")


def polygons_of(geometry: Any, name: str, place: str) -> list[DrawnPolygon]:
    """List the polygons of a geometry of a document, if it has any.

    Raises
    ------
    FloorPlanError
        For coordinates that are no rings.
    """
    _require_known(geometry, name, place)
    rings = [_list(content, name, place) for kind, content in simple_geometries(geometry) if kind == "Polygon"]
    return [DrawnPolygon(name, tuple(_ring(ring, name, place) for ring in polygon)) for polygon in rings if polygon]


def _add(drawn: DrawnFloor, geometry: Any, kind: Any, name: str, place: str) -> None:
    """Add a feature to the drawing of its floor; points and empty features are no part of it."""
    if kind is not None and kind not in KINDS:
        raise FloorPlanError(f"{place}, {name}: kind = {kind!r}: is none of {', '.join(KINDS)}: correct it")
    polygons = polygons_of(geometry, name, place)
    lists = {"floor": drawn.floor, "closed": drawn.closed, "wall": drawn.closed, None: drawn.undecided}
    lists[kind].extend(polygons)
    lines = [_points(line, name, place, 2) for part, line in simple_geometries(geometry) if part == "LineString"]
    if lines and kind not in ("wall", None):
        raise FloorPlanError(f"{place}, {name}: a line cannot be {kind}: draw a polygon, or call it a wall")
    drawn.walls.extend(lines)


def _require_known(geometry: Any, name: str, place: str) -> None:
    """Raise FloorPlanError for a geometry that GeoJSON does not have, and for one that is no list of others."""
    if geometry is None:
        return
    kind = geometry.get("type") if isinstance(geometry, dict) else None
    if kind == "GeometryCollection":
        for part in _list(geometry.get("geometries"), name, place):
            _require_known(part, name, place)
    elif kind not in _GEOMETRIES:
        raise FloorPlanError(
            f"{place}, {name}: a geometry of the type {str(kind)[:40]!r}: is none of GeoJSON: export the plan again"
        )
    else:
        _list(geometry.get("coordinates"), name, place)


def _ring(ring: Any, name: str, place: str) -> Array:
    """Return the corners (n, 2) of a ring without the repeated last one."""
    corners = _points(ring, name, place, 3)
    closed = len(corners) > 1 and bool((corners[0] == corners[-1]).all())
    corners = corners[:-1] if closed else corners
    if len(corners) < 3:
        raise FloorPlanError(f"{place}, {name}: a ring of {len(corners)} corners: a polygon needs at least 3")
    return corners


def _points(content: Any, name: str, place: str, least: int) -> Array:
    pairs = _list(content, name, place)
    if len(pairs) < least or not all(isinstance(pair, list) and len(pair) >= 2 for pair in pairs):
        raise FloorPlanError(
            f"{place}, {name}: {str(pairs)[:60]} is no list of at least {least} positions: correct it"
        )
    numbers = [pair[:2] for pair in pairs]
    for pair in numbers:
        if type(pair[0]) not in (float, int) or type(pair[1]) not in (float, int):
            raise FloorPlanError(f"{place}, {name}: {str(pair)[:60]} is no pair of numbers: correct it")
    try:
        points = np.array(numbers, dtype=np.float64)
    except OverflowError:
        points = np.array([np.inf])
    if not np.isfinite(points).all():
        raise FloorPlanError(f"{place}, {name}: a coordinate is not finite: correct it")
    return points


def _list(content: Any, name: str, place: str) -> list[Any]:
    if not isinstance(content, list):
        raise FloorPlanError(f"{place}, {name}: coordinates = {str(content)[:60]}: is no list: export the plan again")
    return content


def _storey(properties: Mapping[str, Any]) -> str | None:
    """Name the floor of a feature; None where it belongs to all."""
    for value in (properties.get(title) for title in _FLOOR_TITLES):
        if isinstance(value, str) and value.strip():
            return " ".join(value.split())
        if isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value):
            return str(int(value)) if value == int(value) else str(value)
    return None


def _unit(document: Mapping[str, Any], place: str) -> str | None:
    unit = document.get("coordinate_unit")
    if unit not in (None, "metre", "degree"):
        raise FloorPlanError(f'{place}: coordinate_unit = {str(unit)[:40]!r}: write "metre" or "degree"')
    return unit


def _sigma_m(document: Mapping[str, Any], place: str) -> float | None:
    sigma_m = document.get("sigma_m")
    return None if sigma_m is None else required_sigma_m(sigma_m, place)
