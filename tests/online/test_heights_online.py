"""Height and floor while the walk is recorded: told in time, the same however the samples come, and bounded."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from buildings import Visit, pressure_of, visit
from two_phones import KNOWN_START, offline, push_all, slices, tracker_of

from pdr_est.front_end.height import HeightParams
from pdr_est.front_end.height.following import REVISED_S, HeightFollower
from pdr_est.front_end.height.seconds import Second, seconds_of
from pdr_est.online import Tracker, Update, track_of
from pdr_est.simulate import PathParams, preset, simulate_walk
from pdr_est.types.recording import Recording
from pdr_est.types.sensors import Channel


@cache
def over_floors() -> Recording:
    """The preset as far as the corner behind the lift: a storey up on stairs, then up by the lift."""
    scenario = preset("floors")
    path = PathParams(vertices_m=scenario.path.vertices_m[:3])
    gait = replace(scenario.gait, stretches=scenario.gait.stretches[:1])
    return simulate_walk(replace(scenario, path=path, gait=gait)).recording


@cache
def followed(seconds: float = 1.0) -> tuple[Update, ...]:
    recording = over_floors()
    cuts = [np.arange(seconds, 400.0, seconds)]
    return tuple(push_all(tracker_of(recording, KNOWN_START), slices(recording, cuts)))


def last_of_each(updates: tuple[Update, ...]) -> dict[float, tuple[object, ...]]:
    return {one.time_s: (one.height_m, one.sigma_height_m, one.floor, one.floor_probability) for one in updates}


def told_floors(walk: Visit, seed: int, pressed: bool = False) -> tuple[np.ndarray, np.ndarray]:
    """The floor that is told at the end of each second, and that end."""
    first, seconds = seconds_of(pressure_of(walk, seed, pressed), walk.step_time_s)
    follower, floors = HeightFollower(HeightParams()), []
    for number, second in enumerate(seconds, start=first):
        follower.add(number, second)
        assert follower.latest is not None
        floors.append(follower.latest.floor)
    return first + 1.0 + np.arange(len(floors)), np.array(floors)


@pytest.mark.slow
def test_changes_of_floor_are_told_within_five_seconds() -> None:
    late_s = []
    for seed in range(6):
        walk = visit(seed, 10.0)
        end_s, floors = told_floors(walk, seed, pressed=seed % 2 == 1)
        up = np.diff(floors)
        for place in np.flatnonzero(np.diff(walk.floor)):
            same_way = end_s[1:][np.sign(up) == np.sign(walk.floor[place + 1] - walk.floor[place])]
            late_s.append(np.abs(same_way - walk.time_s[place + 1]).min(initial=60.0))
    assert len(late_s) > 30
    assert np.mean(np.array(late_s) <= 5.0) >= 0.9


def test_no_floor_is_told_in_an_hour_on_the_flat() -> None:
    _, floors = told_floors(visit(20, 60.0, flat=True), 20, pressed=True)
    assert set(floors.tolist()) == {0}


def test_the_track_of_the_updates_has_the_heights_of_the_whole_recording() -> None:
    online, whole = track_of(followed()), offline(over_floors(), KNOWN_START)
    assert online.height is not None
    assert whole.height is not None
    expected = whole.height.nearest(online.height.time_s)
    sure = whole.height.floor_probability[expected] > 0.8  # the lift rises by 19 m: five storeys, or six
    assert set(online.height.floor[sure].tolist()) == {0, 1}
    assert np.mean(online.height.floor[sure] == whole.height.floor[expected][sure]) > 0.95
    off = (online.height.height_m - whole.height.height_m[expected]) / online.height.sigma_m
    assert np.abs(off).max() < 4.0
    assert np.mean(np.abs(off)) < 1.0


def test_updates_tell_the_new_floor_while_the_walker_is_on_the_way() -> None:
    """A walker on stairs is told on the next floor before the end of the flight and a few seconds more."""
    (up, *_) = [move for move in offline(over_floors(), KNOWN_START).height.moves if move.rise_m > 0.0]
    first_s = min(one.time_s for one in followed() if one.floor == 1)
    assert up.begin_s < first_s < up.end_s + 1.0


@pytest.mark.parametrize("seconds", [pytest.param(0.1, marks=pytest.mark.slow), 0.3, 7.0])
def test_the_cut_of_the_samples_does_not_change_the_last_update_of_a_pose(seconds: float) -> None:
    assert last_of_each(followed(seconds)) == last_of_each(followed())


@pytest.mark.slow
def test_updates_of_one_device_with_a_restart_between_are_the_same() -> None:
    recording = over_floors()
    tracker, updates = tracker_of(recording, KNOWN_START), []
    for number, (name, block) in enumerate(slices(recording, [np.arange(1.0, 400.0)])):
        if number % 97 == 96:
            tracker = Tracker.restore(tracker.state())
        updates += tracker.push(name, block)
    updates += tracker.flush()
    assert last_of_each(tuple(updates)) == last_of_each(followed())


def test_few_updates_come_again() -> None:
    assert len(followed()) < 1.7 * len(track_of(followed()))


def test_the_tracker_tells_the_height_between_steps() -> None:
    """In a lift there are no steps, and so no updates."""
    recording = over_floors()
    whole = offline(recording, KNOWN_START).height
    (ride,) = [move for move in whole.moves if move.kind == "lift"]
    tracker, told = tracker_of(recording, KNOWN_START), {}
    for name, block in slices(recording, [np.arange(1.0, 400.0)]):
        tracker.push(name, block)
        told[float(block.time_s[-1])] = tracker.height
    ends_s = np.array([ride.begin_s, ride.end_s + 5.0])
    before, after = (told[min(told, key=lambda time_s, at_s=at_s: abs(time_s - at_s))] for at_s in ends_s)
    assert after.floor > before.floor
    assert after.height_m - before.height_m == pytest.approx(ride.rise_m, abs=1.0)


def test_without_pressure_or_switched_off_nothing_is_told() -> None:
    recording = over_floors()
    blocks = slices(recording, [np.arange(1.0, 400.0)])
    quiet = [(name, block) for name, block in blocks if block.channel != Channel.PRESSURE]
    off = replace(KNOWN_START, height=HeightParams(enabled=False))
    for config, some in ((KNOWN_START, quiet), (off, blocks)):
        tracker = tracker_of(recording, config)
        updates = push_all(tracker, some)
        assert {one.floor for one in updates} == {None}
        assert track_of(updates).height is None
        assert tracker.height is None


def test_what_is_told_about_old_seconds_stays() -> None:
    first, seconds = seconds_of(pressure_of(visit(4, 10.0), 4), None)
    follower, settled = HeightFollower(HeightParams()), {}
    for number, second in enumerate(seconds, start=first):
        follower.add(number, second)
        settled[number - REVISED_S + 0.5] = follower.at(number - REVISED_S + 0.5)
    for time_s in list(settled)[REVISED_S + 1 :: 50]:
        assert follower.at(time_s) == settled[time_s]


@pytest.mark.slow
def test_memory_does_not_grow_with_the_walk() -> None:
    tracker, sizes = Tracker(KNOWN_START, ["phone"]), []
    (phone,) = over_floors().devices
    length_s = float(np.ceil(phone.specific_force.time_s[-1])) + 1.0
    for repetition in range(3):
        for _, block in slices(over_floors(), [np.arange(5.0, 400.0, 5.0)]):
            tracker.push("phone", replace(block, time_s=block.time_s + repetition * length_s))
        sizes.append(len(tracker.state()))
    assert sizes[2] < 1.15 * sizes[1]


def test_a_long_time_without_pressure_begins_anew_on_the_same_floor() -> None:
    first, seconds = seconds_of(pressure_of(visit(4, 4.0), 4), None)
    follower = HeightFollower(HeightParams())
    for number, second in enumerate(seconds, start=first):
        follower.add(number, second)
    before = follower.latest
    follower.add(first + 9000, Second(500.0, None))
    assert before is not None
    assert follower.latest is not None
    assert (follower.latest.floor, follower.latest.height_m) == (before.floor, before.height_m)
    assert follower.at(first + 5.0) is not None
