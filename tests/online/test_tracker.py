"""The tracker gives what the filter gives on the whole recording, however its samples come."""

from dataclasses import replace

import numpy as np
import pytest
from two_phones import KNOWN_START, ONE_CLOCK, fix_at, of_devices, offline, push_all, recorded, slices, tracker_of

from pdr_est.config import Config, EstimatorParams
from pdr_est.errors import EstimationError
from pdr_est.estimators import EstimatorName
from pdr_est.estimators.fixed_lag.params import FixedLagParams
from pdr_est.online import Tracker, Update, track_of
from pdr_est.preprocessing.trim import trim_recording
from pdr_est.types.recording import Recording
from pdr_est.types.track import Track

# The third and the fourth while the walker stands.
FIXES = [
    fix_at(1.5, 0.0, 0.3),
    fix_at(7.13, 6.0, 0.2),
    fix_at(11.2, 9.2, 0.1),
    fix_at(13.0, 8.9, 0.1),
    fix_at(26.02, 14.0, 6.0),
]
MORE_LATE_FIXES = [(1, 14.0), (1, 0.0), (1, 3.0), (2, 0.0), (2, 14.0)]


def same_poses(updates: list[Update], whole: Track) -> None:
    track = track_of(of_devices(updates))
    order = np.lexsort((track.time_s, track.device))
    expected = np.lexsort((whole.time_s, whole.device))
    assert track.time_s[order].tolist() == whole.time_s[expected].tolist()
    for name in (
        "device",
        "position_m",
        "heading_rad",
        "covariance_m2",
        "sigma_heading_rad",
        "mode",
        "moving_from_s",
    ):
        assert np.array_equal(getattr(track, name)[order], getattr(whole, name)[expected]), name


@pytest.mark.parametrize(
    ("devices", "config", "fixes"),
    [
        pytest.param(1, ONE_CLOCK, FIXES, id="1-open-fixes"),
        pytest.param(2, ONE_CLOCK, [], id="2-open-bare"),
        pytest.param(2, KNOWN_START, FIXES, id="2-known-fixes"),
        pytest.param(1, ONE_CLOCK, [], id="1-open-bare", marks=pytest.mark.slow),
        pytest.param(1, KNOWN_START, [], id="1-known-bare", marks=pytest.mark.slow),
        pytest.param(1, KNOWN_START, FIXES, id="1-known-fixes", marks=pytest.mark.slow),
        pytest.param(2, ONE_CLOCK, FIXES, id="2-open-fixes", marks=pytest.mark.slow),
        pytest.param(2, KNOWN_START, [], id="2-known-bare", marks=pytest.mark.slow),
    ],
)
def test_whole_seconds_equal_the_filter(devices: int, config: Config, fixes: list) -> None:
    recording = recorded(devices)
    tracker = tracker_of(recording, config)
    for fix in fixes:
        tracker.push_fix(fix)
    updates = push_all(tracker, slices(recording, [np.arange(1.0, 60.0)] * devices))
    same_poses(updates, offline(recording, config, fixes))


@pytest.mark.parametrize("seed", [0, *(pytest.param(seed, marks=pytest.mark.slow) for seed in (1, 2))])
def test_any_cut_and_interleaving_gives_the_same(seed: int) -> None:
    recording, rng = recorded(2, gap=True), np.random.default_rng(seed)
    cuts = [np.sort(rng.uniform(0.0, 60.0, count)) for count in (40, 300)]
    tracker = tracker_of(recording, ONE_CLOCK, wait_s=float(rng.choice([0.0, 1.0, 20.0])))
    for fix in FIXES:
        tracker.push_fix(fix)
    same_poses(push_all(tracker, slices(recording, cuts)), offline(recording, ONE_CLOCK, FIXES))


def test_one_device_after_the_other_gives_the_same() -> None:
    recording = recorded(2, gap=True)
    tracker = tracker_of(recording, KNOWN_START, horizon_s=100.0)
    blocks = [(device.name, block) for device in recording.devices for block in device.blocks()]
    same_poses(push_all(tracker, blocks), offline(recording, KNOWN_START))


@pytest.mark.slow
def test_one_sample_at_a_time_with_a_restart_between() -> None:
    recording = recorded(2, gap=True, short=True)
    blocks = slices(recording, [np.arange(0.0, 60.0, 0.005)] * 2)
    assert max(len(block.time_s) for _, block in blocks) == 1
    tracker, updates = tracker_of(recording, KNOWN_START), []
    for number, (name, block) in enumerate(blocks):
        if number % 1000 == 500:
            tracker = Tracker.restore(tracker.state())
        updates += tracker.push(name, block)
    updates += tracker.flush()
    same_poses(updates, offline(recording, KNOWN_START))


@pytest.mark.parametrize("config", [ONE_CLOCK, KNOWN_START], ids=["open", "known"])
@pytest.mark.parametrize(
    ("devices", "late_s"),
    [(2, 3.0), *(pytest.param(*case, marks=pytest.mark.slow) for case in MORE_LATE_FIXES)],
)
def test_fixes_that_come_late_take_their_place(config: Config, devices: int, late_s: float) -> None:
    recording = recorded(devices, gap=True)
    tracker, updates, waiting = tracker_of(recording, config), [], list(FIXES)
    for name, block in slices(recording, [np.arange(0.2, 60.0, 0.2)] * devices):
        while waiting and float(block.time_s[-1]) > waiting[0].time_s + late_s:
            updates += tracker.push_fix(waiting.pop(0))
        updates += tracker.push(name, block)
    for fix in waiting:
        updates += tracker.push_fix(fix)
    updates += tracker.flush()
    same_poses(updates, offline(recording, config, FIXES))
    assert tracker.refused_fixes == 0


@pytest.mark.parametrize(
    ("devices", "late"),
    [
        (1, False),
        pytest.param(2, True, marks=pytest.mark.slow),
        pytest.param(1, True, marks=pytest.mark.slow),
        pytest.param(2, False, marks=pytest.mark.slow),
    ],
)
def test_delayed_estimates_are_those_of_the_smoother(devices: int, late: bool) -> None:
    recording = recorded(devices)
    config = replace(KNOWN_START, estimator=EstimatorParams(name="fixed-lag", fixed_lag=FixedLagParams(lag_s=4.0)))
    tracker, updates = tracker_of(recording, config), []
    waiting = list(FIXES)
    for name, block in slices(recording, [np.arange(0.2, 60.0, 0.2)] * devices):
        while waiting and (not late or float(block.time_s[-1]) > waiting[0].time_s + 3.0):
            updates += tracker.push_fix(waiting.pop(0))
        updates += tracker.push(name, block)
    updates += tracker.flush()
    same_poses(updates, offline(recording, config.with_estimator("ekf"), FIXES))
    track, whole = track_of(of_devices(updates), "delayed"), offline(recording, config, FIXES)
    assert track.time_s.tolist() == whole.time_s.tolist()
    assert track.position_m == pytest.approx(whole.position_m, abs=0.02)
    assert track.covariance_m2 == pytest.approx(whole.covariance_m2, rel=0.02, abs=5e-3)
    delayed = [(update.device, update.time_s) for update in updates if update.kind == "delayed"]
    assert len(set(delayed)) == len(delayed)


def test_a_fix_that_cannot_be_used_takes_nothing_with_it() -> None:
    """Work that waits behind single samples is not lost when a fix is refused in between."""
    recording = recorded(1, short=True)
    tracker, updates = tracker_of(recording, KNOWN_START), []
    for number, (name, block) in enumerate(slices(recording, [np.arange(0.0, 60.0, 0.005)])):
        updates += tracker.push(name, block)
        if number % 7 == 0:
            with pytest.raises(EstimationError, match="not positive definite"):
                tracker.push_fix(replace(fix_at(1.0, 0.0, 0.0), covariance_m2=np.zeros((2, 2))))
    same_poses([*updates, *tracker.flush()], offline(recording, KNOWN_START))


def devices_started_late(recording: Recording, late_s: float) -> Recording:
    """The second phone records from then on."""
    first, second = recording.devices
    (late,) = trim_recording(replace(recording, devices=(second,)), late_s).devices
    return replace(recording, devices=(first, late))


@pytest.mark.parametrize("config", [ONE_CLOCK, KNOWN_START], ids=["open", "known"])
@pytest.mark.parametrize("fixes", [[], FIXES], ids=["bare", "fixes"])
def test_a_phone_that_begins_late_is_the_same_online(config: Config, fixes: list) -> None:
    recording, rng = devices_started_late(recorded(2, gap=True), 17.3), np.random.default_rng(4)
    tracker = tracker_of(recording, config)
    for fix in fixes:
        tracker.push_fix(fix)
    updates = push_all(tracker, slices(recording, [np.sort(rng.uniform(0.0, 60.0, count)) for count in (40, 200)]))
    same_poses(updates, offline(recording, config, fixes))


@pytest.mark.parametrize("name", ["ekf", "fixed-lag"])
def test_a_phone_that_begins_late_begins_where_the_other_one_is(name: EstimatorName) -> None:
    recording, config = recorded(2), KNOWN_START.with_estimator(name)
    whole, late = offline(recording, config), offline(devices_started_late(recording, 17.3), config)
    first, second = (late.of_device(device) for device in ("left", "right"))
    assert second.time_s[0] == pytest.approx(17.3, abs=0.1)
    assert np.linalg.norm(second.position_m[0] - first.at(second.time_s[:1])[0][0]) < 1.0
    assert np.linalg.norm(second.position_m[0]) > 8.0
    assert np.trace(second.covariance_m2[0]) > 0.5  # nobody knows better
    for device, one in (("left", first), ("right", second)):
        apart_m = np.linalg.norm(one.position_m[1:] - whole.of_device(device).at(one.time_s[1:])[0], axis=1)
        assert apart_m.max() < 1.5, device
