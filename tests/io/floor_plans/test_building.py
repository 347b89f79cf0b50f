"""Plans of several floors: their names give their order, and what cannot be ordered is refused or said."""

import json
from pathlib import Path

import pytest

from pdr_est.errors import FloorPlanError
from pdr_est.io.floor_plans.building import read_building_plan
from pdr_est.io.floor_plans.floor_numbers import floor_number, floor_numbers_of
from pdr_est.types.floor_plan import BuildingPlan, FloorPlan

pytest.importorskip("shapely")

RING = [[0, 0], [20, 0], [20, 10], [0, 10], [0, 0]]


def feature(scale: float = 1.0, **properties: object) -> dict[str, object]:
    ring = [[scale * x, scale * y] for x, y in RING]
    return {"type": "Feature", "properties": properties, "geometry": {"type": "Polygon", "coordinates": [ring]}}


def written(path: Path, *features: dict[str, object]) -> Path:
    path.parent.mkdir(exist_ok=True)
    path.write_text(json.dumps({"type": "FeatureCollection", "features": features or [feature()]}))
    return path


@pytest.mark.parametrize(
    ("name", "number"),
    [
        ("0", 0),
        ("-2", -2),
        ("Level -1", -1),
        ("F2", 2),
        ("floor_3", 3),
        ("B1", -1),
        ("basement", -1),
        ("Ground floor", 0),
        ("EG", 0),
        ("2. OG", 2),
        ("first", 1),
        ("3rd floor", 3),
        ("Floor-2", 2),
        ("hall", None),
        ("F", None),
    ],
)
def test_names_mean_numbers(name: str, number: int | None) -> None:
    assert floor_number(name) == number


def test_without_a_floor_zero_the_first_one_lies_above_the_basement() -> None:
    assert floor_numbers_of(["F2", "F1", "B1", "B2"]) == [1, 0, -1, -2]
    assert floor_numbers_of(["F1", "B1", "G"]) == [1, -1, 0]
    assert floor_numbers_of(["1", "-1"]) == [1, -1]
    assert floor_numbers_of(["F1", "roof"]) is None


def test_files_of_floors_become_a_building(tmp_path: Path) -> None:
    files = [written(tmp_path / f"{name}.geojson") for name in ("first", "ground")]
    found = read_building_plan(files, "first")
    assert isinstance(found, BuildingPlan)
    assert ([plan.floor for plan in found.plans], found.numbers, found.start) == (["ground", "first"], (0, 1), 1)
    assert found.start_plan is found.plan_of(1)
    assert found.plan_of(2) is None
    assert found.all_floors.area_m2 == pytest.approx(400.0)


def test_one_file_with_several_floors_or_with_one(tmp_path: Path) -> None:
    both = written(tmp_path / "mall.geojson", feature(level=2), feature(0.5, level=1))
    found = read_building_plan(both)
    assert isinstance(found, BuildingPlan)
    assert (found.numbers, found.start, found.plans[0].area_m2) == ((1, 2), None, pytest.approx(50.0))
    single = read_building_plan(written(tmp_path / "hall.geojson"))
    assert isinstance(single, FloorPlan)
    with pytest.raises(FloorPlanError, match="its floor has no name"):
        read_building_plan(tmp_path / "hall.geojson", "F1")


def test_the_folder_of_a_site_holds_its_floors(tmp_path: Path) -> None:
    for floor in ("F2", "F1", "B1"):
        written(tmp_path / floor / "geojson_map.json")
        (tmp_path / floor / "floor_info.json").write_text('{"map_info": {"width": 40, "height": 20}}')
    found = read_building_plan(tmp_path, "F1")
    assert isinstance(found, BuildingPlan)
    assert ([plan.floor for plan in found.plans], found.numbers, found.start) == (["B1", "F1", "F2"], (-1, 0, 1), 0)
    assert found.plans[0].area_m2 == pytest.approx(800.0)
    assert isinstance(read_building_plan(tmp_path / "F2"), FloorPlan)


def test_floors_without_numbers_count_in_the_order_of_the_files(tmp_path: Path) -> None:
    found = read_building_plan([written(tmp_path / f"{name}.geojson") for name in ("shops", "offices")])
    assert isinstance(found, BuildingPlan)
    assert (found.floor_names, found.numbers) == ("shops, offices", (0, 1))
    assert found.notes == ("the floors shops, offices count as given from the lowest to the highest",)


@pytest.mark.parametrize(
    ("names", "start", "words"),
    [
        (("ground", "roof"), "", "only some of the floors ground, roof have a name with a number"),
        (("F1", "first"), "", "two of the floors F1, first are the same one"),
        (("F1", "F2"), "F3", "has no floor 'F3', only F1, F2"),
    ],
)
def test_floors_that_do_not_go_together_are_refused(
    tmp_path: Path, names: tuple[str, ...], start: str, words: str
) -> None:
    with pytest.raises(FloorPlanError, match=words):
        read_building_plan([written(tmp_path / f"{name}.geojson") for name in names], start)


def test_units_must_be_the_same(tmp_path: Path) -> None:
    degrees = written(tmp_path / "F2.geojson", feature(1e-5))
    with pytest.raises(FloorPlanError, match="some plans are in degrees and others in metres"):
        read_building_plan([written(tmp_path / "F1.geojson"), degrees])
