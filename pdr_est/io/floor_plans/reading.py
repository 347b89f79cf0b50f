"""Read floor plans from a file or folder, plain or gzipped."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from pdr_est.errors import FloorPlanError, RecordingError
from pdr_est.frames import Array, GeoOrigin
from pdr_est.io.floor_plans.competition_map import INFO, MAP, competition_floor
from pdr_est.io.floor_plans.geojson_plan import parse_geojson, read_geojson_plan
from pdr_est.io.floor_plans.picture import PICTURE_BEGINS
from pdr_est.io.floor_plans.plan_units import (
    doubts_of_size,
    looks_like_degrees,
    metres_from_degrees,
    require_degrees,
    require_metres,
    require_near,
    required_sigma_m,
    south_west,
)
from pdr_est.io.floor_plans.shapes import DrawnFloor
from pdr_est.io.floor_plans.walkable import walkable_areas, wall_segments
from pdr_est.io.text.container import Source
from pdr_est.io.text.members import member_stem
from pdr_est.types.floor_plan import FloorPlan

SIGMA_DRAWING_M = 0.2
"""Standard deviation of a drawing that states none, m: the thickness of a wall that is drawn as a line (ours)."""

_SUFFIXES = (".geojson", ".json")


def read_floor_plan(
    path: str | Path, floor: str = "", origin: GeoOrigin | None = None, sigma_m: float | None = None
) -> FloorPlan:
    """Read the plan of one floor.

    Parameters
    ----------
    path
        A GeoJSON file in degrees or local metres, or one floor of the Indoor Location Competition 2.0: its
        `geojson_map.json` with `floor_info.json` beside it, or the folder of both.
    floor
        Name of the floor; may be empty if the plan shows only one.
    origin
        Origin of the map frame, for a plan in degrees; by default the south-western corner of the plan.
    sigma_m
        Standard deviation of the drawing, m; by default what the file states, else `SIGMA_DRAWING_M`.

    Raises
    ------
    FloorPlanError
        For a plan that cannot be used, and a floor that it does not show or that is not chosen.
    """
    plans = read_floor_plans(path, origin, sigma_m)
    names = ", ".join(plan.floor for plan in plans)
    if not floor and len(plans) > 1:
        raise FloorPlanError(f"{path}: shows the floors {names}: choose one of them (--floor NAME)")
    if floor and not plans[0].floor:
        raise FloorPlanError(f"{path}: its floor has no name, so that {floor!r} cannot be found: leave out the floor")
    found = [plan for plan in plans if floor in ("", plan.floor)]
    if not found:
        raise FloorPlanError(f"{path}: has no floor {floor!r}, only {names}: choose one of these, or another file")
    return found[0]


def read_floor_plans(
    path: str | Path, origin: GeoOrigin | None = None, sigma_m: float | None = None
) -> tuple[FloorPlan, ...]:
    """Read the plans of all floors of a file or folder, in the order of the file; see `read_floor_plan`.

    Raises
    ------
    FloorPlanError
        For a plan that cannot be used.
    """
    if sigma_m is not None:
        sigma_m = required_sigma_m(sigma_m, str(path))
    if origin is not None and not isinstance(origin, GeoOrigin):
        raise FloorPlanError(f"{path}: origin is a {type(origin).__name__}: give a GeoOrigin, or None")
    try:
        source = Source.open(path)
        member = _plan_member(source)
        data, place = source.read(member), source.place(member)
        beside = source.sibling(member, INFO) if Path(member).name == MAP else None
        info = None if beside is None else beside.read(beside.members[0])
    except RecordingError as error:  # of files in general: missing, damaged, unreadable
        raise FloorPlanError(str(error)) from error
    if data.startswith(PICTURE_BEGINS):
        raise FloorPlanError(
            f"{place}: is a picture: make a plan of it first, with `pdr-est plan` and two known points (--point)"
        )
    document = parse_geojson(data, place)
    name = member_stem(member)
    if beside is not None and info is not None:
        floor = source.folder_name(member)
        drawn, notes = competition_floor(document, info, place, beside.place(beside.members[0]))
        return (_plan(drawn, place, floor, floor, None, sigma_m or SIGMA_DRAWING_M, notes, repair=True),)
    if Path(member).name == MAP:
        raise FloorPlanError(
            f"{place}: {INFO} is not beside it, which has width and height: put both into one folder"
        )
    return _of_geojson(document, place, name, origin, sigma_m)


def _plan_member(source: Source) -> str:
    """Choose the plan among the files of a folder or archive."""
    if len(source.members) == 1:
        return source.members[0]
    maps = [one for one in source.members if Path(one).name == MAP]
    found = maps or [one for one in source.members if Path(one).suffix.lower() in _SUFFIXES]
    if len(found) != 1:
        words = ", ".join(found[:5]) if found else f"no file {' or '.join(_SUFFIXES)}"
        raise FloorPlanError(f"{source.path}: holds {words}: give the file of one plan")
    return found[0]


def _of_geojson(
    document: Mapping[str, Any], place: str, name: str, origin: GeoOrigin | None, sigma_m: float | None
) -> tuple[FloorPlan, ...]:
    read = read_geojson_plan(document, place)
    arrays = [array for drawn in read.floors.values() for array in drawn.arrays()]
    if not arrays:
        raise FloorPlanError(f"{place}: has neither polygons nor lines: draw the floor as a polygon")
    coordinates = np.concatenate(arrays)
    known = _origin(coordinates, read.unit, place, origin)
    sigma = sigma_m or read.sigma_m or SIGMA_DRAWING_M
    metric = {
        floor: drawn if known is None else metres_from_degrees(drawn, known) for floor, drawn in read.floors.items()
    }
    all_m = np.concatenate([array for drawn in metric.values() for array in drawn.arrays()])
    require_near(all_m, place)
    notes = tuple(doubts_of_size(all_m))
    return tuple(_plan(drawn, place, name, floor, known, sigma, notes) for floor, drawn in metric.items())


def _origin(coordinates: Array, unit: str | None, place: str, origin: GeoOrigin | None) -> GeoOrigin | None:
    """Return the origin of a plan in degrees; None for one in metres."""
    if unit == "degree" or (unit is None and looks_like_degrees(coordinates)):
        require_degrees(coordinates, place)
        return south_west(coordinates) if origin is None else origin
    require_metres(coordinates, place)
    return None


def _plan(
    drawn: DrawnFloor,
    place: str,
    name: str,
    floor: str,
    origin: GeoOrigin | None,
    sigma_m: float,
    notes: tuple[str, ...] = (),
    repair: bool = False,
) -> FloorPlan:
    """Make the record of a floor; `repair` is for maps that the user cannot correct."""
    where = f"{place}, floor {floor}" if floor else place
    areas, repaired = walkable_areas(drawn, where, repair)
    crossing = (f"{repaired} outlines cross themselves and are divided at the crossings",) if repaired else ()
    return FloorPlan(name, areas, wall_segments(drawn.walls), sigma_m, floor, origin, (*notes, *crossing))
