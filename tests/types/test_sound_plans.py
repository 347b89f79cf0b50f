"""Plans that a user made in Python are refused in words where nothing can be done with them."""

from dataclasses import replace

import numpy as np
import pytest

from pdr_est.errors import FloorPlanError
from pdr_est.frames import GeoOrigin
from pdr_est.types.floor_plan import BuildingPlan, FloorPlan, PresentFloor, WalkableArea
from pdr_est.types.on_plan.sound_plans import require_sound_floors, require_sound_plan, same_origin

SQUARE = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 8.0], [0.0, 8.0]])
HALL = FloorPlan("hall", (WalkableArea(SQUARE),), np.zeros((0, 2, 2)), 0.2, "1")
BUILDING = BuildingPlan("house", (HALL, replace(HALL, floor="2")), (1, 2), 1)
HERE, THERE = GeoOrigin(48.1, 11.5), GeoOrigin(48.1, 11.6)


def with_outline(outline: object) -> FloorPlan:
    return replace(HALL, areas=(WalkableArea(outline),))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("plan", "words"),
    [
        (replace(HALL, areas=()), "plan hall: has no walkable area"),
        (replace(HALL, areas=(SQUARE,)), r"areas\[0\] is a ndarray: give a WalkableArea"),
        (with_outline(SQUARE.tolist()), r"areas\[0\].outline_m is a list: give a numpy array"),
        (with_outline(SQUARE[:2]), r"outline_m has shape \(2, 2\): give at least 3 corners"),
        (with_outline(SQUARE.ravel()), r"outline_m has shape \(8,\)"),
        (with_outline(np.array(["a", "b"])), "holds no numbers"),
        (with_outline(np.vstack([SQUARE, [[np.nan, 1.0]]])), r"outline_m\[4, 0\] is nan: correct it"),
        (with_outline(SQUARE * np.array([1.0, 0.0])), "has a walkable area of 0 m²"),
        (replace(HALL, areas=(WalkableArea(SQUARE, (2.0 * SQUARE,)),)), "has a walkable area of -240 m²"),
        (with_outline(1e9 * SQUARE), r"is 1e\+07 km long: give areas and walls in metres"),
        (replace(HALL, walls_m=np.zeros((3, 2))), r"walls_m has shape \(3, 2\): give begin and end of each"),
        (replace(HALL, walls_m=None), "walls_m is a NoneType"),
        (replace(HALL, sigma_m=-0.1), "sigma_m = -0.1: give a number of metres up to 10"),
        (replace(HALL, sigma_m=np.nan), "sigma_m = nan"),
        (replace(BUILDING, plans=()), "building plan house: has no plans"),
        (replace(BUILDING, plans=(HALL, None)), "plans hold a NoneType"),
        (replace(BUILDING, plans=(HALL, replace(HALL, sigma_m=-1.0))), "plan hall: sigma_m = -1.0"),
        (replace(BUILDING, numbers=(1,)), r"numbers = \[1\] of 2 plans: give a number for each, rising"),
        (replace(BUILDING, numbers=(2, 2)), r"numbers = \[2, 2\] of 2 plans"),
        (replace(BUILDING, start=7), r"start = 7 is none of its floors \[1, 2\]"),
        (replace(BUILDING, plans=(replace(HALL, origin=HERE), replace(HALL, origin=THERE))), "different origins"),
        (replace(BUILDING, plans=(replace(HALL, origin=HERE), HALL)), "different origins"),
    ],
)
def test_plans_of_no_use_are_refused(plan: FloorPlan | BuildingPlan, words: str) -> None:
    with pytest.raises(FloorPlanError, match=words):
        require_sound_plan(plan)


@pytest.mark.parametrize("plan", [HALL, BUILDING, with_outline(SQUARE.astype(int)), replace(HALL, sigma_m=0.0)])
def test_other_plans_are_not(plan: FloorPlan | BuildingPlan) -> None:
    require_sound_plan(plan)


@pytest.mark.parametrize(
    ("floors", "words"),
    [
        ((PresentFloor(3.0, HALL), PresentFloor(1.0, None)), r"plan\[1\]: time_s = 1.0 comes after 3.0"),
        ((PresentFloor(np.nan, HALL),), r"plan\[0\]: time_s = nan"),
        ((PresentFloor(0.0, HALL, 7.0),), r"plan\[0\]: probability = 7.0"),
        ((PresentFloor(0.0, replace(HALL, areas=())),), "has no walkable area"),
    ],
)
def test_floors_out_of_order_are_refused(floors: tuple[PresentFloor, ...], words: str) -> None:
    with pytest.raises(FloorPlanError, match=words):
        require_sound_floors(floors)


def test_origins_are_the_same_to_a_tenth_of_a_metre() -> None:
    assert same_origin(HERE, GeoOrigin(48.1 + 1e-7, 11.5))
    assert same_origin(None, None)
    assert not same_origin(HERE, THERE)
    assert not same_origin(HERE, None)
