"""Regions of poses in the files and pages of a walk."""

import base64
import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from pdr_est.io.writers.geojson import write_geojson
from pdr_est.pipeline import SmoothedWalk
from pdr_est.report.plots.track import plot_track
from pdr_est.report.walk.explorer_data import explorer_data
from pdr_est.report.walk.map_extras import NO_EXTRAS
from pdr_est.report.walk.places import describe_places
from pdr_est.types.recording import Recording
from pdr_est.types.region import PoseRegion
from pdr_est.types.track import Track


def forked(track: Track) -> Track:
    """Give a track a region, of two places 12 m apart at its last pose."""
    region = PoseRegion.of_gaussians(track.position_m, track.covariance_m2)
    region.weight[-1, :2] = (0.75, 0.25)
    region.mean_m[-1, 1] = track.position_m[-1] + np.array([0.0, 12.0])
    region.covariance_m2[-1, :2] = np.eye(2)
    return replace(track, region=region)


@pytest.fixture
def walk(make_walk: Callable[..., tuple[SmoothedWalk, Recording]]) -> SmoothedWalk:
    """Walk of one device."""
    return make_walk(steps=40)[0]


def test_geojson_has_an_ellipse_for_each_place(walk: SmoothedWalk, tmp_path: Path) -> None:
    track = forked(walk.track)
    for name, one in (("with", track), ("without", walk.track)):
        write_geojson(one, tmp_path / name, with_steps=True)
    found = {
        name: [
            feature
            for feature in json.loads((tmp_path / name).read_text())["features"]
            if feature["properties"]["feature"] == "ellipse"
        ]
        for name in ("with", "without")
    }
    assert len(found["with"]) == len(found["without"]) + 1
    first, second = found["with"][-2:]
    assert (first["properties"]["weight"], second["properties"]["weight"]) == (0.75, 0.25)
    assert first["properties"]["time_s"] == second["properties"]["time_s"]
    assert "weight" not in found["without"][-1]["properties"]
    corners = np.array(second["geometry"]["coordinates"][0])
    assert corners[:-1].mean(axis=0) == pytest.approx(track.position_m[-1] + np.array([0.0, 12.0]), abs=0.01)


def test_the_page_gets_the_ellipses_of_poses_with_several_places_only(walk: SmoothedWalk) -> None:
    track = forked(walk.track)
    data = explorer_data(replace(walk, track=track), (), None, True, NO_EXTRAS)
    regions = data["devices"][-1]["regions"]
    assert len(base64.b64decode(regions["weight"]["data"])) == 2 * int(regions["weight"]["type"][1])
    assert base64.b64decode(regions["weight"]["data"]) == np.array([75, 25], dtype="<i1").tobytes()
    assert explorer_data(walk, (), None, True, NO_EXTRAS)["devices"][0]["regions"] is None


def test_the_picture_has_an_ellipse_for_each_place(walk: SmoothedWalk) -> None:
    def patches(track: Track) -> int:
        return len(plot_track(track).axes[0].patches)

    assert patches(forked(walk.track)) == patches(walk.track) + 2  # a shade and an edge


def test_the_summary_says_where_the_end_may_be(walk: SmoothedWalk) -> None:
    track = forked(walk.track)
    assert track.region is not None
    found = describe_places(track.region)
    assert found["share_of_poses_with_several"] == pytest.approx(1.0 / len(track))
    assert [place["probability"] for place in found["at_the_end"]] == [0.75, 0.25]
