"""A tracker that is saved and restored at any point goes on as if nothing had happened; what comes at the end."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from test_tracker import same_poses
from two_phones import KNOWN_START, ONE_CLOCK, fix_at, offline, push_all, recorded, slices, tracker_of

from pdr_est.config import Config, EstimatorParams
from pdr_est.errors import EstimationError
from pdr_est.estimators.fixed_lag.params import FixedLagParams
from pdr_est.online import Tracker, Update, track_of
from pdr_est.types.sensors import Channel, SensorBlock
from pdr_est.types.track import Track

FIXES = [fix_at(2.0, 0.8, 0.2), fix_at(8.4, 5.0, 1.5)]


@cache
def expected(open_start: bool) -> Track:
    return offline(recorded(2, gap=True, short=True), ONE_CLOCK if open_start else KNOWN_START, FIXES)


@pytest.mark.parametrize("examples", [4, pytest.param(12, marks=pytest.mark.slow)])
def test_restored_at_any_point_of_any_cut(examples: int) -> None:
    @settings(max_examples=examples, deadline=None)
    @given(st.data(), st.booleans())
    def goes_on(data: st.DataObject, open_start: bool) -> None:
        recording = recorded(2, gap=True, short=True)
        cuts = [np.sort(data.draw(st.lists(st.floats(0.0, 13.0), min_size=1, max_size=12))) for _ in range(2)]
        blocks = slices(recording, cuts)
        saved_at = data.draw(st.sets(st.integers(0, len(blocks) - 1), min_size=1, max_size=3))
        tracker, updates = tracker_of(recording, ONE_CLOCK if open_start else KNOWN_START), []
        for fix in FIXES:
            tracker.push_fix(fix)
        for number, (name, block) in enumerate(blocks):
            if number in saved_at:
                tracker = Tracker.restore(tracker.state())
            updates += tracker.push(name, block)
        same_poses([*updates, *tracker.flush()], expected(open_start))

    goes_on()


def test_saving_changes_nothing_and_two_restored_trackers_are_alike() -> None:
    recording = recorded(1, short=True)
    blocks = slices(recording, [np.arange(1.0, 13.0)])
    tracker = tracker_of(recording, KNOWN_START)
    for name, block in blocks[: len(blocks) // 2]:
        tracker.push(name, block)
    state = tracker.state()
    rest = blocks[len(blocks) // 2 :]
    ends = [push_all(one, rest) for one in (tracker, Tracker.restore(state), Tracker.restore(state))]
    assert repr(ends[0]) == repr(ends[1]) == repr(ends[2])
    assert len(ends[0]) > 3


@pytest.mark.parametrize("config", [ONE_CLOCK, KNOWN_START, KNOWN_START.with_estimator("fixed-lag")])
def test_devices_that_stay_silent_leave_nothing_at_the_end(config: Config) -> None:
    tracker = Tracker(config, ["a", "b"])
    assert tracker.push_fix(fix_at(1.0, 0.0, 0.0)) == []
    tracker.push("a", SensorBlock(Channel.SPECIFIC_FORCE, np.array([0.0]), np.array([[0.0, 0.0, 9.8]])))
    assert tracker.flush() == []
    assert tracker.unheard == ("a", "b")
    assert tracker.now_s == -np.inf


@pytest.mark.parametrize("devices", [1, 2])
def test_a_second_flush_is_refused_and_the_first_gave_everything(devices: int) -> None:
    recording = recorded(devices, short=True)
    tracker = tracker_of(recording, KNOWN_START)
    updates = push_all(tracker, slices(recording, [np.arange(1.0, 13.0)] * devices))
    for again in (tracker, Tracker.restore(tracker.state())):
        with pytest.raises(EstimationError, match="ended by flush"):
            again.flush()
        with pytest.raises(EstimationError, match="ended by flush"):
            again.push_fix(fix_at(1.0, 0.0, 0.0))
    same_poses(updates, offline(recording, KNOWN_START))


def first_seen(tracker: Tracker, blocks: list[tuple[str, SensorBlock]], kind: str) -> dict[tuple[str, float], float]:
    """Data time of the device at which the first update of each pose came, before the end."""
    found: dict[tuple[str, float], float] = {}
    ends_s: dict[str, float] = {}
    for name, block in blocks:
        ends_s[name] = max(ends_s.get(name, 0.0), float(block.time_s[-1]))
        for update in tracker.push(name, block):
            if update.kind == kind and update.device in ends_s:
                found.setdefault((update.device, update.time_s), ends_s[update.device])
    return found


@pytest.mark.parametrize("devices", [1, pytest.param(2, marks=pytest.mark.slow)])
def test_filtered_poses_come_within_the_declared_latency(devices: int) -> None:
    recording, block_s = recorded(devices), 0.1
    tracker = tracker_of(recording, KNOWN_START)
    blocks = slices(recording, [np.arange(block_s, 60.0, block_s)] * devices)
    seen = first_seen(tracker, blocks, "filtered")
    pause_s = (8.0, 15.5)  # the last step before a standstill waits for the step that follows
    waited_s = [came_s - time_s for (_, time_s), came_s in seen.items() if not pause_s[0] < time_s < pause_s[1]]
    assert len(waited_s) > 25 * devices
    assert 0.2 < max(waited_s) <= tracker.latency_s + 2.0 * block_s


def test_delayed_poses_come_within_the_declared_lag() -> None:
    recording, lagged = recorded(1), EstimatorParams(name="fixed-lag", fixed_lag=FixedLagParams(lag_s=3.0))
    tracker = tracker_of(recording, replace(KNOWN_START, estimator=lagged), settle_s=2.0)
    assert tracker.lag_s == 5.0
    assert tracker_of(recording, KNOWN_START).lag_s is None
    seen = first_seen(tracker, slices(recording, [np.arange(0.2, 60.0, 0.2)]), "delayed")
    waited_s = np.array([came_s - time_s for (_, time_s), came_s in seen.items() if time_s > 16.0])
    assert len(waited_s) > 3
    # A pose comes with the first step that lies a lag behind it, which is known a latency later.
    assert waited_s.min() > tracker.lag_s
    assert waited_s.max() <= tracker.lag_s + tracker.latency_s + 2.0


def test_the_last_update_of_a_pose_counts() -> None:
    updates: list[Update] = []
    recording = recorded(1, short=True)
    tracker = tracker_of(recording, KNOWN_START)
    for name, block in slices(recording, [np.arange(0.5, 13.0, 0.5)]):
        updates += tracker.push(name, block)
    before = track_of(updates)
    updates += tracker.push_fix(fix_at(tracker.now_s - 1.0, 4.0, 3.0, 0.1))
    after = track_of(updates)
    assert after.time_s.tolist() == before.time_s.tolist()
    assert np.hypot(*(after.position_m[-1] - before.position_m[-1])) > 0.01
    assert np.array_equal(after.position_m[:3], before.position_m[:3])
