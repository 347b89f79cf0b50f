"""GeoJSON holds lines, fixes, and with times the poses and their ellipses, in degrees or in metres."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from pdr_est.errors import OutputError
from pdr_est.io.writers.geojson import write_geojson
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import GeoOrigin
from pdr_est.types.track import Track
from tests.support.walked_tracks import make_track


def read_features(path: Path) -> tuple[dict, list[dict]]:
    collection = json.loads(path.read_text(encoding="utf-8"))
    assert collection["type"] == "FeatureCollection"
    return collection, collection["features"]


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
        "time": None,
        "time_s": 12.0,
        "sigma_east_m": 0.7,
        "sigma_north_m": 2.0,
    }


def test_geojson_has_a_line_a_device_and_a_point_a_pose_when_asked(tmp_path: Path) -> None:
    write_geojson(make_track(("1L", "2R")), tmp_path / "t.geojson", epoch_s=1.7e9, with_steps=True)
    _, features = read_features(tmp_path / "t.geojson")
    lines = [f for f in features if f["geometry"]["type"] == "LineString"]
    points = [f for f in features if f["geometry"]["type"] == "Point"]
    assert [line["properties"]["device"] for line in lines] == ["1L", "2R"]
    assert len(points) == 8
    assert points[5]["properties"] == {
        "feature": "pose",
        "device": "2R",
        "time": "2023-11-14T22:13:30.500000Z",
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
    _, (place, pose, _) = read_features(tmp_path / "t.geojson")
    assert place["geometry"] == {"type": "Point", "coordinates": [0.0, 0.0]}
    assert pose["properties"]["step_length_m"] is None


def test_ellipses_are_closed_counter_clockwise_and_hold_95_percent(tmp_path: Path) -> None:
    covariance = np.array([[4.0, 1.5], [1.5, 1.0]])
    track = make_track()
    track = Track(**{**track.__dict__, "covariance_m2": np.tile(covariance, (4, 1, 1))})
    write_geojson(track, tmp_path / "t.geojson", epoch_s=0.0, with_steps=True)
    _, features = read_features(tmp_path / "t.geojson")
    ellipses = [one for one in features if one["properties"]["feature"] == "ellipse"]
    assert [one["properties"]["time"] for one in ellipses] == [
        f"1970-01-01T00:00:{10.0 + 0.5 * i:09.6f}Z" for i in range(4)
    ]
    for place, ellipse in zip(track.position_m, ellipses, strict=True):
        (ring,) = np.array(ellipse["geometry"]["coordinates"])
        assert ring[0].tolist() == ring[-1].tolist()
        x, y = ring.T
        area_m2 = 0.5 * np.sum(x[:-1] * y[1:] - x[1:] * y[:-1])
        whole_m2 = math.pi * 5.991 * math.sqrt(np.linalg.det(covariance))
        assert 0.97 * whole_m2 < area_m2 < whole_m2  # positive: counter-clockwise
        away = ring - place
        squared = np.einsum("ni,ij,nj->n", away, np.linalg.inv(covariance), away)
        np.testing.assert_allclose(squared, 5.991, rtol=3e-3)


@pytest.mark.parametrize("covariance", [np.zeros((2, 2)), np.full((2, 2), np.nan), 1e11 * np.eye(2)])
def test_an_ellipse_that_cannot_be_drawn_is_left_out(covariance, tmp_path: Path) -> None:
    track = make_track()
    track = Track(**{**track.__dict__, "covariance_m2": np.tile(covariance, (4, 1, 1))})
    write_geojson(track, tmp_path / "t.geojson", GeoOrigin(48.0, 11.0), with_steps=True)
    kinds = [one["properties"]["feature"] for one in read_features(tmp_path / "t.geojson")[1]]
    assert kinds == ["track", "pose", "pose", "pose", "pose"]


def test_a_file_that_cannot_be_written_is_an_output_error_with_its_place(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match=r"nowhere.track: cannot be written"):
        write_geojson(make_track(), tmp_path / "nowhere" / "track")
