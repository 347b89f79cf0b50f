"""The summary holds the numbers of the walk, and nothing that JSON cannot hold."""

import json
import math
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from pdr_est.estimators.person.track import fuse
from pdr_est.evaluate.consistency import radius95_m
from pdr_est.report.walk.descriptions import describe_length_scale
from pdr_est.report.walk.summary import package_versions, summarise, to_json
from pdr_est.types.findings import Finding, FindingKind
from pdr_est.types.measurements import HeadingPrior, StartPose
from pdr_est.types.sensors import Gap
from pdr_est.types.steps import CarryingMode
from pdr_est.types.track import concatenate

CONFIG = {"estimator": {"name": "factor-graph"}, "resample": {"rate_hz": 50.0}}


def strict(document: dict) -> dict:
    """Through JSON and back; NaN is refused."""
    return json.loads(json.dumps(document, allow_nan=False))


def test_counts_distance_and_duration_of_two_devices(make_walk) -> None:
    walk, recording = make_walk(steps=40, devices=("1L", "2R"))
    first = replace(
        walk.devices[0], gaps=(Gap("rotation_rate", 5.0, 6.5, "gap"),), dropped_samples={"rotation_rate": 3}
    )
    person = fuse(walk.track)
    walk = replace(walk, devices=(first, walk.devices[1]), track=concatenate([walk.track, person]))
    summary = strict(summarise(walk, recording, CONFIG, {"a.zip": "ab" * 32, "b": None}, {"python": "3"}))
    assert summary["counts"]["steps"] == {"1L": 40, "2R": 40}
    assert summary["counts"]["samples"]["1L"] == len(walk.devices[0].level[0])
    assert summary["counts"]["dropped_samples"] == {"1L": {"rotation_rate": 3}, "2R": {}}
    each = [device["distance_m"] for device in summary["devices"]]
    assert summary["distance_m"] == each[2] == pytest.approx(person.distance_m)  # of the walker
    assert summary["steps"] == len(person) - 1
    assert each[0] == pytest.approx(walk.track.of_device("1L").distance_m)
    level = walk.devices[0].level[0]
    assert summary["duration_s"] == pytest.approx(level.time_s[-1] - level.time_s[0])
    assert summary["gaps"] == [
        {"device": "1L", "channel": "rotation_rate", "start_s": 5.0, "end_s": 6.5, "reason": "gap"}
    ]
    assert summary["inputs"] == [{"name": "a.zip", "sha256": "ab" * 32}, {"name": "b", "sha256": None}]
    assert summary["config"] == CONFIG
    assert summary["length_scale"]["value"] == 1.034
    assert summary["length_scale"]["sigma"] == 0.012
    assert summary["fixes"] == {"given": 4, "used": 4, "aligned_with": 0, "sources": {"waypoint": 4}}
    assert summary["recording"]["time_zero"] == "2023-11-14T22:13:20.000+00:00"


def test_a_time_zero_that_is_no_date_is_not_known(make_walk) -> None:
    walk, recording = make_walk(steps=5)
    summary = strict(summarise(walk, replace(recording, epoch_s=6.4e11), CONFIG, {}, {}))
    assert summary["recording"]["time_zero"] is None


@pytest.mark.parametrize(
    ("start", "with_fixes", "frame"),
    [
        (None, False, "own"),
        (StartPose((1.0, 2.0), None), False, "own"),
        (StartPose(None, 0.3), False, "own"),
        (StartPose((1.0, 2.0), 0.3), False, "map"),
        (None, True, "map"),
    ],
)
def test_track_is_in_the_map_frame_only_when_something_ties_it(make_walk, start, with_fixes, frame) -> None:
    walk, recording = make_walk(steps=10)
    walk = walk if with_fixes else replace(walk, fixes=())
    assert summarise(walk, recording, {}, {}, {}, start=start)["frame"] == frame


@pytest.mark.parametrize(
    ("start", "frame"), [(None, "north-up"), (StartPose((1.0, 2.0), None), "map"), (StartPose(None, 0.3), "north-up")]
)
def test_a_phone_that_knows_north_needs_one_position_for_the_map_frame(make_walk, start, frame) -> None:
    walk, recording = make_walk(steps=10)
    (device,) = walk.devices
    north = HeadingPrior(device.device, 1.0, 0.2, 0.25)
    device = replace(device, odometry=(*device.odometry, north), whole_walk_odometry=(*device.odometry, north))
    assert summarise(replace(walk, fixes=(), devices=(device,)), recording, {}, {}, {}, start=start)["frame"] == frame
    relative = replace(
        device, odometry=(replace(north, relative=True),), whole_walk_odometry=(replace(north, relative=True),)
    )
    assert summarise(replace(walk, fixes=(), devices=(relative,)), recording, {}, {}, {})["frame"] == "own"


def test_findings_are_listed_with_all_that_is_known_of_them(make_walk) -> None:
    walk, recording = make_walk(steps=10)
    found = (
        Finding(FindingKind.FIX_CLOCK, "clock of gps 3 s late", "phone", 3.0, 9.0, np.float64(3.0), 0.4, False),
        Finding(FindingKind.NORTH, "north is disturbed", sigma=math.inf),
    )
    walk = replace(walk, track=replace(walk.track, findings=found))
    assert strict(summarise(walk, recording, {}, {}, {}))["findings"] == [
        {
            "kind": "fix-clock",
            "message": "clock of gps 3 s late",
            "device": "phone",
            "begin_s": 3.0,
            "end_s": 9.0,
            "value": 3.0,
            "sigma": 0.4,
            "doubtful": False,
        },
        {
            "kind": "north",
            "message": "north is disturbed",
            "device": "",
            "begin_s": None,
            "end_s": None,
            "value": None,
            "sigma": None,
            "doubtful": True,
        },
    ]


def test_warnings_are_those_of_the_walk_and_each_comes_once(make_walk) -> None:
    walk, recording = make_walk(steps=3)
    walk = replace(walk, warnings=("late fix", "phone: stuck", "late fix"))
    assert summarise(walk, recording, {}, {}, {})["warnings"] == ["late fix", "phone: stuck"]


def test_unknown_numbers_are_none(make_walk) -> None:
    walk, recording = make_walk(steps=0, with_truth=False)
    covariance = np.full((1, 2, 2), np.inf)
    walk = replace(walk, track=replace(walk.track, covariance_m2=covariance, sigma_length_scale=math.nan))
    summary = strict(summarise(walk, recording, {}, {}, {}, errors={"ate_rigid_m": np.float64("nan")}))
    assert summary["devices"][0]["end_radius95_m"] is None
    assert summary["devices"][0]["largest_radius95_m"] is None
    assert summary["length_scale"]["sigma"] is None
    assert summary["errors_against_truth"] == {"ate_rigid_m": None}
    assert summary["distance_m"] == 0.0


def test_radius_is_the_long_half_axis_of_the_95_percent_ellipse() -> None:
    turn = np.array([[0.6, -0.8], [0.8, 0.6]])
    covariance = np.array([turn @ np.diag([9.0, 1.0]) @ turn.T, np.zeros((2, 2)), np.full((2, 2), np.nan)])
    radius = radius95_m(covariance)
    # Rayleigh distribution: P(r < k sigma) = 1 - exp(-k^2 / 2) = 0.95.
    assert radius[:2] == pytest.approx([3.0 * math.sqrt(-2.0 * math.log(0.05)), 0.0])
    assert np.isnan(radius[2])


def test_records_arrays_enums_and_paths_have_a_json_form() -> None:
    @dataclass
    class Record:
        values: np.ndarray
        mode: CarryingMode

    record = Record(np.array([[1.0, np.inf]]), CarryingMode.SWING)
    assert to_json({"r": record, 3: np.int64(4), "p": Path("a"), "b": np.True_, "t": (None, "x")}) == {
        "r": {"values": [[1.0, None]], "mode": "SWING"},
        "3": 4,
        "p": "a",
        "b": True,
        "t": [None, "x"],
    }
    with pytest.raises(TypeError, match="complex has no JSON form"):
        to_json({"z": 1j})


def test_versions_name_the_libraries_that_shape_the_numbers() -> None:
    versions = package_versions()
    assert set(versions) == {"python", "pdr_est", "numpy", "scipy", "gtsam", "filterpy", "vqf"}
    assert versions["numpy"] == np.__version__


@pytest.mark.parametrize(
    ("scale", "sigma", "with_fixes", "with_profile", "words"),
    [
        (
            1.034,
            0.012,
            True,
            False,
            "estimated from the fixes: steps 3.4 % longer than those of the length model, ± 1.2 %",
        ),
        (0.95, 0.02, True, True, "estimated from the fixes: steps 5.0 % shorter than those of the profile, ± 2.0 %"),
        (1.0, 0.11, False, False, "not estimated without fixes: steps of the length model, ± 11.0 %"),
        (1.0, 0.06, False, True, "not estimated without fixes: steps of the profile, ± 6.0 %"),
        (1.0, math.nan, False, False, "not estimated without fixes: steps of the length model, ± unknown"),
    ],
)
def test_the_scale_in_words(make_walk, scale, sigma, with_fixes, with_profile, words) -> None:
    track = replace(make_walk()[0].track, length_scale=scale, sigma_length_scale=sigma)
    assert describe_length_scale(track, with_fixes, with_profile) == words


@pytest.mark.parametrize(
    ("start", "aligned_with"), [(None, 4), (StartPose((1.0, 2.0), None), 4), (StartPose((1.0, 2.0), 0.3), 0)]
)
def test_reckoned_tracks_are_aligned_with_fixes_and_do_not_use_them(make_walk, start, aligned_with) -> None:
    walk, recording = make_walk(steps=10)
    reckoned = replace(walk, track=replace(walk.track, estimator="map-general"), fixes_used=False)
    fixes = strict(summarise(reckoned, recording, CONFIG, {}, {}, start=start))["fixes"]
    assert fixes == {"given": 4, "used": 0, "aligned_with": aligned_with, "sources": {"waypoint": 4}}
