"""`--format`: what is written, where a track can be placed on the Earth, and what is refused."""

import csv
import json
from datetime import datetime
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cli_recordings import as_zip
from cli_runs import refused, run, smooth_refused
from defusedxml.ElementTree import parse

pytestmark = pytest.mark.usefixtures("without_report")

GX, KML = "{http://www.google.com/kml/ext/2.2}", "{http://www.opengis.net/kml/2.2}"
ALWAYS = {"track.csv", "steps.csv", "summary.json", "report.html"}


def names_in(folder: Path) -> set[str]:
    return {path.name for path in folder.iterdir() if not path.name.startswith(".")}


def document(folder: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    return found


def rows_of(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as stream:
        return list(csv.DictReader(stream))


def assert_in_order(poses: list[float], rows: list[float]) -> None:
    """Assert that rows are those of the poses, with one more before some of them, where a pause ends."""
    remaining = iter(rows)
    assert all(pose in remaining for pose in poses)
    assert len(poses) <= len(rows) < 2 * len(poses)


def test_formats_are_chosen_with_commas_and_by_repeating(good: Path, tmp_path: Path) -> None:
    formats = ("--format", "TUM, iso21134", "--format", "tum-covariance", "--format", "tum")
    result = run("smooth", good, "-o", tmp_path / "out", *formats)
    assert result.exit_code == 0, result.output
    own = {"track.tum", "track-iso21134.csv", "track-covariance.txt"}
    assert names_in(tmp_path / "out") == ALWAYS | own
    assert document(tmp_path / "out")["formats"] == {
        "written": ["tum", "tum-covariance", "iso21134"],
        "left_out": {},
    }
    table, iso = rows_of(tmp_path / "out" / "track.csv"), rows_of(tmp_path / "out" / "track-iso21134.csv")
    assert_in_order([float(row["x_m"]) for row in table], [float(row["x"]) for row in iso])


def test_an_unknown_format_is_refused_with_the_known_ones(good: Path, tmp_path: Path) -> None:
    result = run("smooth", good, "-o", tmp_path / "out", "--format", "tum,kmz")
    assert result.exit_code == 2
    assert "'kmz' is no format of a track: give one of tum, geojson, kml, gpx" in " ".join(result.stderr.split())
    assert "tum-covariance" in run("smooth", "--help").stdout


def test_a_walk_without_gps_has_no_place_on_the_earth(good: Path, tmp_path: Path) -> None:
    line = smooth_refused(good, tmp_path / "w", "--format", "gpx,tum")
    assert "gpx cannot be written, since the recording holds no latitude and longitude: record GPS as well" in line
    assert run("smooth", good, "-o", tmp_path / "out").exit_code == 0
    assert names_in(tmp_path / "out") == {*ALWAYS, "track.tum", "track.geojson"}
    left_out = document(tmp_path / "out")["formats"]["left_out"]
    assert set(left_out) == {"kml", "gpx"}
    assert "no latitude and longitude" in left_out["kml"]


def test_a_walk_with_gps_is_placed_by_it_with_exact_times(export_zip: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    assert run("smooth", export_zip, "-o", out, "--fixes", "recording").exit_code == 0
    assert {"track.kml", "track.gpx"} < names_in(out)
    table = rows_of(out / "track.csv")
    root = parse(out / "track.kml").getroot()
    begin = datetime.fromisoformat(document(out)["recording"]["time_zero"])
    dates = [datetime.fromisoformat(one.text) for one in root.iter(f"{KML}Track/{KML}when")]
    dates = dates or [datetime.fromisoformat(one.text) for one in root.find(f".//{GX}Track").findall(f"{KML}when")]
    times = [(date - begin).total_seconds() for date in dates]
    np.testing.assert_allclose(times, [float(row["time_s"]) for row in table], atol=1e-3)  # time_zero: milliseconds
    coordinates = [list(map(float, one.text.split())) for one in root.iter(f"{GX}coord")]
    features = json.loads((out / "track.geojson").read_text(encoding="utf-8"))["features"]
    np.testing.assert_allclose(np.array(coordinates)[:, :2], features[0]["geometry"]["coordinates"], atol=1.1e-8)
    poses = [one["properties"] for one in features if one["properties"]["feature"] == "pose"]
    assert [datetime.fromisoformat(pose["time"]) for pose in poses] == dates


def test_a_turned_walk_is_refused_or_left_out_in_words(export: dict[str, bytes], tmp_path: Path) -> None:
    """GPS, but neither an attitude nor a magnetometer that tell north."""
    without = {name: data for name, data in export.items() if name not in ("Orientation.csv", "Magnetometer.csv")}
    recording = as_zip(tmp_path / "walk.zip", without)
    line = smooth_refused(recording, tmp_path / "w", "--format", "kml")
    assert "kml cannot be written, since the track cannot be placed on the Earth: north is unknown: give" in line
    result = run("smooth", recording, "-o", tmp_path / "out")
    assert "not written: kml, gpx; the track cannot be placed on the Earth: north is unknown" in result.stdout
    assert names_in(tmp_path / "out") == {*ALWAYS, "track.tum", "track.geojson"}
    assert document(tmp_path / "out")["on_earth"]["placed"] is False


def test_formats_hold_for_each_of_many_walks(good: Path, export_zip: Path, tmp_path: Path) -> None:
    folder = tmp_path / "in"
    folder.mkdir()
    (folder / "a.csv").write_bytes(good.read_bytes())
    (folder / "b.zip").write_bytes(export_zip.read_bytes())
    fixed = ("--start", 0, 0, "--heading", 0)
    result = run("smooth", folder, "-o", tmp_path / "out", "--format", "gpx", *fixed)
    assert result.exit_code == 2
    assert "a.csv: a: gpx cannot be written" in result.stderr.replace("walk: gpx", "a: gpx")
    assert names_in(tmp_path / "out" / "b") == {"track.csv", "steps.csv", "summary.json", "track.gpx"}


def test_an_online_track_is_written_beside_its_lines(export_zip: Path, tmp_path: Path) -> None:
    lines = tmp_path / "walk.jsonl"
    known = ("--start", 1, 2, "--heading", 90)
    result = run("track", export_zip, "-o", lines, *known, "--format", "kml,iso21134")
    assert result.exit_code == 0, result.output
    assert names_in(tmp_path) == {"walk.jsonl", "walk.kml", "walk-iso21134.csv"}
    rows = [json.loads(line) for line in lines.read_text(encoding="utf-8").splitlines()]
    latest = {row["time_s"]: row for row in rows}
    poses = rows_of(tmp_path / "walk-iso21134.csv")
    assert_in_order([latest[time_s]["x_m"] for time_s in sorted(latest)], [float(row["x"]) for row in poses])
    assert len(list(parse(tmp_path / "walk.kml").getroot().iter(f"{GX}coord"))) == len(latest)
    again = ("track", export_zip, "-o", lines, *known, "--format", "kml")
    lines.unlink()
    assert "walk.kml: exists already: allow overwriting (--overwrite)" in refused(*again)
    assert not lines.exists()
    assert run(*again, "--overwrite").exit_code == 0


def test_an_online_track_without_a_known_start_is_refused_on_the_earth(export_zip: Path, tmp_path: Path) -> None:
    line = refused("track", export_zip, "-o", tmp_path / "walk.jsonl", "--format", "gpx")
    assert "unless position and heading at the start are known: give --start and --heading" in line
    assert names_in(tmp_path) == set()


def test_online_formats_need_a_file(good: Path) -> None:
    result = run("track", good, "--format", "tum")
    assert result.exit_code == 2
    assert "give -o FILE as well" in result.stderr
    assert "leave it out with -" in run("track", "-", "--format", "tum").stderr
