"""A track is placed on the Earth where position and north are known, with the uncertainty of its place."""

from dataclasses import replace

import numpy as np
import pytest

from pdr_est.config import Config
from pdr_est.report.walk.earth_placement import place_on_earth
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import GeoOrigin, Recording
from tests.support.walked_tracks import make_track

NOISE = Config().fixes
ORIGIN = GeoOrigin(48.0, 11.0)
TRACK = make_track(("left", "fused"))


def gps(time_s: float, east_m: float, sigma_m: float, source: str = "gps") -> PositionFix:
    return PositionFix(time_s, np.array([east_m, 5.0]), sigma_m**2 * np.eye(2), source=source)


def recorded(*fixes: PositionFix, origin: GeoOrigin | None = ORIGIN) -> Recording:
    return Recording("walk", "test", (), fixes=fixes, origin=origin)


def test_a_track_on_the_map_lies_about_the_origin_as_it_is() -> None:
    placed = place_on_earth(TRACK, "map", recorded(gps(10.0, 3.0, 4.0)), NOISE)
    assert placed.origin == ORIGIN
    assert placed.track is TRACK


def test_a_north_up_track_of_the_person_keeps_its_shape_and_goes_to_the_gps_positions() -> None:
    walked = TRACK.of_device("fused")
    shift_m = np.array([30.0, -20.0])
    positions = [replace(gps(t, 0.0, 4.0), position_m=walked.at(t)[0][0] + shift_m) for t in (10.0, 10.5, 11.0)]
    stale = gps(10.2, -400.0, 4.0)
    placed = place_on_earth(TRACK, "north-up", recorded(*positions, stale), NOISE)
    assert placed.origin == ORIGIN
    np.testing.assert_allclose(placed.track.position_m, TRACK.position_m + shift_m, atol=1e-9)
    added = placed.track.covariance_m2 - TRACK.covariance_m2
    assert (np.linalg.eigvalsh(added) > 2.5**2).all()  # more than the least wandering error of GPS
    assert "north-up, at the median of 4 GPS positions (standard deviation " in placed.meaning


def test_many_positions_make_the_place_no_better_known_than_the_best_of_them() -> None:
    one = place_on_earth(TRACK, "north-up", recorded(gps(10.5, 3.0, 4.0)), NOISE)
    many = place_on_earth(TRACK, "north-up", recorded(*[gps(10.5, 3.0, 4.0)] * 50), NOISE)
    np.testing.assert_allclose(many.track.covariance_m2, one.track.covariance_m2)


def test_a_position_weighs_less_where_it_or_the_track_is_vague() -> None:
    later = np.array([1, 1, 1, 1e5] * 2)[:, None, None]
    vague = replace(TRACK, covariance_m2=TRACK.covariance_m2 * later)
    fixes = gps(10.0, 3.0, 4.0), gps(11.4, 90.0, 4.0), gps(11.5, 90.0, 4.0), gps(10.1, 60.0, 90.0)
    placed = place_on_earth(vague, "north-up", recorded(*fixes), NOISE)
    (there,), _ = placed.track.of_device("fused").at(10.0)
    assert there[0] == pytest.approx(3.0)


@pytest.mark.parametrize(
    ("frame", "recording", "words"),
    [
        ("own", recorded(gps(10.0, 3.0, 4.0)), "north is unknown: give --fixes recording, or --start and --heading"),
        ("north-up", recorded(gps(10.0, 3.0, 4.0, "file")), "no GPS position in its time: give --start"),
        ("map", recorded(gps(10.0, 3.0, 4.0), origin=None), "no latitude and longitude: record GPS as well"),
    ],
)
def test_without_place_or_north_it_stays_and_says_why(frame: str, recording: Recording, words: str) -> None:
    placed = place_on_earth(TRACK, frame, recording, NOISE)
    assert placed.origin is None
    assert placed.track is TRACK
    assert words in placed.meaning
