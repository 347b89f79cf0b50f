"""KML, GPX and GeoJSON hold the same places and times as the track, whatever the names of walk and devices are."""

import json
import math
from datetime import UTC, datetime, timedelta
from pathlib import Path
from tempfile import TemporaryDirectory
from xml.etree.ElementTree import Element

import numpy as np
import pytest
from defusedxml.ElementTree import parse
from hypothesis import given, settings
from hypothesis import strategies as st

from pdr_est.errors import OutputError
from pdr_est.io.writers.geodesy import utc_texts
from pdr_est.io.writers.geojson import write_geojson
from pdr_est.io.writers.gpx import write_gpx
from pdr_est.io.writers.kml import write_kml
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import GeoOrigin
from pdr_est.types.track import Track
from tests.support.walked_tracks import make_track

KML, GX = "{http://www.opengis.net/kml/2.2}", "{http://www.google.com/kml/ext/2.2}"
GPX = "{http://www.topografix.com/GPX/1/1}"
EPOCH_S = 1_718_028_185.25
MUNICH = GeoOrigin(48.137, 11.575)
FIX = PositionFix(12.0, np.array([-30.0, 100.0]), np.diag([4.0, 9.0]), source="gps <&> \x07")
ODD = 'a <b> & "c" \x00\x1b\ufffe \N{SNOWMAN}'
CLEAN = 'a <b> & "c" \\u0000\\u001b\N{REPLACEMENT CHARACTER} ☃'


def in_space(longitude_deg: float, latitude_deg: float) -> np.ndarray:
    """Cartesian coordinates of a point of the WGS 84 ellipsoid."""
    lon, lat, squared = math.radians(longitude_deg), math.radians(latitude_deg), 6.69437999014e-3
    radius = 6378137.0 / math.sqrt(1.0 - squared * math.sin(lat) ** 2)
    away = radius * math.cos(lat)
    return np.array([away * math.cos(lon), away * math.sin(lon), radius * (1.0 - squared) * math.sin(lat)])


def metres(longitude_deg: float, latitude_deg: float, origin: GeoOrigin) -> list[float]:
    """Metres east and north of an origin, in the plane that touches the ellipsoid there."""
    lon, lat = math.radians(origin.longitude_deg), math.radians(origin.latitude_deg)
    away = in_space(longitude_deg, latitude_deg) - in_space(origin.longitude_deg, origin.latitude_deg)
    east = [-math.sin(lon), math.cos(lon), 0.0]
    north = [-math.sin(lat) * math.cos(lon), -math.sin(lat) * math.sin(lon), math.cos(lat)]
    return [float(away @ east), float(away @ north)]


def seconds(date: str, epoch_s: float) -> float:
    assert date.endswith("Z")
    since = datetime.fromisoformat(date) - datetime(1970, 1, 1, tzinfo=UTC)
    return (since - timedelta(seconds=epoch_s)) / timedelta(seconds=1)


def kml_track(place: Element, origin: GeoOrigin, epoch_s: float) -> tuple[list[float], np.ndarray]:
    shape = place.find(f"{GX}Track")
    assert shape is not None
    assert shape.findtext(f"{KML}altitudeMode") == "clampToGround"
    coordinates = [[float(x) for x in str(one.text).split()] for one in shape.findall(f"{GX}coord")]
    times = [seconds(str(one.text), epoch_s) for one in shape.findall(f"{KML}when")]
    return times, np.array([metres(x, y, origin) for x, y, _ in coordinates])


def gpx_points(parent: Element, tag: str, origin: GeoOrigin, epoch_s: float) -> tuple[list[float], np.ndarray]:
    points = parent.findall(f"{GPX}{tag}")
    times = [seconds(str(one.findtext(f"{GPX}time")), epoch_s) for one in points]
    return times, np.array([metres(float(one.attrib["lon"]), float(one.attrib["lat"]), origin) for one in points])


def test_kml_has_a_timed_track_a_device_and_the_fixes(tmp_path: Path) -> None:
    track = make_track((ODD, "2R"))
    write_kml(track, tmp_path / "t.kml", MUNICH, fixes=[FIX], epoch_s=EPOCH_S, name=ODD)
    document = parse(tmp_path / "t.kml").getroot().find(f"{KML}Document")
    assert document.findtext(f"{KML}name") == CLEAN
    left, right = document.findall(f"{KML}Placemark")
    assert (left.findtext(f"{KML}name"), right.findtext(f"{KML}name")) == (CLEAN, "2R")
    times, places = kml_track(right, MUNICH, EPOCH_S)
    np.testing.assert_allclose(times, track.of_device("2R").time_s, atol=1e-9)
    np.testing.assert_allclose(places, track.of_device("2R").position_m, atol=0.01)
    angles = [float(str(one.text).split()[0]) for one in right.iter(f"{GX}angles")]
    np.testing.assert_allclose(angles, [90.0, 60.0, 30.0, 0.0], atol=0.01)  # from east to north
    arrays = {one.attrib["name"]: [v.text for v in one] for one in right.iter(f"{GX}SimpleArrayData")}
    assert arrays == {"radius95_m": ["0.49"] * 4, "mode": ["HOLDING"] * 4}
    folder = document.find(f"{KML}Folder")
    fix = folder.find(f"{KML}Placemark")
    assert fix.findtext(f"{KML}name") == r"gps <&> \u0007"
    assert seconds(fix.findtext(f"{KML}TimeStamp/{KML}when"), EPOCH_S) == 12.0
    x, y, _ = map(float, fix.findtext(f"{KML}Point/{KML}coordinates").split(","))
    np.testing.assert_allclose(metres(x, y, MUNICH), FIX.position_m, atol=0.01)


def test_gpx_has_a_track_a_device_and_a_waypoint_a_fix(tmp_path: Path) -> None:
    track = make_track((ODD, "2R"))
    write_gpx(track, tmp_path / "t.gpx", MUNICH, fixes=[FIX], epoch_s=EPOCH_S, name=ODD)
    root = parse(tmp_path / "t.gpx").getroot()
    assert root.tag == f"{GPX}gpx"
    assert root.attrib["version"] == "1.1"
    assert [one.tag.removeprefix(GPX) for one in root] == ["metadata", "wpt", "trk", "trk"]  # the schema's order
    assert [one.tag.removeprefix(GPX) for one in root[0]] == ["name", "desc", "time"]
    assert root.findtext(f"{GPX}metadata/{GPX}name") == CLEAN
    times, places = gpx_points(root, "wpt", MUNICH, EPOCH_S)
    assert times == [12.0]
    np.testing.assert_allclose(places, [FIX.position_m], atol=0.01)
    left, right = root.findall(f"{GPX}trk")
    assert left.findtext(f"{GPX}name") == CLEAN
    times, places = gpx_points(right.find(f"{GPX}trkseg"), "trkpt", MUNICH, EPOCH_S)
    np.testing.assert_allclose(times, track.of_device("2R").time_s, atol=1e-9)
    np.testing.assert_allclose(places, track.of_device("2R").position_m, atol=0.01)


@pytest.mark.parametrize("count", [1, 4])
def test_without_a_date_there_are_no_times_and_the_file_says_so(count: int, tmp_path: Path) -> None:
    track = make_track(count=count)
    write_kml(track, tmp_path / "t.kml", MUNICH, fixes=[FIX])
    write_gpx(track, tmp_path / "t.gpx", MUNICH, fixes=[FIX])
    document = parse(tmp_path / "t.kml").getroot().find(f"{KML}Document")
    assert "there are no times" in document.findtext(f"{KML}description")
    assert list(document.iter(f"{KML}when")) == []
    shape = document.find(f"{KML}Placemark/{KML}{'Point' if count == 1 else 'LineString'}")
    coordinates = [list(map(float, one.split(","))) for one in shape.findtext(f"{KML}coordinates").split()]
    np.testing.assert_allclose([metres(x, y, MUNICH) for x, y, _ in coordinates], track.position_m, atol=0.01)
    root = parse(tmp_path / "t.gpx").getroot()
    assert "there are no times" in root.findtext(f"{GPX}metadata/{GPX}desc")
    assert list(root.iter(f"{GPX}time")) == []
    assert len(list(root.iter(f"{GPX}trkpt"))) == count


@settings(max_examples=30, deadline=None)
@given(
    latitude_deg=st.floats(-80.0, 80.0),
    longitude_deg=st.floats(-180.0, 180.0),
    far_m=st.tuples(st.floats(-500.0, 500.0), st.floats(-500.0, 500.0)),
    epoch_s=st.floats(0.0, 4e9),
    name=st.text(),
)
def test_any_walk_comes_back_from_every_file(latitude_deg, longitude_deg, far_m, epoch_s, name) -> None:
    origin, walked = GeoOrigin(latitude_deg, longitude_deg), make_track()
    track = Track(**{**walked.__dict__, "position_m": walked.position_m + np.array(far_m)})
    with TemporaryDirectory() as folder:
        kml, gpx, geojson = (Path(folder) / f"t.{suffix}" for suffix in ("kml", "gpx", "geojson"))
        write_geojson(track, geojson, origin, epoch_s=epoch_s, with_steps=True)
        features = json.loads(geojson.read_text(encoding="utf-8"))["features"]
        write_kml(track, kml, origin, epoch_s=epoch_s, name=name)
        write_gpx(track, gpx, origin, epoch_s=epoch_s, name=name)
        place = parse(kml).getroot().find(f"{KML}Document/{KML}Placemark")
        segment = parse(gpx).getroot().find(f"{GPX}trk/{GPX}trkseg")
    poses = [one for one in features if one["properties"]["feature"] == "pose"]
    for times, places in (
        (
            [seconds(one["properties"]["time"], epoch_s) for one in poses],
            np.array([metres(*one["geometry"]["coordinates"], origin) for one in poses]),
        ),
        kml_track(place, origin, epoch_s),
        gpx_points(segment, "trkpt", origin, epoch_s),
    ):
        np.testing.assert_allclose(times, track.time_s, atol=1.1e-6)
        np.testing.assert_allclose(places, track.position_m, atol=0.01)


def test_dates_that_no_calendar_has_are_unknown() -> None:
    assert utc_texts(np.array([0.0, 0.25]), 86400.0) == ["1970-01-02T00:00:00.000000Z", "1970-01-02T00:00:00.250000Z"]
    assert utc_texts(np.zeros(1), None) is None
    assert utc_texts(np.zeros(1), 1e15) is None
    assert utc_texts(np.zeros(1), math.nan) is None


@pytest.mark.parametrize("write", [write_kml, write_gpx])
def test_a_file_that_cannot_be_written_is_an_output_error_with_its_place(write, tmp_path: Path) -> None:
    with pytest.raises(OutputError, match=r"nowhere.track: cannot be written"):
        write(make_track(), tmp_path / "nowhere" / "track", MUNICH)
