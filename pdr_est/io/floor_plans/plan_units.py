"""Bring a drawing into the map frame: find out whether its coordinates are degrees, and convert them to metres."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from pdr_est.errors import FloorPlanError
from pdr_est.frames import Array, GeoOrigin
from pdr_est.io.conversion.gnss import east_north
from pdr_est.io.floor_plans.shapes import DrawnFloor, DrawnPolygon
from pdr_est.types.on_plan.sound_plans import LARGEST_SIGMA_DRAWING_M

_DEGREES_OF_A_SITE = 0.1  # 11 km along a meridian: no building is longer, and none is only 0.1 m long
_MOST_M = 50_000.0  # from the origin, which belongs near the walk
_LONGEST_BUILDING_M = 3_000.0  # terminals of airports reach 2 km (ours)


def looks_like_degrees(coordinates: Array) -> bool:
    """Tell whether coordinates (n, 2) can only be longitudes and latitudes, because all of them are within 0.1°."""
    return float(np.ptp(coordinates, axis=0).max()) < _DEGREES_OF_A_SITE


def south_west(coordinates_deg: Array) -> GeoOrigin:
    """Return the south-western corner of longitudes and latitudes (n, 2), degrees, as an origin."""
    longitude, latitude = coordinates_deg.min(axis=0)
    return GeoOrigin(float(latitude), float(longitude))


def metres_from_degrees(drawn: DrawnFloor, origin: GeoOrigin) -> DrawnFloor:
    """Convert a drawing in degrees to metres east and north of an origin."""
    return _mapped(drawn, lambda degrees: east_north(degrees[:, 1], degrees[:, 0], origin))


def require_degrees(coordinates: Array, place: str) -> None:
    """Raise FloorPlanError for coordinates (n, 2) that are no longitudes and latitudes."""
    if (np.abs(coordinates) > (180.0, 90.0)).any():
        x, y = coordinates[np.argmax((np.abs(coordinates) > (180.0, 90.0)).any(axis=1))]
        raise FloorPlanError(
            f'{place}: longitude {x:g}, latitude {y:g} is not on the Earth: write "coordinate_unit": "metre" if '
            "these are metres, and the longitude first if not"
        )


def require_metres(coordinates: Array, place: str) -> None:
    """Raise FloorPlanError for coordinates (n, 2) that are said to be metres, and are degrees."""
    width, height = np.ptp(coordinates, axis=0)
    if looks_like_degrees(coordinates):
        raise FloorPlanError(
            f"{place}: is said to be in metres, but is {width:g} wide and {height:g} high: these look like degrees; "
            'write "coordinate_unit": "degree"'
        )


def require_near(coordinates_m: Array, place: str) -> None:
    """Raise FloorPlanError for coordinates (n, 2), m, that are far away from the origin of the map frame."""
    farthest_m = float(np.abs(coordinates_m).max())
    if farthest_m > _MOST_M:
        raise FloorPlanError(
            f"{place}: reaches {farthest_m / 1000.0:.4g} km from the origin of the map frame: give the plan of the "
            "place of the walk, in degrees with the longitude first, or in metres from an origin near it (projected "
            "coordinates count from far away)"
        )


def doubts_of_size(coordinates_m: Array) -> Iterator[str]:
    """Tell in words if coordinates (n, 2), m, are wider than any building."""
    longest_m = float(np.ptp(coordinates_m, axis=0).max())
    if longest_m > _LONGEST_BUILDING_M:
        yield (
            f"the plan is {longest_m / 1000.0:.3g} km long, and no building is: if its coordinates are millimetres, "
            "centimetres or feet, convert them to metres"
        )


def required_sigma_m(sigma_m: Any, place: str) -> float:
    """Return the standard deviation of a drawing, m; raise FloorPlanError for something else."""
    number = isinstance(sigma_m, int | float | np.floating) and not isinstance(sigma_m, bool)
    if not number or not 0.0 < sigma_m <= LARGEST_SIGMA_DRAWING_M:
        raise FloorPlanError(
            f"{place}: sigma_m = {repr(sigma_m)[:40]}: give a positive number of metres up to "
            f"{LARGEST_SIGMA_DRAWING_M:g}"
        )
    return float(sigma_m)


def stretched_to(drawn: DrawnFloor, corner: Array, scale: Array) -> DrawnFloor:
    """Move a corner (2,) to the origin, and multiply both coordinates by a scale (2,) of their own."""
    return _mapped(drawn, lambda values: (values - corner) * scale)


def _mapped(drawn: DrawnFloor, convert: Callable[[Array], Array]) -> DrawnFloor:
    def polygons(some: list[DrawnPolygon]) -> list[DrawnPolygon]:
        return [replace(one, rings=tuple(convert(ring) for ring in one.rings)) for one in some]

    return DrawnFloor(
        polygons(drawn.floor), polygons(drawn.closed), polygons(drawn.undecided), [convert(w) for w in drawn.walls]
    )
