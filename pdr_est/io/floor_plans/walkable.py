"""Compute the walkable areas of a drawn floor: walkable pieces without the closed ones."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from pdr_est.errors import FloorPlanError
from pdr_est.frames import Array
from pdr_est.io.floor_plans.shapes import DrawnFloor, DrawnPolygon
from pdr_est.types.floor_plan import WalkableArea

LEAST_AREA_M2 = 0.25
"""Smallest piece of floor that is kept, m²: as much as a standing person covers (ours). Drawings of neighbouring
shops seldom meet exactly, and leave slivers between them."""

NARROWEST_M = 0.3
"""Width of the narrowest passage, m: the depth of a person who goes sideways (ours). Narrower slits are gaps between
pieces that were drawn apart."""

_SIMPLER_BY_M = 0.01  # corners that move an edge by less are left out; no drawing is that exact
_INSIDE = 0.5  # share of a polygon inside of others that makes it one of their holes


def walkable_areas(drawn: DrawnFloor, place: str, repair: bool = False) -> tuple[tuple[WalkableArea, ...], int]:
    """Cut the closed pieces out of the walkable ones.

    Parameters
    ----------
    drawn
        The drawing, in metres.
    place
        What to call the plan in messages.
    repair
        True to divide an outline that crosses itself at the crossings instead of refusing it.

    Returns
    -------
    areas : tuple of WalkableArea
        Pieces that do not touch each other, the largest first; outlines run counter-clockwise, holes clockwise.
    repaired : int
        Number of outlines that crossed themselves.

    Raises
    ------
    FloorPlanError
        For a polygon that crosses itself, for a plan without floor, and where shapely is not installed.
    """
    shapely = _library(place)
    valid, repaired = _checked(shapely, place, repair)
    floor, closed = list(map(valid, drawn.floor)), list(map(valid, drawn.closed))
    more_floor, more_closed = _by_nesting(shapely, list(map(valid, drawn.undecided)), floor)
    whole = shapely.union_all([*floor, *more_floor])
    free = _without_slits(shapely, shapely.difference(whole, shapely.union_all([*closed, *more_closed])))
    pieces = [one for one in _polygons(shapely, shapely.simplify(free, _SIMPLER_BY_M)) if one.area >= LEAST_AREA_M2]
    if not pieces:
        raise FloorPlanError(
            f"{place}: no walkable floor: of {len(drawn.floor) + len(drawn.undecided)} pieces of floor nothing of "
            f"{LEAST_AREA_M2} m² is left without the closed ones: give a polygon of the property kind = floor, in "
            "metres or degrees"
        )
    pieces.sort(key=lambda one: -one.area)
    return tuple(_area(shapely.orient_polygons(one)) for one in pieces), len(repaired)


def _library(place: str) -> Any:
    try:
        import shapely
    except ImportError as error:
        raise FloorPlanError(f"{place}: floor plans need shapely: `pip install pdr-est[map]`") from error
    return shapely


def _checked(shapely: Any, place: str, repair: bool) -> tuple[Callable[[DrawnPolygon], Any], list[str]]:
    """Return a function that makes a valid polygon of shapely, and the list of names that it fills with repairs."""
    repaired: list[str] = []

    def valid(drawn: DrawnPolygon) -> Any:
        polygon = shapely.Polygon(drawn.rings[0], drawn.rings[1:])
        if polygon.is_valid:
            return polygon
        if repair:
            repaired.append(drawn.name)
            return shapely.union_all(_polygons(shapely, shapely.make_valid(polygon)))  # without lines and points
        raise FloorPlanError(
            f"{place}, {drawn.name}: {_fault(shapely.is_valid_reason(polygon))}: draw its corners in their order "
            "along the outline, and holes inside of it"
        )

    return valid, repaired


def _fault(reason: str) -> str:
    """Put a fault of a polygon into words; shapely gives it as `Self-intersection[3.5 2.0]`."""
    kind, _, where = reason.partition("[")
    words = {
        "Self-intersection": "the outline crosses itself",
        "Ring Self-intersection": "the outline touches itself",
    }
    at = f" at ({', '.join(where.rstrip(']').split())})" if where else ""
    return words.get(kind, f"is no polygon ({kind})") + at


def _by_nesting(shapely: Any, undecided: Sequence[Any], floor: Sequence[Any]) -> tuple[list[Any], list[Any]]:
    """Divide polygons into the outermost ones, and those that lie for the most part inside of larger ones."""
    pieces = [*floor, *sorted(undecided, key=lambda polygon: -polygon.area)]
    near = shapely.STRtree(pieces)  # a plan may have thousands of rooms
    outermost = [True] * len(floor) + [False] * len(undecided)
    for number, one in enumerate(pieces[len(floor) :], start=len(floor)):
        around = [pieces[k] for k in near.query(one).tolist() if outermost[k]]
        inside = shapely.intersection(one, around[0] if len(around) == 1 else shapely.union_all(around))
        outermost[number] = inside.area <= _INSIDE * one.area
    found = list(zip(pieces, outermost, strict=True))[len(floor) :]
    return [one for one, outer in found if outer], [one for one, outer in found if not outer]


def _without_slits(shapely: Any, free: Any) -> Any:
    """Take off what is narrower than a passage: shrink the floor, and let what is left grow back."""
    shrunk = shapely.buffer(free, -NARROWEST_M / 2.0, join_style="mitre")
    grown = shapely.buffer(shrunk, NARROWEST_M / 2.0, join_style="mitre")
    return shapely.intersection(grown, free)


def _polygons(shapely: Any, shape: Any) -> list[Any]:
    """List the polygons of a shape of any kind, also of collections in it."""
    parts = shapely.get_parts(shapely.get_parts(shape)).tolist()
    return [one for one in parts if one.geom_type == "Polygon"]


def _area(polygon: Any) -> WalkableArea:
    return WalkableArea(_corners(polygon.exterior), tuple(_corners(hole) for hole in polygon.interiors))


def _corners(ring: Any) -> Array:
    return np.array(ring.coords, dtype=np.float64)[:-1, :2]


def wall_segments(lines: Sequence[Array]) -> Array:
    """Divide lines, each (n, 2), into straight walls (k, 2, 2), m."""
    walls = [np.stack([line[:-1], line[1:]], axis=1) for line in lines]
    return np.concatenate(walls) if walls else np.empty((0, 2, 2))
