"""Read the plans of several floors of a building, from one file, from a file for each floor, or from a folder."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from pdr_est.errors import FloorPlanError
from pdr_est.frames import GeoOrigin
from pdr_est.io.floor_plans.competition_map import MAP
from pdr_est.io.floor_plans.floor_numbers import floor_numbers_of
from pdr_est.io.floor_plans.reading import read_floor_plan, read_floor_plans
from pdr_est.types.floor_plan import BuildingPlan, FloorPlan


def read_building_plan(
    paths: str | Path | Sequence[str | Path],
    start_floor: str = "",
    origin: GeoOrigin | None = None,
    sigma_m: float | None = None,
) -> FloorPlan | BuildingPlan:
    """Read the plans of all floors of a building.

    Parameters
    ----------
    paths
        A file that shows several floors, a file for each floor, or the folder of a site of the Indoor Location
        Competition 2.0 with a folder for each floor. A floor without a name is called like its file. Names such as
        0, -1, F2, B1, ground or first give the order of the floors; if none of them does, it is the order of the
        files, the lowest floor first.
    start_floor
        Name of the floor on which the walk begins; empty where it is not known.
    origin
        Origin of the map frame, for plans in degrees; by default the south-western corner of the first plan.
    sigma_m
        Standard deviation of the drawings, m; by default what each file states.

    Returns
    -------
    FloorPlan or BuildingPlan
        The plan of the only floor, or those of several.

    Raises
    ------
    FloorPlanError
        For plans that cannot be used together, and a floor that they do not show.
    """
    files = [Path(path) for path in ([paths] if isinstance(paths, str | Path) else paths)]
    files = [file for path in files for file in _floors_in(path)]
    plans: list[FloorPlan] = []
    for file in files:
        found = read_floor_plans(file, origin, sigma_m)
        origin = found[0].origin if origin is None else origin
        plans += found
    if not plans:
        raise FloorPlanError("no plan is given: give the file of at least one floor")
    if len(plans) == 1:
        return read_floor_plan(files[0], start_floor, origin, sigma_m) if start_floor else plans[0]
    if len(files) > 1:
        plans = [plan if plan.floor else replace(plan, floor=plan.name) for plan in plans]
    place = ", ".join(map(str, files))
    return _building(plans, place, start_floor)


def _floors_in(path: Path) -> list[Path]:
    """Return the folders of floors in the folder of a site of the competition; any other path as it is."""
    if not path.is_dir() or any(path.glob(f"{MAP}*")):
        return [path]
    return sorted({one.parent for one in path.glob(f"*/{MAP}*")}) or [path]


def _building(plans: Sequence[FloorPlan], place: str, start_floor: str) -> BuildingPlan:
    """Put the floors in order."""
    names = [plan.floor for plan in plans]
    placed = {plan.origin is not None for plan in plans}
    if len(placed) > 1:
        raise FloorPlanError(f"{place}: some plans are in degrees and others in metres: give all of them in one unit")
    numbers = floor_numbers_of(names)
    notes: tuple[str, ...] = ()
    if numbers is None and any(floor_numbers_of([name]) is not None for name in names):
        raise FloorPlanError(
            f"{place}: only some of the floors {', '.join(names)} have a name with a number: call them 0, 1, -1 …"
        )
    if numbers is None:
        numbers = list(range(len(plans)))
        notes = (f"the floors {', '.join(names)} count as given from the lowest to the highest",)
    if len(set(numbers)) < len(numbers):
        raise FloorPlanError(
            f"{place}: two of the floors {', '.join(names)} are the same one: give each floor once, with a name such "
            "as 0, 1, -1"
        )
    order = sorted(range(len(plans)), key=numbers.__getitem__)
    start = next((number for number, name in zip(numbers, names, strict=True) if name == start_floor), None)
    if start_floor and start is None:
        raise FloorPlanError(
            f"{place}: has no floor {start_floor!r}, only {', '.join(names)}: choose one of these, or another file"
        )
    name = ", ".join(dict.fromkeys(plan.name for plan in plans))
    return BuildingPlan(name, tuple(plans[k] for k in order), tuple(numbers[k] for k in order), start, notes)
