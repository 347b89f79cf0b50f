"""Bring a drawing into the map frame: find out whether its coordinates are degrees, and convert them to metres."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from pdr_est.errors import FloorPlanError
from pdr_est.frames import Array, GeoOrigin
from pdr_est.io.conversion.gnss import east_north
from pdr_est.io.floor_plans.shapes import DrawnFloor, DrawnPolygon

_DEGREES_OF_A_SITE = 0.1  # 11 km along a meridian: no building is longer, and none is only 0.1 m long
_MOST_M = 50_000.0  # from the origin, which belongs near the walk


def looks_like_degrees(coordinates: Array) -> bool:
    """Tell whether coordinates (n, 2) can only be longitudes and latitudes: on the Earth, and all within 0.1°."""
    on_earth = bool((np.abs(coordinates) <= (180.0, 90.0)).all())
    return on_earth and float(np.ptp(coordinates, axis=0).max()) < _DEGREES_OF_A_SITE


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
            f"{place}: reaches {farthest_m / 1000.0:.0f} km from the origin of the map frame: give the plan of the "
            "place of the walk, in degrees, or in metres from an origin near it (projected coordinates count from "
            "far away)"
        )


def stretched_to(drawn: DrawnFloor, corner: Array, scale: Array) -> DrawnFloor:
    """Move a corner (2,) to the origin, and multiply both coordinates by a scale (2,) of their own."""
    return _mapped(drawn, lambda values: (values - corner) * scale)


def _mapped(drawn: DrawnFloor, convert: Callable[[Array], Array]) -> DrawnFloor:
    def polygons(some: list[DrawnPolygon]) -> list[DrawnPolygon]:
        return [replace(one, rings=tuple(convert(ring) for ring in one.rings)) for one in some]

    return DrawnFloor(
        polygons(drawn.floor), polygons(drawn.closed), polygons(drawn.undecided), [convert(w) for w in drawn.walls]
    )
