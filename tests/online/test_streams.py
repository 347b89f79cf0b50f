"""Devices that stop, come back or come late, data that comes too late, and walks that never end."""

from dataclasses import replace

import numpy as np
import pytest
from test_tracker import FIXES, same_poses
from two_phones import (
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

from pdr_est.config import Config, EstimatorParams, StartParams
from pdr_est.errors import ConfigError, EstimationError
from pdr_est.estimators.fixed_lag.params import FixedLagParams
from pdr_est.front_end.step_noise import step_covariance
from pdr_est.online import OnlineParams, Tracker, track_of
from pdr_est.online.walk_estimator import WalkEstimator
from pdr_est.types.measurements import PositionFix, StepOdometry
from pdr_est.types.sensors import Channel

FIFTHS = [np.arange(0.2, 60.0, 0.2)] * 2


def test_a_device_that_stops_holds_nobody_back() -> None:
    recording = recorded(2)
    tracker, seen = tracker_of(recording, KNOWN_START, wait_s=1.0), []
    for name, block in slices(recording, FIFTHS):
        if name == "left" or block.time_s[-1] < 18.0:
            for update in tracker.push(name, block):
                seen.append((update.device, update.time_s))
    last_s = max(time_s for device, time_s in seen if device == "left")
    assert last_s > 28.0
    assert max(time_s for device, time_s in seen if device == "right") < 18.0


def test_what_a_device_missed_comes_back_in_its_place() -> None:
    """The radio of one phone was off for ten seconds; it sends all of them afterwards."""
    recording = recorded(2)
    tracker = tracker_of(recording, KNOWN_START)
    updates = push_all(tracker, radio_off(slices(recording, FIFTHS)))
    same_poses(updates, offline(recording, KNOWN_START))
    assert tracker.late_steps == 0


def test_steps_from_before_the_horizon_are_used_and_counted() -> None:
    recording = recorded(2)
    tracker = tracker_of(recording, KNOWN_START, horizon_s=5.0)
    first, second = ([(device.name, block) for block in device.blocks()] for device in recording.devices)
    chunks = slices(recording, FIFTHS)
    updates = push_all(tracker, [item for item in chunks if item[0] == "left"] + [*second])
    whole = offline(recording, KNOWN_START)
    assert len(first) == len(second)
    assert tracker.late_steps > 20
    assert len(track_of(of_devices(updates))) == len(whole)
    assert np.abs(track_of(of_devices(updates)).position_m - whole.position_m).max() < 1.5


@pytest.mark.slow
def test_a_device_that_nobody_expected_joins() -> None:
    recording = recorded(2)
    updates = push_all(Tracker(KNOWN_START), slices(recording, FIFTHS))
    same_poses(updates, offline(recording, KNOWN_START))


def test_a_fix_from_before_the_horizon_is_refused_and_counted() -> None:
    recording = recorded(1)
    tracker = tracker_of(recording, KNOWN_START, horizon_s=10.0)
    for name, block in slices(recording, FIFTHS[:1]):
        tracker.push(name, block)
    with pytest.warns(UserWarning, match=r"fix \(waypoint\) at 5.000 s came more than 10 s late.* 1 so far"):
        assert tracker.push_fix(fix_at(5.0, 3.0, 0.0)) == []
    assert tracker.refused_fixes == 1
    assert tracker.push_fix(fix_at(25.0, 12.0, 5.0)) != []


def test_a_fix_that_a_standing_device_cannot_use_is_told() -> None:
    """One phone lies on a table from 15 s on, the other one walks."""
    recording = recorded(2)
    tracker, lying = tracker_of(recording, KNOWN_START, horizon_s=5.0), {}
    for name, block in slices(recording, FIFTHS):
        if name == "right" and block.time_s[0] > 15.0:
            still = np.broadcast_to(lying[block.channel], block.values.shape)
            block = replace(block, values=still if block.channel is Channel.SPECIFIC_FORCE else 0.0 * still)
        elif name == "right":
            lying[block.channel] = block.values[-1]
        tracker.push(name, block)
    assert tracker.missed_fixes == 0
    with pytest.warns(UserWarning, match="not used for 1 of 2 devices"):
        assert tracker.push_fix(fix_at(tracker.now_s - 4.0, 14.0, 9.0)) != []
    assert tracker.missed_fixes == 1
    assert tracker.refused_fixes == 0


def test_nothing_is_taken_after_the_end_and_nothing_absurd_before() -> None:
    tracker = Tracker(KNOWN_START, ["a"])
    with pytest.raises(EstimationError, match="not positive definite"):
        tracker.push_fix(PositionFix(0.0, np.zeros(2), np.zeros((2, 2))))
    with pytest.raises(EstimationError, match="expected twice"):
        Tracker(KNOWN_START, ["a", "a"])
    with pytest.raises(EstimationError, match="the person is called that"):
        tracker.push("fused", next(iter(recorded(1).devices[0].blocks())))
    assert tracker.unheard == ("a",)
    assert tracker.flush() == []
    with pytest.raises(EstimationError, match="ended by flush"):
        tracker.flush()
    corridors = replace(KNOWN_START.heading, dominant=replace(KNOWN_START.heading.dominant, direction_rad=0.0))
    with pytest.raises(ConfigError, match="direction_rad"):
        Tracker(replace(KNOWN_START, heading=corridors))


def walked(hours: float, fix_every: int, start: StartParams, gap_every: int = 0) -> tuple[WalkEstimator, list[int]]:
    """Filter hours of steps of two devices; return the estimator, and how much it remembers after each 500 steps."""
    rng = np.random.default_rng(3)
    config = replace(ONE_CLOCK, estimator=EstimatorParams(name="fixed-lag", fixed_lag=FixedLagParams(lag_s=2.0)))
    estimator = WalkEstimator(replace(config, start=start), OnlineParams(remembered_steps=500))
    for _ in range(2):
        estimator.add_device()
    sizes = []
    for k in range(1, int(hours * 7200)):
        for device in range(2):
            turn = 0.05 * rng.standard_normal()
            covariance = step_covariance(0.7, 0.07, 0.1, 1.0 if gap_every and k % gap_every == 0 else 0.02)
            step = StepOdometry("", 0.5 * k + 0.01 * device, 0.5 * (k - 1), 0.7, turn, covariance)
            estimator.extend(device, (0.0, 0.5 * k + 0.02), [step], latency_s=0.0)
            if fix_every and k % fix_every == device:
                estimator.add_fix(fix_at(0.5 * k - 1.0, 0.0, 0.0, 50.0))
            estimator.take_filtered()
            while estimator.delayed_pending:
                estimator.take_delayed()
            estimator.forget(estimator.now_s - 60.0)
        if k % 500 == 0:
            sizes.append(estimator.remembered)
    return estimator, sizes


@pytest.mark.slow
@pytest.mark.parametrize("fix_every", [0, 40])
@pytest.mark.parametrize(
    "start", [StartParams(x_m=0.0, y_m=0.0, heading_rad=0.0), StartParams()], ids=["known", "open"]
)
@pytest.mark.parametrize("gap_every", [0, 300])
def test_memory_does_not_grow(fix_every: int, start: StartParams, gap_every: int) -> None:
    _, sizes = walked(0.5, fix_every, start, gap_every)
    assert max(sizes[3:]) <= 3800
    assert max(sizes[len(sizes) // 2 :]) <= 1.2 * max(sizes[: len(sizes) // 2]) + 50


@pytest.mark.slow
def test_a_first_fix_after_more_than_can_be_remembered() -> None:
    estimator, _ = walked(0.2, 0, StartParams())
    estimator.add_fix(fix_at(estimator.now_s - 1.0, 100.0, 50.0, 1.0))
    state = estimator.filter.state.walk.state_of(0)
    assert np.hypot(*(state.mean[:2] - [100.0, 50.0])) < 3.0
    assert np.isfinite(state.covariance).all()


@pytest.mark.slow
def test_delayed_estimates_survive_a_restart() -> None:
    recording = recorded(2)
    config: Config = replace(
        KNOWN_START, estimator=EstimatorParams(name="fixed-lag", fixed_lag=FixedLagParams(lag_s=4.0))
    )
    tracker, updates = tracker_of(recording, config), []
    for fix in FIXES:
        tracker.push_fix(fix)
    for number, (name, block) in enumerate(slices(recording, FIFTHS)):
        if number == 300:
            tracker = Tracker.restore(tracker.state())
        updates += tracker.push(name, block)
    updates += tracker.flush()
    track, whole = track_of(of_devices(updates), "delayed"), offline(recording, config, FIXES)
    assert track.position_m == pytest.approx(whole.position_m, abs=0.02)
