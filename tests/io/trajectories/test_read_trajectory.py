"""Trajectories of every format: what is read, and what is refused with place, value and remedy."""

import gzip
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pdr_est.errors import RecordingError
from pdr_est.io.trajectories import Clock, Trajectory, read_trajectory

UNIX_S = 1_718_030_736.0


def saved(folder: Path, text: str, name: str = "track.csv") -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def collection(*features: dict[str, Any], **members: Any) -> str:
    return json.dumps({"type": "FeatureCollection", "features": features, **members})


def point(x: float, y: float, **properties: Any) -> dict[str, Any]:
    return {"type": "Feature", "geometry": {"type": "Point", "coordinates": [x, y]}, "properties": properties}


def gpx(*points: str, version: str = "1/1") -> str:
    rows = "".join(points)
    return (
        f'<?xml version="1.0"?><gpx xmlns="http://www.topografix.com/GPX/{version}" version="1.1">'
        f"<trk><name>walk</name><trkseg>{rows}</trkseg></trk></gpx>"
    )


def gpx_point(latitude: object, longitude: object, time: str) -> str:
    return f'<trkpt lat="{latitude}" lon="{longitude}"><ele>500</ele><time>{time}</time></trkpt>'


def same(read: Trajectory, time_s: list[float], position: list[list[float]]) -> None:
    np.testing.assert_allclose(read.time_s, time_s, rtol=0.0, atol=1e-6)
    np.testing.assert_allclose(read.position, position, rtol=0.0, atol=1e-12)


def test_tum(tmp_path: Path) -> None:
    text = "# a comment\n0.5 1 2 9 0 0 0 1\n\n1.5  3\t4 9 0 0 0.1 0.9\n"
    read = read_trajectory(saved(tmp_path, text, "track.txt"))
    same(read, [0.5, 1.5], [[1.0, 2.0], [3.0, 4.0]])
    assert (read.format, read.clock, read.in_degrees) == ("TUM", Clock.OWN, False)
    assert read.covariance_m2 is None
    assert read.notes == ()


def test_tum_of_nanoseconds_and_gzipped(tmp_path: Path) -> None:
    path = tmp_path / "track.tum.gz"
    path.write_bytes(gzip.compress(b"1718030736000000000 1 2 0\n1718030737500000000 3 4 0\n"))
    read = read_trajectory(path)
    same(read, [UNIX_S, UNIX_S + 1.5], [[1.0, 2.0], [3.0, 4.0]])
    assert read.clock is Clock.UNIX


def test_tum_with_covariances(tmp_path: Path) -> None:
    tail = "0 0 0 1 0 0 0 0 0 0.1 4 1 0 9 0 0"
    text = f"# timestamp(s) tx ty tz qx qy qz qw Pr11\n0.5 1 2 0 {tail}\n1.5 3 4 0 {tail}\n"
    read = read_trajectory(saved(tmp_path, text, "track.txt"))
    assert read.covariance_m2 is not None
    np.testing.assert_array_equal(read.covariance_m2, [[[4.0, 1.0], [1.0, 9.0]]] * 2)


def test_tum_with_y_up_is_told(tmp_path: Path) -> None:
    (note,) = read_trajectory(saved(tmp_path, "0 0 1.5 0\n1 1 1.6 5\n2 2 1.5 9\n", "arkit.tum")).notes
    assert "if y is up in this file" in note


@pytest.mark.parametrize(
    "text",
    [
        "timestamp,x,y,yaw,floor\n0.5,1,2,0.1,3\n1.5,3,4,0.2,3\n",
        "time (ms);x_m;y_m\n500;1,0;2,0\n1500;3,0;4,0\n",
        "t\teast [cm]\tnorth [cm]\n0.5\t100\t200\n1.5\t300\t400\n",
    ],
)
def test_tables_in_many_spellings(tmp_path: Path, text: str) -> None:
    read = read_trajectory(saved(tmp_path, text))
    same(read, [0.5, 1.5], [[1.0, 2.0], [3.0, 4.0]])
    assert read.format == "table"
    assert read.devices == ("track",)


def test_a_table_with_covariances_and_devices(tmp_path: Path) -> None:
    header = "time_s,device,x_m,y_m,heading_rad,cov_xx_m2,cov_xy_m2,cov_yy_m2\n"
    read = read_trajectory(saved(tmp_path, f"{header}0,a,1,2,0,4,1,9\n1,a,1,2,0,4,1,9\n0,b,5,6,0,1,0,1\n"))
    assert read.devices == ("a", "b")
    assert read.covariance_m2 is not None
    np.testing.assert_array_equal(read.covariance_m2[0], [[4.0, 1.0], [1.0, 9.0]])
    same(read.of_device("b"), [0.0], [[5.0, 6.0]])


def test_geojson_points_without_fixes(tmp_path: Path) -> None:
    text = collection(
        point(1.0, 2.0, feature="pose", time_s=0.5, device="phone"),
        point(7.0, 7.0, feature="fix", time_s=0.7),
        point(3.0, 4.0, feature="pose", time_s=1.5, device="phone"),
        coordinate_unit="metre",
    )
    read = read_trajectory(saved(tmp_path, text, "track.geojson"))
    same(read, [0.5, 1.5], [[1.0, 2.0], [3.0, 4.0]])
    assert (read.format, read.devices, read.in_degrees) == ("GeoJSON", ("phone",), False)


def test_a_geojson_line_with_times(tmp_path: Path) -> None:
    line = {"type": "LineString", "coordinates": [[11.5, 48.1], [11.6, 48.2, 500.0]]}
    times = ["2024-06-10T14:45:36Z", "2024-06-10T14:45:37.5Z"]
    feature = {"type": "Feature", "geometry": line, "properties": {"coordTimes": times, "name": "walk"}}
    read = read_trajectory(saved(tmp_path, collection(feature), "line.json"))
    same(read, [UNIX_S, UNIX_S + 1.5], [[48.1, 11.5], [48.2, 11.6]])
    assert (read.in_degrees, read.clock, read.devices) == (True, Clock.UNIX, ("walk",))


@pytest.mark.parametrize("version", ["1/0", "1/1"])
def test_gpx(tmp_path: Path, version: str) -> None:
    points = [
        gpx_point(48.1, 11.5, "2024-06-10T14:45:36Z"),
        gpx_point(48.2, 11.6, "2024-06-10T16:45:37.500+02:00"),
    ]
    read = read_trajectory(saved(tmp_path, gpx(*points, version=version), "walk.gpx"))
    same(read, [UNIX_S, UNIX_S + 1.5], [[48.1, 11.5], [48.2, 11.6]])
    assert (read.format, read.devices, read.clock) == ("GPX", ("walk",), Clock.UNIX)


def test_gpx_waypoints_where_there_is_no_track(tmp_path: Path) -> None:
    points = "".join(
        f'<wpt lat="48.{i}" lon="11.5"><time>2024-06-10T14:45:3{i}Z</time><name>corner {i}</name></wpt>'
        for i in (1, 2)
    )
    text = f'<gpx xmlns="http://www.topografix.com/GPX/1/1">{points}</gpx>'
    same(
        read_trajectory(saved(tmp_path, text, "w.gpx")),
        [UNIX_S - 5.0, UNIX_S - 4.0],
        [[48.1, 11.5], [48.2, 11.5]],
    )


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("a.tum", "0 1 2 0 0 0 0 1\n1 1 2 0 0 0 1\n", "line 2: 7 values instead of the 8 of TUM"),
        ("a.tum", "# c\n0 1 2 0\n1 1 two 0\n", "line 3: 'two' is not a number"),
        ("a.tum", "0 1 2 0\n1 nan 2 0\n", "line 2: time or position is missing"),
        ("a.tum", "0 1 2 0\n2 1 2 0\n1 1 2 0\n", "line 3: time 1.000 s is not after 2.000 s"),
        ("a.tum", "# nothing\n", "contains no position"),
        ("a.csv", "time_s,x_m,y_m\n0,1,2\n0,1,2\n", "line 3: time 0.000 s is not after 0.000 s"),
        ("a.csv", "time_s,x_m,y_m\n0,1,2\n1,,2\n", "line 3: time or position is missing"),
        ("a.csv", "time_s,x_m,y_m\n0,1,2\n1,a,2\n", "line 3, column 'x_m': 'a' is not a number"),
        ("a.csv", "time_s,x_m,y_m\n0,1,2\n1,1e12,2\n", "line 3: 1e+12, 2 is not a position in metres"),
        ("a.csv", "time_s,x_m\n0,1\n1,2\n", "needs the columns x_m and y_m"),
        ("a.csv", "time_s,latitude,longitude\n0,48,11\n1,148,11\n", "line 3: 148, 11 is not latitude and longitude"),
        ("a.csv", "time_s,x_m,y_m,sigma_m\n0,1,2,1\n1,1,2,-1\n", "line 3: sigma_m = -1"),
        (
            "a.csv",
            "time_s,x_m,y_m,cov_xx_m2,cov_xy_m2,cov_yy_m2\n0,1,2,1,0,1\n1,1,2,1,2,1\n",
            "line 3: covariance 1, 2, 1 is not positive semidefinite",
        ),
        ("a.csv", "0,1,2\n1,2,3\n", "no header line"),
        ("a.geojson", "{", "is no JSON"),
        ("a.geojson", "[1, 2]", "is no GeoJSON"),
        ("a.geojson", collection(point(1.0, 2.0)), "no point with a time"),
        ("a.geojson", collection(point(1.0, 2.0, time_s="soon")), "position 1, column 'time_s': 'soon' is neither"),
        ("a.gpx", "<gpx>", "is no XML that can be read"),
        ("a.gpx", "<kml></kml>", "is 'kml' and no GPX"),
        ("a.gpx", "<gpx></gpx>", "has neither track points nor waypoints"),
        ("a.gpx", gpx('<trkpt lat="1" lon="2"></trkpt>'), "trkpt 1: has no <time>"),
        (
            "a.gpx",
            gpx(gpx_point("north", 2, "2024-06-10T14:45:36Z")),
            "point 1: latitude_deg = 'north' is not a number",
        ),
        ("a.gpx", '<!DOCTYPE g [<!ENTITY a "b">]><gpx>&a;</gpx>', "is no XML that can be read"),
    ],
)
def test_refusals_name_place_value_and_remedy(tmp_path: Path, name: str, text: str, words: str) -> None:
    path = saved(tmp_path, text, name)
    with pytest.raises(RecordingError) as caught:
        read_trajectory(path)
    assert words in str(caught.value)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_missing_file_and_a_folder(tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match="no such file"):
        read_trajectory(tmp_path / "none.tum")
    for name in ("a", "b"):
        saved(tmp_path, "0 0 0 0\n", f"{name}.tum")
    with pytest.raises(RecordingError, match="contains 2 files"):
        read_trajectory(tmp_path)


PIECES = ("0", "1", ".", "-", "e", " ", "\n", ",", "<", "{", '"', "x", "time_s,x_m,y_m\n", "0 1 2 3\n", "[", "]", "}")


@settings(max_examples=60, deadline=None)
@given(st.lists(st.sampled_from(PIECES), max_size=25))
def test_anything_is_read_or_refused(tmp_path_factory: pytest.TempPathFactory, pieces: list[str]) -> None:
    path = saved(tmp_path_factory.getbasetemp(), "".join(pieces), "any.txt")
    try:
        read = read_trajectory(path)
    except RecordingError:
        return
    assert np.isfinite(read.position).all()
    assert (np.diff(read.time_s) > 0.0).all()
