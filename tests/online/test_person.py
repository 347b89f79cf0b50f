"""The person whom several devices follow: what covariance intersection of the devices' tracks gives, in any cut."""

from dataclasses import replace

import numpy as np
import pytest
from test_tracker import FIXES
from two_phones import (
    FUSED,
    KNOWN_START,
    ONE_CLOCK,
    fix_at,
    of_devices,
    offline,
    push_all,
    radio_off,
    recorded,
    slices,
    tracker_of,
)

from pdr_est.config import Config, EstimatorParams
from pdr_est.estimators.common.nodes import Node
from pdr_est.estimators.fixed_lag.params import FixedLagParams
from pdr_est.frames import wrap_angle
from pdr_est.online import Update, track_of
from pdr_est.online.person_estimates import DeviceCoverage, PersonEstimates
from pdr_est.online.walk_estimator import FilteredPose
from pdr_est.types.steps import CarryingMode
from pdr_est.types.track import Track

SECONDS = [np.arange(1.0, 60.0)] * 2
FIFTHS = [np.arange(0.2, 60.0, 0.2)] * 2


def of_person(updates: list[Update], kind: str = "filtered") -> Track:
    track = track_of(updates, kind).of_device(FUSED)  # type: ignore[arg-type]
    assert len(track), "no pose of the person"
    return track


def same(track: Track, other: Track) -> None:
    assert track.time_s.tolist() == other.time_s.tolist()
    for name in ("position_m", "heading_rad", "covariance_m2", "sigma_heading_rad", "mode", "moving_from_s"):
        assert np.array_equal(getattr(track, name), getattr(other, name)), name


def in_seconds(config: Config, gap: bool = False, fixes: tuple = (), short: bool = False) -> Track:
    recording = recorded(2, gap, short)
    tracker = tracker_of(recording, config)
    for fix in fixes:
        tracker.push_fix(fix)
    return of_person(push_all(tracker, slices(recording, SECONDS)))


def test_it_is_the_covariance_intersection_of_the_devices_tracks() -> None:
    """Of two estimates with equal weights, in the form of Julier and Uhlmann."""
    found, devices = in_seconds(KNOWN_START), offline(recorded(2), KNOWN_START)
    left, right = (devices.of_device(name) for name in ("left", "right"))
    assert found.time_s.tolist() == np.union1d(left.time_s, right.time_s).tolist()
    inside = (found.time_s > max(left.time_s[0], right.time_s[0])) & (
        found.time_s < min(left.time_s[-1], right.time_s[-1])
    )
    (a, a_spread), (b, b_spread) = left.at(found.time_s), right.at(found.time_s)
    information = 0.5 * (np.linalg.inv(a_spread) + np.linalg.inv(b_spread))
    mean = np.einsum("nij,nj->ni", np.linalg.inv(a_spread), a) + np.einsum("nij,nj->ni", np.linalg.inv(b_spread), b)
    joined = np.einsum("nij,nj->ni", np.linalg.inv(information), 0.5 * mean)
    assert found.position_m[inside] == pytest.approx(joined[inside], abs=1e-5)
    assert found.covariance_m2[inside] == pytest.approx(np.linalg.inv(information)[inside], abs=1e-6)
    between = np.abs(
        wrap_angle(found.heading_rad - np.interp(found.time_s, left.time_s, np.unwrap(left.heading_rad)))
    )
    assert between[inside].max() < 0.5


@pytest.mark.parametrize(
    ("config", "fixes", "gap"),
    [
        pytest.param(config, fixes, gap, marks=[] if gap and fixes and config is ONE_CLOCK else pytest.mark.slow)
        for config in (ONE_CLOCK, KNOWN_START)
        for fixes in ((), tuple(FIXES))
        for gap in (False, True)
    ],
)
def test_any_cut_gives_the_same(gap: bool, fixes: tuple, config: Config) -> None:
    recording, rng = recorded(2, gap), np.random.default_rng(7)
    cuts = [np.sort(rng.uniform(0.0, 60.0, count)) for count in (30, 200)]
    tracker = tracker_of(recording, config, wait_s=float(rng.choice([0.0, 3.0])))
    for fix in fixes:
        tracker.push_fix(fix)
    same(of_person(push_all(tracker, slices(recording, cuts))), in_seconds(config, gap, fixes))


@pytest.mark.slow
def test_sample_by_sample_and_device_by_device_are_the_same() -> None:
    recording = recorded(2, gap=True, short=True)
    whole = in_seconds(KNOWN_START, gap=True, short=True)
    singles = slices(recording, [np.arange(0.0, 60.0, 0.005)] * 2)
    assert max(len(block.time_s) for _, block in singles) == 1
    same(of_person(push_all(tracker_of(recording, KNOWN_START), singles)), whole)
    tracker = tracker_of(recording, KNOWN_START, horizon_s=100.0)
    blocks = [(device.name, block) for device in recording.devices for block in device.blocks()]
    same(of_person(push_all(tracker, blocks)), whole)


@pytest.mark.slow
def test_late_fixes_and_late_data_take_their_place() -> None:
    recording = recorded(2)
    tracker, updates, waiting = tracker_of(recording, KNOWN_START), [], list(FIXES)
    for name, block in radio_off(slices(recording, FIFTHS)):
        while waiting and float(block.time_s[-1]) > waiting[0].time_s + 5.0:
            updates += tracker.push_fix(waiting.pop(0))
        updates += tracker.push(name, block)
    for fix in waiting:
        updates += tracker.push_fix(fix)
    same(of_person([*updates, *tracker.flush()]), in_seconds(KNOWN_START, fixes=tuple(FIXES)))


def test_each_pose_comes_soon_after_that_of_the_device() -> None:
    """It waits for the next steps of the others, and where they stand for a few seconds."""
    recording = recorded(2)
    tracker, first, of_device = tracker_of(recording, KNOWN_START), {}, {}
    for name, block in slices(recording, FIFTHS):
        for update in tracker.push(name, block):
            seen = first if update.device == FUSED else of_device
            seen.setdefault(update.time_s, float(block.time_s[-1]))
    waited_s = [came_s - of_device[time_s] for time_s, came_s in first.items()]
    assert len(waited_s) > 60
    assert min(waited_s) > -0.3  # time stamps of two devices
    assert max(waited_s) < 5.0
    assert np.median(waited_s) < 0.7


def test_a_device_that_stopped_has_no_say() -> None:
    recording = recorded(2)
    blocks = [item for item in slices(recording, FIFTHS) if item[0] == "left" or item[1].time_s[-1] < 18.0]
    updates = push_all(tracker_of(recording, KNOWN_START), blocks)
    left, person = (track_of(updates).of_device(name) for name in ("left", FUSED))
    after = left.time_s > 18.5
    assert after.sum() > 15
    rows = np.searchsorted(person.time_s, left.time_s[after])
    assert person.position_m[rows] == pytest.approx(left.position_m[after], abs=1e-4)


def test_one_device_has_no_person_beside_it() -> None:
    recording = recorded(1)
    updates = push_all(tracker_of(recording, KNOWN_START), slices(recording, SECONDS[:1]))
    assert of_devices(updates) == updates


def device_pose(device: int, time_s: float) -> FilteredPose:
    node = Node(time_s, time_s - 0.5, 0.7, 0.0, np.zeros((3, 3)), True, 0.7, CarryingMode.HOLDING)
    return FilteredPose(device, node, np.array([1.4 * time_s, 0.0, 0.0]), 0.01 * np.eye(3), (1.0, 0.1))


@pytest.mark.parametrize("devices", [1, 2])
def test_poses_that_nobody_asks_for_are_forgotten(devices: int) -> None:
    """A single device has no person, so its poses are never asked for; with two devices they are."""
    person = PersonEstimates("filtered")
    for k in range(400):
        person.add([device_pose(device, 0.5 * k + 0.1 * device) for device in range(devices)], devices)
        if devices > 1:
            person.give([DeviceCoverage([(0.0, 0.5 * k)], 0.5 * k)] * devices, 0.5 * k - 2.0)
        person.forget(0.5 * k - 5.0)
        assert person.remembered <= 12 * devices


@pytest.mark.slow
def test_delayed_poses_are_joined_too() -> None:
    recording = recorded(2)
    config = replace(KNOWN_START, estimator=EstimatorParams(name="fixed-lag", fixed_lag=FixedLagParams(lag_s=4.0)))
    tracker = tracker_of(recording, config)
    tracker.push_fix(fix_at(20.0, 14.0, 2.0))
    updates = push_all(tracker, slices(recording, FIFTHS))
    filtered, delayed = of_person(updates), of_person(updates, "delayed")
    assert filtered.time_s.tolist() == delayed.time_s.tolist()
    left = track_of(updates, "delayed").of_device("left")
    assert np.abs(delayed.at(left.time_s)[0] - left.position_m).max() < 1.5
    before_fix = (delayed.time_s > 17.0) & (delayed.time_s < 19.5)
    spread = [np.trace(track.covariance_m2[before_fix], axis1=1, axis2=2) for track in (delayed, filtered)]
    assert (spread[0] < 0.9 * spread[1]).all()
