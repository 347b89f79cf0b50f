"""Backgrounds are read, and placed where they lie in the frame of the track."""

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from pymap3d import enu2geodetic

from pdr_est.errors import ConfigError, PdrError, RecordingError
from pdr_est.report.background.kinds import LineBackground, NetworkTiles, PictureBackground, TileFolder
from pdr_est.report.background.placement import MapPlacement, from_degrees, map_placement
from pdr_est.report.background.reading import read_background
from pdr_est.report.walk.earth_placement import EarthPlacement
from pdr_est.types.recording import GeoOrigin

ORIGIN = GeoOrigin(48.2, 11.6)
LOW_M, HIGH_M = np.zeros(2), np.array([50.0, 30.0])
AT_HOME = MapPlacement(np.array([100.0, 10.0]), ORIGIN, "")


def write_plan(folder: Path, world: str = "0.5\n0\n0\n-0.5\n0.25\n19.75\n", name: str = "plan.png") -> Path:
    path = folder / name
    Image.new("RGB", (80, 40)).save(path)
    path.with_suffix(".pgw").write_text(world)
    return path


def test_degrees_near_the_origin_are_right_to_a_decimetre() -> None:
    east_north = np.array([[700.0, -300.0], [-1000.0, 0.0], [0.0, 1000.0], [-600.0, 700.0]])
    latitude, longitude, _ = enu2geodetic(*east_north.T, 0.0, ORIGIN.latitude_deg, ORIGIN.longitude_deg, 0.0)
    found = from_degrees(np.column_stack([longitude, latitude]), ORIGIN)
    assert np.linalg.norm(found - east_north, axis=1).max() < 0.15


def test_a_picture_lies_where_its_world_file_says(tmp_path: Path) -> None:
    read = read_background(str(write_plan(tmp_path)))
    assert isinstance(read, PictureBackground)
    placed = read.placed(AT_HOME, LOW_M, HIGH_M)
    assert placed["corner_m"] == [-100.0, 10.0]  # the corner at (0, 20) of the map
    assert placed["pixel_m"] == [0.5, -0.5]
    assert placed["url"].startswith("data:image/png;base64,")


def test_a_picture_in_degrees_needs_a_place_on_the_earth(tmp_path: Path) -> None:
    read = read_background(str(write_plan(tmp_path, "1e-5\n0\n0\n-1e-5\n11.600005\n48.199995\n")))
    placed = read.placed(AT_HOME, LOW_M, HIGH_M)
    assert placed["corner_m"] == pytest.approx([-100.0, -10.0], abs=1e-6)
    assert placed["pixel_m"] == pytest.approx([0.743, -1.112], abs=2e-3)
    with pytest.raises(RecordingError, match="cannot be placed below the track: north is unknown"):
        read.placed(MapPlacement(np.zeros(2), None, "north is unknown"), LOW_M, HIGH_M)


@pytest.mark.parametrize(
    ("world", "words"),
    [
        ("0.5\n0.1\n0\n-0.5\n0\n0\n", "turns or mirrors"),
        ("0.5\n0\n0\n0.5\n0\n0\n", "turns or mirrors"),
        ("0.5\n0\n0\n-0.5\n0\n", "six lines"),
        ("0.5\n0\n0\n-0.5\n0\nnan\n", "finite"),
        ("half\n", "is no world file"),
    ],
)
def test_a_world_file_that_cannot_be_used_is_refused(tmp_path: Path, world: str, words: str) -> None:
    with pytest.raises(RecordingError, match=words):
        read_background(str(write_plan(tmp_path, world)))


def test_a_picture_without_a_world_file_says_what_to_write(tmp_path: Path) -> None:
    path = write_plan(tmp_path)
    path.with_suffix(".pgw").unlink()
    with pytest.raises(RecordingError, match=r"write a world file plan\.pgw beside it"):
        read_background(str(path))


def square(unit: str | None) -> dict:
    ring = [[0, 0], [10, 0], [10, 5], [0, 0]]
    features = [
        {"type": "Feature", "geometry": {"type": "Polygon", "coordinates": [ring]}},
        {"type": "Feature", "geometry": {"type": "MultiLineString", "coordinates": [[[1, 1, 7], [2, 2, 7]]]}},
        {"type": "Feature", "geometry": {"type": "Point", "coordinates": [3, 3]}},
        {"type": "Feature", "geometry": None},
    ]
    return {"type": "FeatureCollection", "features": features} | ({"coordinate_unit": unit} if unit else {})


def test_geojson_gives_lines_in_metres_or_degrees(tmp_path: Path) -> None:
    path = tmp_path / "walls.geojson"
    path.write_text(json.dumps(square("metre")))
    metres = read_background(str(path))
    assert isinstance(metres, LineBackground)
    assert [len(line) for line in metres.lines] == [4, 2]
    assert not metres.in_degrees
    assert metres.placed(AT_HOME, LOW_M, HIGH_M)["kind"] == "lines"
    path.write_text(json.dumps(square(None)))
    assert read_background(str(path)).in_degrees


@pytest.mark.parametrize(
    "text", ["{", "[]", "7", '{"type": "Feature"}', '{"type": "LineString", "coordinates": [["a", 1]]}']
)
def test_damaged_geojson_is_refused(tmp_path: Path, text: str) -> None:
    path = tmp_path / "walls.geojson"
    path.write_text(text)
    with pytest.raises(RecordingError, match="is no GeoJSON"):
        read_background(str(path))


def test_the_finest_tiles_that_are_few_enough_become_part_of_the_page(tmp_path: Path) -> None:
    for zoom in (15, 18, 19, 30):  # at zoom 30 the place would need far too many
        for x in range(int((11.6 + 180) / 360 * 2**zoom) - 3, int((11.6 + 180) / 360 * 2**zoom) + 4):
            (tmp_path / str(zoom) / str(x)).mkdir(parents=True)
    latitude, (longitude, zoom) = math.radians(48.2), (11.6 + 120.0 / 74_300.0, 18)
    y = int((1 - math.log(math.tan(latitude) + 1 / math.cos(latitude)) / math.pi) / 2 * 2**zoom)
    x = int((longitude + 180) / 360 * 2**zoom)
    Image.new("RGB", (8, 8)).save(tmp_path / f"{zoom}/{x}/{y}.png")
    placed = TileFolder(tmp_path).placed(AT_HOME, LOW_M, HIGH_M)
    assert list(placed["tiles"]) == [f"{zoom}/{x}/{y}"]
    assert placed["zooms"] == [18, 18]
    with pytest.raises(RecordingError, match="holds no tile where the track lies"):
        TileFolder(tmp_path).placed(MapPlacement(np.zeros(2), GeoOrigin(-48.2, 11.6), ""), LOW_M, HIGH_M)


def test_network_tiles_widen_the_policy_to_one_host() -> None:
    read = read_background("https://tile.example.org:8443/a/{z}/{x}/{y}.png")
    assert isinstance(read, NetworkTiles)
    assert read.image_hosts == ("https://tile.example.org:8443",)
    assert read.placed(AT_HOME, LOW_M, HIGH_M)["credit"] == "Map: tile.example.org"


@pytest.mark.parametrize(
    "text",
    [
        "https://tile.example.org/{z}/{x}.png",
        "ftp://tile.example.org/{z}/{x}/{y}.png",
        "https://a.org; script-src *//{z}/{x}/{y}.png",
        "https://a.org/{z}/{x}/{y}.png'\"><script>",
        "plan.dwg",
        "missing.png",
    ],
)
def test_what_is_no_background_is_refused(text: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "plan.dwg").write_text("")
    with pytest.raises((ConfigError, RecordingError), match=r"give"):
        read_background(text)


def test_a_track_shifted_to_the_earth_carries_the_shift_to_the_map(make_walk) -> None:
    walk, recording = make_walk(steps=20)
    moved = replace(walk.track, position_m=walk.track.position_m + np.array([3.0, -4.0]))
    earth = EarthPlacement(moved, ORIGIN, "")
    assert map_placement(walk.track, "north-up", recording, earth).shift_m == pytest.approx([3.0, -4.0])
    unknown = EarthPlacement(walk.track, None, "north is unknown")
    assert map_placement(walk.track, "map", recording, unknown).shift_m.tolist() == [0.0, 0.0]
    turned = map_placement(walk.track, "own", recording, unknown)
    with pytest.raises(PdrError, match="north is unknown"):
        LineBackground((LOW_M[None],)).placed(turned, LOW_M, HIGH_M)
