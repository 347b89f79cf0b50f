"""`pdr-est plan`, and `smooth --plan`: what they write and print, and what they refuse."""

import json
from pathlib import Path

import numpy as np
import pytest
from cli_runs import refused, run, smooth_refused, smoothed

from pdr_est.io.floor_plans.reading import read_floor_plan

pytest.importorskip("shapely")

HALL = [[-5, -5], [20, -5], [20, 15], [-5, 15], [-5, -5]]
BLOCK = [[5, 5], [10, 5], [10, 10], [5, 10], [5, 5]]


def feature(ring: list[list[float]], **properties: str) -> dict[str, object]:
    return {"type": "Feature", "properties": properties, "geometry": {"type": "Polygon", "coordinates": [ring]}}


def plan_file(folder: Path, *features: dict[str, object]) -> Path:
    path = folder / "hall.geojson"
    path.write_text(
        json.dumps({"type": "FeatureCollection", "features": features or [feature(HALL), feature(BLOCK)]})
    )
    return path


def test_a_plan_is_described(tmp_path: Path) -> None:
    result = run("plan", plan_file(tmp_path), "--start", 7, 7)
    assert result.exit_code == 0
    lines = dict(line.split("  ", 1) for line in result.stdout.splitlines())
    assert lines["size"].strip() == "25.0 x 20.0 m, x -5.0 to 20.0, y -5.0 to 15.0"
    assert lines["walkable"].strip() == "475 m², 95 % of the box around it"
    assert lines["position"].strip() == "(7, 7) lies 2.0 m off the walkable floor"
    assert "0°, 90°, 180°, 270° counter-clockwise" in result.stdout
    assert "--start nan 0: is no position on a plan" in refused("plan", plan_file(tmp_path), "--start", "nan", 0)


def test_the_page_shows_plan_and_scale(tmp_path: Path) -> None:
    result = run("plan", plan_file(tmp_path), "-o", tmp_path / "out", "--start", 0, 0)
    assert result.stdout.endswith(f"-> {tmp_path / 'out' / 'plan.html'}\n")
    page = (tmp_path / "out" / "plan.html").read_text(encoding="utf-8")
    assert "<th>walkable</th><td>475 m², 95 % of the box around it</td>" in page
    assert "5 m<" in page  # the bar of scale
    assert "http:" not in page
    again = read_floor_plan(tmp_path / "out" / "plan.geojson")
    assert again.area_m2 == pytest.approx(475.0)
    assert "contains the results of an earlier run" in refused("plan", plan_file(tmp_path), "-o", tmp_path / "out")


def test_a_plan_is_made_of_a_picture(tmp_path: Path) -> None:
    skimage_io = pytest.importorskip("skimage.io")
    image = np.full((300, 400), 255, dtype=np.uint8)
    image[48:253, 48:353] = 0
    image[53:248, 53:348] = 255
    skimage_io.imsave(tmp_path / "hall.png", image, check_contrast=False)
    points = ("--point", 50, 250, 0, 0, "--point", 350, 50, 30, 20)
    result = run("plan", tmp_path / "hall.png", *points, "-o", tmp_path / "out", "--floor", "F1", "-q")
    assert (result.exit_code, result.stdout) == (0, "")
    assert read_floor_plan(tmp_path / "out" / "plan.geojson", "F1").area_m2 == pytest.approx(29.5 * 19.5, rel=0.01)
    assert "is a picture: make a plan of it first" in refused("plan", tmp_path / "hall.png")
    assert "give two that are far apart" in refused("plan", tmp_path / "hall.png", *points[:5])
    assert "are about pictures" in refused("plan", plan_file(tmp_path), "--darkness", 0.5)


def test_a_walk_on_its_plan(good: Path, tmp_path: Path) -> None:
    path = plan_file(tmp_path)
    options = ("--start", 0, 0, "--heading", 0, "--plan", path)
    result = smoothed(good, tmp_path / "out", *options)
    assert "estimator: particle, the default with a floor plan, because it keeps the track on it" in result.stdout
    summary = json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))
    assert summary["floor_plan"]["name"] == "hall"
    assert summary["floor_plan"]["walkable_m2"] == pytest.approx(475.0)
    assert summary["floor_plan"]["share_of_track_outside"] == 0.0
    assert str(path) in {one["name"] for one in summary["inputs"]}
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert "walkable floor" in page
    assert '"kind": "lines"' in page.replace('"kind":"lines"', '"kind": "lines"')
    assert '"rings":2' in page.replace('"rings": 2', '"rings":2')  # the hall and the hole in it
    assert "475 m² walkable; 0.0 % of the poses lie outside" in page
    assert (summary["estimator"], summary["frame"]) == ("particle", "map")
    assert "particle (smoothed): the default with a floor plan" in page
    chosen = smoothed(good, tmp_path / "chosen", *options, "--estimator", "factor-graph")
    assert "factor-graph takes only the directions of the walls from the floor plan" in chosen.stderr
    assert "estimator:" not in chosen.stdout
    written = json.loads((tmp_path / "chosen" / "summary.json").read_text(encoding="utf-8"))
    assert (written["estimator"], written["estimator_meaning"]) == ("factor-graph", "chosen")


def test_without_a_plan_the_default_is_the_factor_graph(good: Path, tmp_path: Path) -> None:
    result = run("smooth", good, "-o", tmp_path / "out", "--no-report")
    summary = json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))
    assert (summary["estimator"], summary["estimator_meaning"]) == ("factor-graph", "the default")
    assert summary["config"]["estimator"]["name"] == "auto"
    assert "estimator:" not in result.stdout


def test_a_plan_in_degrees_gives_the_walk_its_place_on_the_earth(good: Path, tmp_path: Path) -> None:
    degrees = [[11.5 + 1e-5 * x, 48.1 + 1e-5 * y] for x, y in HALL]
    path = plan_file(tmp_path, feature(degrees))
    smoothed(good, tmp_path / "out", "--start", 5, 8, "--heading", 0, "--plan", path)
    track = json.loads((tmp_path / "out" / "track.geojson").read_text(encoding="utf-8"))
    longitude, latitude = track["features"][0]["geometry"]["coordinates"][0]
    assert (longitude, latitude) == pytest.approx((11.5 - 5e-5 + 6.7e-5, 48.1 - 5e-5 + 7.2e-5), abs=2e-6)


def floors_of(folder: Path, *names: str) -> list[Path]:
    """A file for each floor."""
    paths = []
    for name in names:
        (folder / name).mkdir()
        paths.append(plan_file(folder / name).rename(folder / f"{name}.geojson"))
    return paths


def test_several_plans_and_the_floor_of_the_start(good: Path, tmp_path: Path) -> None:
    ground, first = floors_of(tmp_path, "ground", "first")
    options = ("--start", 0, 0, "--heading", 0, "--plan", first, "--plan", ground)
    result = smoothed(good, tmp_path / "out", *options, "--floor", "ground")
    assert "no air pressure was recorded, so that the whole walk counts as one on floor ground" in result.stderr
    summary = json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))
    assert [one["floor"] for one in summary["floor_plans"]] == ["ground"]
    assert {str(ground), str(first)} <= {one["name"] for one in summary["inputs"]}
    line = smooth_refused(good, tmp_path / "a", *options)
    assert "shows the floors ground, first, and where the walk begins is not known" in line
    assert "--floor NAME" in line
    assert "has no floor 'attic', only first, ground" in smooth_refused(
        good, tmp_path / "b", *options, "--floor", "attic"
    )


def test_a_recording_is_tracked_on_its_plan(good: Path, tmp_path: Path) -> None:
    options = ("--start", 0, 0, "--heading", 0)
    lines = [
        [json.loads(line) for line in run("track", good, *options, *more).stdout.splitlines()]
        for more in (("--plan", plan_file(tmp_path)), ("--estimator", "particle"))
    ]
    assert len(lines[0]) == len(lines[1]) > 10
    on_plan = read_floor_plan(plan_file(tmp_path)).contains(np.array([(one["x_m"], one["y_m"]) for one in lines[0]]))
    assert on_plan.all()
    assert any(a["x_m"] != b["x_m"] for a, b in zip(*lines, strict=True))
    line = refused("track", good, *options, "--plan", plan_file(tmp_path), "--estimator", "ekf")
    assert "ekf makes no use of the floor plan hall: track with particle, or leave the plan out" in line
    assert "give --plan FILE, too" in refused("track", good, "--floor", "1")


def test_what_is_assumed_of_plans_is_told_online_too(good: Path, tmp_path: Path) -> None:
    west, east = floors_of(tmp_path, "west", "east")
    result = run(
        *("track", good, "--start", 0, 0, "--heading", 0, "-o", tmp_path / "track.jsonl"),
        *("--plan", west, "--plan", east, "--floor", "west"),
    )
    assert "the floors west, east count as given from the lowest to the highest" in result.stderr
    assert "no air pressure was recorded, so that the whole walk counts as one on floor west" in result.stderr


def test_plans_that_do_not_fit_are_refused_in_one_line(good: Path, tmp_path: Path) -> None:
    path = plan_file(tmp_path)
    line = smooth_refused(good, tmp_path / "a", "--plan", path, "--start", 40, 0)
    assert "start (40, 0) m lies 20.0 m outside of the walkable area of the plan hall" in line
    assert "give --plan FILE, too" in smooth_refused(good, tmp_path / "b", "--floor", "F1")
    assert "its floor has no name" in smooth_refused(good, tmp_path / "c", "--plan", path, "--floor", "F1")
    crossing = plan_file(tmp_path, feature([[0, 0], [9, 9], [9, 0], [0, 9], [0, 0]]))
    assert "crosses itself at (4.5, 4.5)" in smooth_refused(good, tmp_path / "d", "--plan", crossing)


def test_a_walk_without_a_start_tells_its_places(good: Path, tmp_path: Path) -> None:
    result = smoothed(good, tmp_path / "hall", "--plan", plan_file(tmp_path), "--estimator", "particle")
    summary = json.loads((tmp_path / "hall" / "summary.json").read_text(encoding="utf-8"))
    search = summary["place_search"]
    assert summary["frame"] == "map"
    assert search["unique_since"] is None
    assert sum(mode["probability"] for mode in search["end"]["modes"]) > 0.9
    assert "warning: the place on the plan is not decided" in result.stderr
    page = (tmp_path / "hall" / "report.html").read_text(encoding="utf-8")
    assert "Places on the plan where the walk may have been" in page
    assert "places by the measurements until then" in page


def test_the_only_place_that_fits_a_walk_is_printed(good: Path, tmp_path: Path) -> None:
    corridor = plan_file(tmp_path, feature([[0, 0], [14, 0], [14, 3], [0, 3], [0, 0]]))
    result = smoothed(good, tmp_path / "out", "--plan", corridor, "--heading", 0, "--estimator", "particle")
    assert "the place on the plan was found after" in result.stdout
    assert "not decided" not in result.stderr
