"""The files of a finished walk hold what the track holds, in their formats' own terms."""

import csv
import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from pdr_est.errors import OutputError
from pdr_est.io.writers.track_files import STEP_COLUMNS, write_geojson, write_steps_csv, write_tum
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import GeoOrigin
from pdr_est.types.sensors import LevelBlock
from pdr_est.types.steps import CarryingMode, Gait, Step, StepEvent
from pdr_est.types.track import Track


def make_track(device_names: tuple[str, ...] = ("left",), count: int = 4) -> Track:
    """Devices one after the other; each walks east in steps of 0.7 m and turns 90 degrees in all."""
    n = count * len(device_names)
    number = np.tile(np.arange(count), len(device_names)).astype(float)
    row = np.repeat(np.arange(len(device_names)), count).astype(float)
    return Track(
        time_s=10.0 + 0.5 * number,
        moving_from_s=9.5 + 0.5 * number,
        device=np.repeat(device_names, count),
        position_m=np.column_stack([0.7 * number, row]),
        heading_rad=number * math.pi / 2 / max(count - 1, 1),
        covariance_m2=np.tile(0.04 * np.eye(2), (n, 1, 1)),
        sigma_heading_rad=np.full(n, 0.1),
        mode=np.full(n, CarryingMode.HOLDING, dtype=np.int8),
        step_length_m=np.where(number > 0, 0.7, 0.0),
        kind="smoothed",
        estimator="factor-graph",
    )


def make_step(index: int, length_m: float = 0.7, heading_rad: float = 1.5) -> Step:
    none, empty = np.zeros(0), np.zeros((0, 3))
    samples = LevelBlock(0, 0, none, empty, empty, none, none, empty, none, none.astype(np.int8), none)
    event = StepEvent(index, 1.25 + index, 2, CarryingMode.SWING, 0.875, 0.96875)
    step = Step(event, 1.0 + index, 1.8, samples, length_m, heading_rad)
    return step if index else replace(step, gait=Gait.JOGGING, gait_probability=(0.125, 0.625, 0.25))


def read_features(path: Path) -> tuple[dict, list[dict]]:
    collection = json.loads(path.read_text(encoding="utf-8"))
    assert collection["type"] == "FeatureCollection"
    return collection, collection["features"]


def test_tum_file_is_read_by_evo_with_position_heading_and_unix_time(tmp_path: Path) -> None:
    file_interface = pytest.importorskip("evo.tools.file_interface")
    track = make_track()
    (written,) = write_tum(track, tmp_path / "track.tum", epoch_s=1_700_000_000.0)

    trajectory = file_interface.read_tum_trajectory_file(str(written))

    valid, details = trajectory.check()
    assert valid, details
    np.testing.assert_allclose(trajectory.timestamps, 1_700_000_010.0 + 0.5 * np.arange(4), atol=1e-6)
    np.testing.assert_allclose(trajectory.positions_xyz[:, :2], track.position_m, atol=1e-4)
    yaw = trajectory.get_orientations_euler(axes="sxyz")[:, 2]
    np.testing.assert_allclose(yaw, track.heading_rad, atol=1e-6)


def test_tum_without_epoch_keeps_the_recordings_time(tmp_path: Path) -> None:
    write_tum(make_track(), tmp_path / "track.tum")
    first = (tmp_path / "track.tum").read_text().splitlines()[0]
    assert first == "10.000000 0.0000 0.0000 0 0 0 0.000000000 1.000000000"


def test_tum_quaternions_are_unit_and_keep_a_heading_beyond_one_turn(tmp_path: Path) -> None:
    track = make_track()
    turned = Track(**{**track.__dict__, "heading_rad": track.heading_rad + 6 * math.pi})
    write_tum(turned, tmp_path / "track.tum")
    qz, qw = np.loadtxt(tmp_path / "track.tum")[:, 6:].T
    np.testing.assert_allclose(qz**2 + qw**2, 1.0, atol=1e-8)
    np.testing.assert_allclose(2 * np.arctan2(qz, qw), track.heading_rad, atol=1e-8)


def test_tum_has_a_file_for_each_device_and_never_leaves_its_folder(tmp_path: Path) -> None:
    folder = tmp_path / "out"
    folder.mkdir()
    files = write_tum(make_track(("1L", "../2R", "..:2R")), folder / "track.tum")
    assert [file.name for file in files] == ["track.tum", "track-.._2R.tum", "track-.._2R-3.tum"]
    assert sorted(folder.iterdir()) == sorted(files)
    assert [np.loadtxt(file)[0, 2] for file in files] == [0.0, 1.0, 2.0]


def test_geojson_in_local_metres_says_so(tmp_path: Path) -> None:
    write_geojson(make_track(), tmp_path / "t.geojson")
    collection, (line,) = read_features(tmp_path / "t.geojson")
    assert "NOT longitude and latitude" in collection["crs_note"]
    assert collection["coordinate_unit"] == "metre"
    assert line["geometry"] == {"type": "LineString", "coordinates": [[0, 0], [0.7, 0], [1.4, 0], [2.1, 0]]}
    assert line["properties"]["steps"] == 3
    assert line["properties"]["distance_m"] == pytest.approx(2.1)


def test_geojson_with_origin_is_longitude_latitude_of_wgs84(tmp_path: Path) -> None:
    origin = GeoOrigin(48.0, 11.0)
    fix = PositionFix(12.0, np.array([0.0, 100.0]), np.diag([0.49, 4.0]), source="gps")
    write_geojson(make_track(), tmp_path / "t.geojson", origin, fixes=[fix])
    collection, (line, point) = read_features(tmp_path / "t.geojson")
    assert collection["coordinate_unit"] == "degree"
    latitude = math.radians(48.0)
    flatness = 1.0 - 6.69437999e-3 * math.sin(latitude) ** 2
    north_radius_m = 6378137.0 * (1.0 - 6.69437999e-3) / flatness**1.5
    east_radius_m = 6378137.0 / math.sqrt(flatness) * math.cos(latitude)
    lon, lat = line["geometry"]["coordinates"][-1]
    assert lon - 11.0 == pytest.approx(math.degrees(2.1 / east_radius_m), abs=2e-8)
    assert lat == pytest.approx(48.0, abs=1e-8)
    lon, lat = point["geometry"]["coordinates"]
    assert lat - 48.0 == pytest.approx(math.degrees(100.0 / north_radius_m), abs=2e-8)
    assert lon == pytest.approx(11.0, abs=1e-8)
    assert point["properties"] == {
        "feature": "fix",
        "source": "gps",
        "time_s": 12.0,
        "sigma_east_m": 0.7,
        "sigma_north_m": 2.0,
    }


def test_geojson_has_a_line_a_device_and_a_point_a_pose_when_asked(tmp_path: Path) -> None:
    write_geojson(make_track(("1L", "2R")), tmp_path / "t.geojson", with_steps=True)
    _, features = read_features(tmp_path / "t.geojson")
    lines = [f for f in features if f["geometry"]["type"] == "LineString"]
    points = [f for f in features if f["geometry"]["type"] == "Point"]
    assert [line["properties"]["device"] for line in lines] == ["1L", "2R"]
    assert len(points) == 8
    assert points[5]["properties"] == {
        "feature": "pose",
        "device": "2R",
        "time_s": 10.5,
        "heading_rad": pytest.approx(math.pi / 6, abs=1e-6),
        "sigma_heading_rad": 0.1,
        "cov_xx_m2": 0.04,
        "cov_xy_m2": 0.0,
        "cov_yy_m2": 0.04,
        "mode": "HOLDING",
        "step_length_m": 0.7,
    }


def test_geojson_of_a_single_pose_is_a_point_and_unknown_numbers_are_null(tmp_path: Path) -> None:
    track = make_track(count=1)
    unknown = Track(**{**track.__dict__, "step_length_m": np.array([np.nan])})
    write_geojson(unknown, tmp_path / "t.geojson", with_steps=True)
    _, (place, pose) = read_features(tmp_path / "t.geojson")
    assert place["geometry"] == {"type": "Point", "coordinates": [0.0, 0.0]}
    assert pose["properties"]["step_length_m"] is None


def test_steps_table_has_a_row_a_step_and_blanks_for_what_is_unknown(tmp_path: Path) -> None:
    steps = {"left, “old”": [make_step(0), make_step(1, math.nan, math.nan)], "right": [make_step(0)]}
    write_steps_csv(steps, tmp_path / "steps.csv")
    with (tmp_path / "steps.csv").open(encoding="utf-8", newline="") as stream:
        rows = list(csv.reader(stream))
    assert rows[0] == list(STEP_COLUMNS)
    assert rows[1][:6] == ["1.250000", "left, “old”", "0", "2", "SWING", "0.9688"]
    assert rows[1][6:] == ["JOGGING", "0.6250", "1.8000", "0.7000", "1.500000", "0.8750"]
    assert rows[2][6:8] == ["UNKNOWN", ""]
    assert rows[2][9:11] == ["", ""]
    assert [row[1] for row in rows[1:]] == ["left, “old”", "left, “old”", "right"]


def test_a_file_that_cannot_be_written_is_an_output_error_with_its_place(tmp_path: Path) -> None:
    missing = tmp_path / "nowhere" / "track"
    with pytest.raises(OutputError, match=r"nowhere.track: cannot be written"):
        write_geojson(make_track(), missing)
    with pytest.raises(OutputError, match=r"nowhere.track"):
        write_tum(make_track(), missing)
    with pytest.raises(OutputError, match=r"nowhere.track"):
        write_steps_csv({}, missing)
