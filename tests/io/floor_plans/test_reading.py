"""Floor plans from GeoJSON and the competition's maps: walkable areas, units, floors, and refusals in words."""

import gzip
import json
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pdr_est.errors import FloorPlanError
from pdr_est.frames import GeoOrigin
from pdr_est.io.floor_plans.reading import SIGMA_DRAWING_M, read_floor_plan, read_floor_plans
from pdr_est.io.floor_plans.writing import write_floor_plan
from pdr_est.io.writers.geodesy import longitude_latitude

pytest.importorskip("shapely")

Ring = Sequence[Sequence[float]]
HALL = [[0, 0], [40, 0], [40, 30], [0, 30], [0, 0]]
SHOP = [[10, 10], [20, 10], [20, 20], [10, 20], [10, 10]]
BOW_TIE = [[0, 0], [10, 10], [10, 0], [0, 10], [0, 0]]


def polygon(*rings: Ring, **properties: Any) -> dict[str, Any]:
    return {
        "type": "Feature",
        "geometry": {"type": "Polygon", "coordinates": list(rings)},
        "properties": properties,
    }


def wall(*points: Sequence[float], **properties: Any) -> dict[str, Any]:
    geometry = {"type": "LineString", "coordinates": list(points)}
    return {"type": "Feature", "geometry": geometry, "properties": properties}


def written(folder: Path, *features: dict[str, Any], **members: Any) -> Path:
    path = folder / "plan.geojson"
    document = {"type": "FeatureCollection", "features": list(features), **members}
    path.write_text(json.dumps(document), encoding="utf-8")
    return path


def degrees_of(ring: Ring, origin: GeoOrigin) -> list[list[float]]:
    corners: list[list[float]] = longitude_latitude(np.array(ring, dtype=np.float64), origin).tolist()
    return corners


def test_closed_pieces_are_cut_out(tmp_path: Path) -> None:
    path = written(tmp_path, polygon(SHOP, kind="closed"), polygon(HALL, kind="floor"), wall([0, 25], [40, 25]))
    plan = read_floor_plan(path)
    assert (plan.name, plan.floor, plan.sigma_m, plan.origin) == ("plan", "", SIGMA_DRAWING_M, None)
    assert plan.area_m2 == pytest.approx(1200.0 - 100.0)
    assert plan.contains(np.array([[5.0, 5.0], [15.0, 15.0]])).tolist() == [True, False]
    assert plan.walls_m.tolist() == [[[0.0, 25.0], [40.0, 25.0]]]


def test_without_kinds_what_lies_inside_is_closed(tmp_path: Path) -> None:
    island = [[13, 13], [17, 13], [17, 17], [13, 17], [13, 13]]
    annexe = [[60, 0], [70, 0], [70, 10], [60, 10], [60, 0]]
    plan = read_floor_plan(written(tmp_path, polygon(island), polygon(SHOP), polygon(HALL), polygon(annexe)))
    assert [round(float(area.outline_m[:, 0].min())) for area in plan.areas] == [0, 60]
    assert plan.area_m2 == pytest.approx(1200.0 - 100.0 + 100.0)


def test_holes_of_a_polygon_are_holes_and_slivers_are_dropped(tmp_path: Path) -> None:
    nearly_all = [[0.1, -1], [40.1, -1], [40.1, 29.5], [0.1, 29.5], [0.1, -1]]
    plan = read_floor_plan(written(tmp_path, polygon(HALL, SHOP[::-1])))
    assert len(plan.areas) == 1
    assert len(plan.areas[0].holes_m) == 1
    rest = read_floor_plan(written(tmp_path, polygon(HALL, kind="floor"), polygon(nearly_all, kind="closed")))
    assert len(rest.areas) == 1
    assert rest.area_m2 == pytest.approx(0.5 * 40.0, abs=0.1)  # without the slit in the west


def test_degrees_are_converted_to_metres_from_the_origin(tmp_path: Path) -> None:
    corner, walk = GeoOrigin(48.1, 11.5), GeoOrigin(48.0995, 11.499)
    path = written(tmp_path, polygon(degrees_of(HALL, corner)))
    plan = read_floor_plan(path)
    assert plan.origin is not None
    assert plan.origin.latitude_deg == pytest.approx(48.1)
    assert plan.bounds_m == pytest.approx((0.0, 0.0, 40.0, 30.0), abs=1e-3)
    moved = read_floor_plan(path, origin=walk)
    assert moved.origin == walk
    assert moved.bounds_m[0] == pytest.approx(0.001 * 111_320.0 * np.cos(np.radians(48.1)), rel=3e-3)


def test_metres_of_a_small_plan_are_metres(tmp_path: Path) -> None:
    room = [[0, 0], [4, 0], [4, 3], [0, 3]]  # an open ring is closed
    assert read_floor_plan(written(tmp_path, polygon(room))).area_m2 == pytest.approx(12.0)


def test_floors_are_told_apart(tmp_path: Path) -> None:
    path = written(
        tmp_path, polygon(HALL, floor="F1"), polygon(HALL, level=2), polygon(SHOP, kind="closed"), sigma_m=0.5
    )
    plans = read_floor_plans(path)
    assert [plan.floor for plan in plans] == ["F1", "2"]
    assert all(plan.area_m2 == pytest.approx(1100.0) for plan in plans)  # the shaft goes through both
    assert read_floor_plan(path, "2").sigma_m == 0.5
    with pytest.raises(FloorPlanError, match=r"shows the floors F1, 2: choose one of them \(--floor NAME\)"):
        read_floor_plan(path)
    with pytest.raises(FloorPlanError, match="has no floor 'F3', only F1, 2"):
        read_floor_plan(path, "F3")
    with pytest.raises(FloorPlanError, match="its floor has no name"):
        read_floor_plan(written(tmp_path, polygon(HALL)), "F1")


@pytest.mark.parametrize(
    ("features", "members", "words"),
    [
        (
            [polygon(HALL), polygon(BOW_TIE, name="lift")],
            {},
            r'feature 2 \("lift"\): the outline crosses itself at \(5',
        ),
        ([polygon(degrees_of(HALL, GeoOrigin(48.0, 11.0)))], {"coordinate_unit": "metre"}, "look like degrees"),
        ([polygon(HALL)], {"coordinate_unit": "feet"}, r'coordinate_unit = .feet.: write "metre" or "degree"'),
        (
            [polygon([[0, 0], [400, 0], [400, 300]])],
            {"coordinate_unit": "degree"},
            "longitude 400.* not on the Earth",
        ),
        ([polygon([[5e5, 4e6], [5.1e5, 4e6], [5e5, 4.1e6]])], {}, "4100 km from the origin of the map frame"),
        ([polygon(HALL, kind="lawn")], {}, "kind = 'lawn': is none of floor, closed, wall"),
        ([wall([0, 0], [1, 1], kind="floor")], {}, "a line cannot be floor: draw a polygon"),
        ([polygon([[0, 0], [1, 1], [0, 0]])], {}, "a ring of 2 corners"),
        ([polygon([[0, 0], [1, "a"], [0, 3]])], {}, r"feature 1: \[1, 'a'\] is no pair of numbers"),
        ([polygon([[0, 0], [True, 4], [0, 3]])], {}, "is no pair of numbers"),
        ([polygon([[0, 0], [10**400, 4], [0, 3]])], {}, "a coordinate is not finite"),
        ([polygon([[0, 0], [1e300, 4], [0, 3]])], {}, r"reaches 1e\+297 km from the origin"),
        ([polygon([[48.1, 121.5], [48.101, 121.5], [48.1, 121.501]])], {}, "longitude first"),
        (
            [polygon(HALL), {"type": "Feature", "geometry": {"type": "polygon", "coordinates": [HALL]}}],
            {},
            "feature 2: a geometry of the type 'polygon'",
        ),
        ([{"type": "Feature", "geometry": {"type": "MultiPolygon", "coordinates": None}}], {}, "is no list"),
        ([polygon([[0, 0], [1], [0, 3]])], {}, "no list of at least 3 positions"),
        ([wall([0, 0], [1, 1])], {}, "no walkable floor"),
        ([polygon(HALL, kind="closed")], {}, "no walkable floor"),
        ([polygon(HALL)], {"sigma_m": -1}, "sigma_m = -1: give a positive number of metres up to 10"),
        ([polygon(HALL)], {"sigma_m": "0.2"}, "sigma_m = '0.2': give a positive number"),
        ([polygon(HALL)], {"sigma_m": 10**400}, "sigma_m = 1000"),
        ([polygon(HALL)], {"sigma_m": 30.0}, "up to 10"),
        ([{"type": "Feature", "geometry": None, "properties": None}], {}, "neither polygons nor lines"),
        ([], {}, "no list of features"),
    ],
)
def test_unusable_plans_are_refused_in_words(
    tmp_path: Path, features: list[dict[str, Any]], members: dict[str, Any], words: str
) -> None:
    with pytest.raises(FloorPlanError, match=words):
        read_floor_plan(written(tmp_path, *features, **members))


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"hello", "is no JSON"),
        (b"\x89PNG\r\n\x1a\n....", "is a picture"),
        (b"", "is empty"),
        (b"[1]", "no list of features"),
    ],
)
def test_other_files_are_refused_in_words(tmp_path: Path, content: bytes, words: str) -> None:
    path = tmp_path / "plan.geojson"
    path.write_bytes(content)
    with pytest.raises(FloorPlanError, match=words):
        read_floor_plan(path)
    with pytest.raises(FloorPlanError, match="no such file"):
        read_floor_plan(tmp_path / "other.geojson")


def competition_folder(folder: Path, *features: dict[str, Any], gz: bool = False) -> Path:
    place = folder / "site1" / "F2"
    place.mkdir(parents=True, exist_ok=True)
    files = {
        "geojson_map.json": {"type": "FeatureCollection", "features": list(features)},
        "floor_info.json": {"map_info": {"width": 80.0, "height": 30.0}},
    }
    for name, content in files.items():
        data = json.dumps(content).encode()
        (place / f"{name}.gz").write_bytes(gzip.compress(data)) if gz else (place / name).write_bytes(data)
    (place / "walk.txt").write_bytes(b"1574659531598\tTYPE_WAYPOINT\t1\t2\n")
    return place


@pytest.mark.parametrize("gz", [False, True])
def test_the_map_of_the_competition_is_stretched_to_its_stated_size(tmp_path: Path, gz: bool) -> None:
    corner = GeoOrigin(30.3, 120.07)
    hall, shop = degrees_of(HALL, corner), degrees_of(SHOP, corner)
    folder = competition_folder(tmp_path, polygon(hall), polygon(shop, name="shop"), gz=gz)
    map_file = folder / ("geojson_map.json.gz" if gz else "geojson_map.json")
    for path in (folder, map_file):
        plan = read_floor_plan(path)
        assert (plan.floor, plan.origin) == ("F2", None)
        assert plan.bounds_m == pytest.approx((0.0, 0.0, 80.0, 30.0), abs=1e-6)
        assert plan.area_m2 == pytest.approx(2.0 * 1100.0, rel=1e-3)
        assert plan.contains(np.array([[30.0, 15.0], [50.0, 15.0]])).tolist() == [False, True]


def test_crossing_outlines_of_the_competition_are_divided_and_noted(tmp_path: Path) -> None:
    corner = GeoOrigin(30.3, 120.07)
    flat = polygon(degrees_of([[1, 1], [2, 2], [1, 1]], corner))
    folder = competition_folder(
        tmp_path, polygon(degrees_of(HALL, corner)), polygon(degrees_of(BOW_TIE, corner)), flat
    )
    plan = read_floor_plan(folder)
    assert plan.notes == (
        "1 features are no polygons and are left out",
        "1 outlines cross themselves and are divided at the crossings",
    )
    assert plan.area_m2 == pytest.approx(2.0 * (1200.0 - 50.0), rel=1e-3)


def test_a_map_of_the_competition_needs_its_size(tmp_path: Path) -> None:
    folder = competition_folder(tmp_path, polygon(degrees_of(HALL, GeoOrigin(30.3, 120.07))))
    (folder / "floor_info.json").write_text('{"map_info": {"width": 0, "height": 30}}')
    with pytest.raises(FloorPlanError, match="both must be positive"):
        read_floor_plan(folder)
    (folder / "floor_info.json").write_text("{}")
    with pytest.raises(FloorPlanError, match="no width and height"):
        read_floor_plan(folder)
    (folder / "floor_info.json").unlink()
    with pytest.raises(FloorPlanError, match=r"floor_info\.json is not beside it"):
        read_floor_plan(folder / "geojson_map.json")


def test_a_plan_on_the_earth_is_written_and_read_again(tmp_path: Path) -> None:
    corner = GeoOrigin(48.1, 11.5)
    lines = degrees_of([[0, 25], [40, 25]], corner)
    plan = read_floor_plan(written(tmp_path, polygon(degrees_of(HALL, corner), floor="F1"), wall(*lines)))
    write_floor_plan(plan, tmp_path / "again.geojson")
    again = read_floor_plan(tmp_path / "again.geojson", origin=plan.origin)
    assert again.origin == plan.origin
    assert again.area_m2 == pytest.approx(plan.area_m2, rel=1e-4)
    np.testing.assert_allclose(again.walls_m, plan.walls_m, atol=2e-3)


def test_a_crossing_outline_with_a_spike_keeps_its_areas(tmp_path: Path) -> None:
    spiked = [[0, 0], [10, 10], [10, 0], [0, 10], [-3, 13], [0, 10], [0, 0]]
    corner = GeoOrigin(30.3, 120.07)
    moved = [[x + 5, y + 5] for x, y in spiked]
    folder = competition_folder(tmp_path, polygon(degrees_of(HALL, corner)), polygon(degrees_of(moved, corner)))
    assert read_floor_plan(folder).area_m2 == pytest.approx(2.0 * (1200.0 - 50.0), rel=1e-3)


def test_names_of_floors_are_text_without_surprises(tmp_path: Path) -> None:
    floors = [polygon(HALL, floor=floor) for floor in (1.0, 2, " 3\n", "<b>4</b>")]
    plans = read_floor_plans(written(tmp_path, *floors))
    assert [plan.floor for plan in plans] == ["1", "2", "3", "<b>4</b>"]
    (plan,) = read_floor_plans(written(tmp_path, polygon(HALL, floor=True)))
    assert plan.floor == ""


def test_plans_larger_than_buildings_are_doubted(tmp_path: Path) -> None:
    plan = read_floor_plan(written(tmp_path, polygon([[1000 * x, 1000 * y] for x, y in HALL])))
    (note,) = plan.notes
    assert "km long, and no building is" in note
    assert "convert them to metres" in note


def test_wrong_arguments_are_refused_in_words(tmp_path: Path) -> None:
    path = written(tmp_path, polygon(HALL))
    with pytest.raises(FloorPlanError, match="origin is a tuple: give a GeoOrigin"):
        read_floor_plan(path, origin=(48.1, 11.5))  # type: ignore[arg-type]
    with pytest.raises(FloorPlanError, match="sigma_m = 'a': give a positive number"):
        read_floor_plan(path, sigma_m="a")  # type: ignore[arg-type]


def test_thousands_of_rooms_are_read_at_once(tmp_path: Path) -> None:
    """As it would not be if each room were compared with all others: that took a minute."""
    rooms = [
        polygon([[x, y], [x + 4, y], [x + 4, y + 4], [x, y + 4]]) for x in range(0, 200, 5) for y in range(0, 200, 5)
    ]
    path = written(tmp_path, *rooms, polygon([[1, 1], [2, 1], [2, 2], [1, 2]]))
    begun_s = time.process_time()
    plan = read_floor_plan(path)
    assert time.process_time() - begun_s < 10.0
    assert (len(plan.areas), sum(len(area.holes_m) for area in plan.areas)) == (1600, 1)
