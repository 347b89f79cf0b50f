"""Events in any order: the filter that rewinds ends where the offline filter does, to the last bit."""

import pickle
from dataclasses import replace

import numpy as np
import pytest
from event_streams import (
    EAST,
    LATENCY_S,
    Block,
    Event,
    Follower,
    Walk,
    assert_same,
    estimator_of,
    fix_at,
    follow,
    in_time_order,
    offline,
    walk_of,
    wandering_fix,
    with_placements,
)
from hypothesis import example, given, settings
from hypothesis import strategies as st

from pdr_est.online.filter_history import tethered_devices
from pdr_est.types.measurements import PositionFix, StartPose, StepOdometry

STARTS = [EAST, StartPose(), StartPose((1.0, 2.0)), StartPose(heading_rad=0.3)]
seeds = st.integers(0, 10_000)


def random_walk(rng: np.random.Generator) -> Walk:
    devices = int(rng.integers(1, 4))
    walk = walk_of(
        rng,
        devices,
        seconds=float(rng.uniform(5.0, 20.0)),
        begins_s=[0.0, *rng.choice([0.0, 0.4, 7.5], 2)],
        lost_headings=bool(rng.random() < 0.3),
        fixes_s=sorted(rng.uniform(-1.0, 22.0, rng.choice([0, 1, 4]))),
        start=STARTS[rng.integers(len(STARTS))],
    )
    ends_s = [m.time_s for own in walk.devices for m in own]
    special_s = [*rng.choice(ends_s, 1), *[fix.time_s for fix in walk.fixes[:1]]]  # a step's end, a time taken twice
    more = [fix_at(float(s), 1.4 * s, rng.normal()) for s in special_s if rng.random() < 0.4]
    return replace(walk, fixes=(*walk.fixes, *more))


def with_doubts(walk: Walk, rng: np.random.Generator) -> Walk:
    """Let most fixes have wandering errors, and phones be put elsewhere."""
    fixes = tuple(wandering_fix(fix) if rng.random() < 0.7 else fix for fix in walk.fixes)
    return with_placements(replace(walk, fixes=fixes), rng, 0.08)


def shuffled(walk: Walk, rng: np.random.Generator) -> list[Event]:
    """Each device in its own order, at random against the others and the fixes."""
    queues: list[list[Event]] = [
        list(walk.blocks(d, rng.uniform(0.0, 22.0, rng.integers(0, 12)))) for d in range(len(walk.devices))
    ]
    for time_s in {fix.time_s for fix in walk.fixes}:  # fixes of one time keep their order, which counts
        queues.append([fix for fix in walk.fixes if fix.time_s == time_s])
    events = []
    while queues:
        queue = queues[rng.integers(len(queues))]
        events.append(queue.pop(0))
        queues = [queue for queue in queues if queue]
    return events


@settings(max_examples=20, deadline=None)
@given(seeds)
@example(1851)  # a tether of two devices after the third one has lost its heading
def test_events_in_any_order_give_the_offline_filter(seed: int) -> None:
    rng = np.random.default_rng(seed)
    walk = random_walk(rng)
    wait_s = float(rng.choice([0.0, 1.0, 5.0]))
    assert_same(follow(walk, shuffled(walk, rng), wait_s=wait_s, horizon_s=1000.0), offline(walk))


@settings(max_examples=12, deadline=None)
@given(seeds)
@pytest.mark.slow
def test_wandering_errors_and_open_turns_are_taken_back_like_poses(seed: int) -> None:
    rng = np.random.default_rng(seed)
    walk = with_doubts(random_walk(rng), rng)
    assert_same(follow(walk, shuffled(walk, rng), horizon_s=1000.0), offline(walk))


@pytest.mark.slow
@settings(max_examples=12, deadline=None)
@given(seeds, st.floats(0.0, 1.0), st.booleans())
@example(2018, 0.0, True)  # a fix that is averaged with one which belongs to a step that is known later
def test_an_estimator_restored_at_any_point_goes_on_as_before(seed: int, share: float, doubts: bool) -> None:
    rng = np.random.default_rng(seed)
    walk = random_walk(rng)
    walk = with_doubts(walk, rng) if doubts else walk
    events = shuffled(walk, rng)
    follower = Follower(walk, estimator_of(walk, horizon_s=1000.0))
    for number, event in enumerate(events):
        if number == int(share * len(events)):
            follower.estimator = pickle.loads(pickle.dumps(follower.estimator))
        follower.take(event)
    assert_same(follower.finish(), offline(walk))


def with_lost_heading(walk: Walk, number: int) -> tuple[Walk, float]:
    """Let a step of the first device have a turn that leaves nothing of the heading; return its time as well."""
    step = [m for m in walk.devices[0] if isinstance(m, StepOdometry)][number]
    turned = replace(step, covariance=step.covariance + np.diag([0.0, 0.0, 1.0]))
    own = tuple(turned if one is step else one for one in walk.devices[0])
    return replace(walk, devices=(own, *walk.devices[1:])), step.time_s


def test_blocks_of_two_devices_that_are_late_in_turn() -> None:
    """Each device sends nothing for six seconds, then everything at once, while the other one goes on."""
    walk = walk_of(np.random.default_rng(1), 2, 20.0)
    cuts_s = np.arange(0.5, 22.0, 0.5)
    held = {0: (4.0, 10.0), 1: (12.0, 18.0)}

    def comes_s(block: Block) -> float:
        from_s, to_s = held[block.device]
        return to_s if from_s < block.end_s < to_s else block.end_s

    events = sorted([*walk.blocks(0, cuts_s), *walk.blocks(1, cuts_s)], key=comes_s)
    follower = follow(walk, events, wait_s=1.0, horizon_s=30.0)
    assert_same(follower, offline(walk))
    assert follower.estimator.filter.late_steps == 0


@pytest.mark.parametrize("comes_s", [-np.inf, 4.0, 9.0, 15.0, np.inf], ids=str)
@pytest.mark.parametrize("devices", [1, 2])
@pytest.mark.parametrize("start", [EAST, StartPose()], ids=["known", "open"])
def test_a_fix_may_come_at_any_time(comes_s: float, devices: int, start: StartPose) -> None:
    walk = walk_of(np.random.default_rng(2), devices, 18.0, start=start, fixes_s=[0.5, 5.1, 13.3])
    blocks = [event for event in in_time_order(walk) if isinstance(event, Block)]
    late = [block for block in blocks if block.end_s > comes_s]
    events: list[Event] = [*blocks[: len(blocks) - len(late)], *walk.fixes, *late]
    assert_same(follow(walk, events, horizon_s=100.0), offline(walk))


@pytest.mark.parametrize("after_s", [1.0, 8.0, 14.0])
def test_a_fix_after_a_long_standstill_applies_to_the_last_step(after_s: float) -> None:
    """The walker stands from 6 s on; nobody can tell until the samples say so."""
    walk = walk_of(np.random.default_rng(3), 1, 6.0, pauses=False)
    last_s = walk.devices[0][-1].time_s
    fix = PositionFix(last_s + after_s, np.array([9.0, 1.0]), np.eye(2))
    walk = Walk(walk.devices, walk.begins_s, (last_s + 20.0,), (fix,))
    follower = Follower(walk, estimator_of(walk, horizon_s=5.0))
    for event in in_time_order(walk):
        changed = follower.take(event)
        if event is fix:
            assert changed == 0  # a step that ends later may still come
    assert_same(follower.finish(), offline(walk))
    assert follower.estimator.filter.missed_fixes == 0


def test_the_last_step_of_a_single_device_is_kept_for_fixes_while_it_stands() -> None:
    """Everything comes in one block, which ends with a standstill longer than the horizon."""
    walk = walk_of(np.random.default_rng(20), 1, 6.0, pauses=False)
    last_s = walk.devices[0][-1].time_s
    fix = fix_at(last_s + 16.0, 9.0, 1.0)
    walk = Walk(walk.devices, walk.begins_s, (last_s + 20.0,), (fix,))
    follower = Follower(walk, estimator_of(walk, horizon_s=5.0))
    follower.take(*walk.blocks(0, []))
    assert follower.take(fix) >= 1
    assert follower.estimator.filter.missed_fixes == 0
    assert_same(follower.finish(), offline(walk))


def test_a_fix_waits_as_long_as_a_step_may_still_come() -> None:
    """A step that ended half a second ago is not known yet, and would take the fix."""
    walk = walk_of(np.random.default_rng(21), 1, 6.0, pauses=False)
    follower = Follower(walk, estimator_of(walk))
    last_s = walk.devices[0][-1].time_s
    follower.take(Block(0, last_s + LATENCY_S, walk.devices[0]))
    assert follower.take(fix_at(last_s + 0.5 * LATENCY_S, 9.0, 1.0)) == 0
    assert follower.take(Block(0, last_s + 1.4 * LATENCY_S, ())) == 0
    assert follower.take(Block(0, last_s + 1.6 * LATENCY_S, ())) == 1


@pytest.mark.parametrize("devices", [1, 2])
@pytest.mark.parametrize("start", [EAST, StartPose(heading_rad=0.2)], ids=["known", "no place"])
def test_a_fix_that_comes_long_after_a_lost_heading_gives_it_up_there(devices: int, start: StartPose) -> None:
    """Until the fix comes, nothing could find the heading again, and the turn is one like others."""
    walk = walk_of(np.random.default_rng(22), devices, 20.0, pauses=False, start=start)
    walk, _ = with_lost_heading(walk, 9)
    walk = replace(walk, fixes=(fix_at(16.2, 14.0, 8.0), fix_at(18.3, 14.0, 10.0)))
    events = [event for event in in_time_order(walk) if isinstance(event, Block)]
    follower = Follower(walk, estimator_of(walk, horizon_s=100.0))
    for event in (*events, *walk.fixes):
        follower.take(event)
        state = follower.estimator.filter.state.walk.devices[0]
    assert state is not None
    assert state.segment_begin >= 9
    assert_same(follower.finish(), offline(walk))


@pytest.mark.parametrize("lost", [False, True])
def test_a_closed_walk_is_filtered_again_from_where_its_heading_was_lost(lost: bool) -> None:
    """That a walk ends where it began is only used at its end, and then it may find the heading again."""
    walk = walk_of(np.random.default_rng(25), 1, 15.0, pauses=False)
    if lost:
        walk, _ = with_lost_heading(walk, 8)
    follower = Follower(walk, estimator_of(walk, horizon_s=100.0))
    for event in in_time_order(walk):
        follower.take(event)
    assert_same(follower.finish(closing_sigma_m=0.4), offline(walk, closing_sigma_m=0.4))


def test_a_lost_heading_is_remembered_until_something_observes_it() -> None:
    """Its nodes may have to be filtered again, however long ago they were; after a fix they may be forgotten."""
    walk = walk_of(np.random.default_rng(23), 1, 60.0, pauses=False)
    walk, lost_s = with_lost_heading(walk, 10)
    follower = Follower(walk, estimator_of(walk, horizon_s=5.0))
    for block in walk.blocks(0, np.arange(1.0, 62.0)):
        follower.take(block)
    walk_filter = follower.estimator.filter
    assert walk_filter.history[0].time_s <= lost_s
    follower.take(fix_at(58.0, 50.0, 0.0))
    assert walk_filter.state.walk.devices[0] is not None
    assert walk_filter.state.walk.devices[0].lost_heading_s is None
    assert walk_filter.history[0].time_s > 50.0


def test_a_long_search_for_the_heading_needs_no_memory_of_the_walk() -> None:
    walk = walk_of(np.random.default_rng(24), 1, 150.0, pauses=False, fixes_s=[0.0], start=StartPose())
    follower = Follower(walk, estimator_of(walk, remembered_steps=100))
    for event in in_time_order(walk, 5.0):
        follower.take(event)
    state = follower.estimator.filter.state.walk.devices[0]
    assert state is not None
    assert not state.heading_known
    assert state.segment_begin == 0
    assert len(follower.estimator.filter.logs[0].nodes) <= 102  # type: ignore[union-attr]
    assert np.sqrt(np.trace(state.covariance[:2, :2])) > 50.0  # anywhere around the fix by now


def tether_count(follower: Follower) -> int:
    walk_filter = follower.estimator.filter
    return sum(len(record.tethers) for record in walk_filter.history) + len(walk_filter.tail_tethers)


def test_tethers_are_undone_with_the_nodes_and_applied_again_once() -> None:
    walk = walk_of(np.random.default_rng(4), 2, 20.0, pauses=False)
    tidy = follow(walk, in_time_order(walk), horizon_s=100.0)
    cuts_s = np.arange(0.5, 22.0, 0.5)
    first, second = walk.blocks(0, cuts_s), walk.blocks(1, cuts_s)
    # The second device falls back by eight seconds again and again, so that every tether time is passed twice.
    ragged = sorted(
        [*first, *second], key=lambda one: one.end_s if one.device == 0 else 8.0 * np.ceil(one.end_s / 8.0)
    )
    follower = follow(walk, ragged, wait_s=0.0, horizon_s=100.0)
    assert tether_count(follower) == tether_count(tidy) > 8
    assert_same(follower, offline(walk))


def test_a_pose_returns_to_its_value_when_the_tether_on_it_is_undone() -> None:
    """The first device stands; a tether draws it, and steps of the second one that come late undo the tether."""
    walk = walk_of(np.random.default_rng(5), 2, 12.0, pauses=False)
    short = tuple(m for m in walk.devices[0] if m.time_s < 5.0)
    walk = Walk((short, walk.devices[1]), walk.begins_s, (14.0, walk.ends_s[1]))
    follower = Follower(walk, estimator_of(walk, wait_s=0.0, horizon_s=100.0))
    stands, *_ = walk.blocks(0, [])
    follower.take(stands)
    key = max(key for key in follower.poses if key[0] == 0)
    before, values = follower.poses[key], []
    for block in walk.blocks(1, np.arange(1.0, 14.0)):
        follower.take(block)
        values.append(follower.poses[key][0])
    assert np.abs(values[-1][:2] - before[0][:2]).max() > 0.05  # tethers draw a device that stands
    assert len({tuple(value) for value in values}) > 3
    assert_same(follower.finish(), offline(walk))


def test_a_device_that_joins_on_the_way_is_taken_in() -> None:
    """The estimator hears of the second device only at its first block, after much of the walk."""
    walk = walk_of(np.random.default_rng(6), 2, 20.0, begins_s=[0.0, 9.0])
    follower = Follower(walk, estimator_of(walk, join=False, horizon_s=100.0))
    follower.estimator.add_device()
    for event in in_time_order(walk):
        if isinstance(event, Block) and event.device == 1 and len(follower.estimator.filter.logs) == 1:
            if event.end_s < walk.begins_s[1]:
                continue
            follower.estimator.add_device()
        follower.take(event)
    assert_same(follower.finish(), offline(walk))
    begun = follower.poses[min(key for key in follower.poses if key[0] == 1)][0]
    assert np.hypot(*begun[:2]) > 5.0  # beside the first device, not at the start of the walk


def test_a_third_device_leaves_the_tracks_of_the_others_in_their_place_of_time() -> None:
    walk = walk_of(np.random.default_rng(7), 3, 16.0, begins_s=[0.0, 0.0, 7.0])
    assert_same(follow(walk, in_time_order(walk, 0.7), horizon_s=50.0), offline(walk))


def test_only_the_horizon_is_remembered() -> None:
    walk = walk_of(np.random.default_rng(8), 2, 120.0)
    follower = Follower(walk, estimator_of(walk, horizon_s=5.0, wait_s=0.0))
    sizes = []
    for event in in_time_order(walk, 0.7):
        follower.take(event)
        walk_filter = follower.estimator.filter
        sizes.append(follower.estimator.remembered)
        if walk_filter.history:
            oldest = walk_filter.history[0]
            assert oldest.time_s > walk_filter.now_s - 5.0 - 4.0
            assert oldest.time_s == oldest.pending.step_first_s  # no step is divided
        follower.estimator.forget(walk_filter.now_s - 10.0)
    assert max(sizes[len(sizes) // 2 :]) <= 1.3 * max(sizes[: len(sizes) // 2])
    assert len(follower.estimator.filter.history) < 50
    assert_same(follower.finish(), offline(walk))


def test_steps_from_before_the_horizon_are_counted_and_come_last() -> None:
    walk = walk_of(np.random.default_rng(9), 2, 30.0, pauses=False)
    (early,), (late,) = walk.blocks(0, []), walk.blocks(1, [])
    follower = follow(walk, [early, late], wait_s=0.0, horizon_s=5.0)
    walk_filter, horizon_s = follower.estimator.filter, early.end_s - 5.0
    passed = sum(m.time_s < horizon_s - 1.0 for m in late.measurements if hasattr(m, "length_m"))
    assert 0.8 * passed <= walk_filter.late_steps <= passed + 3
    assert len(follower.poses) == len(offline(walk))
    times_s = [record.time_s for record in walk_filter.history]
    assert times_s == sorted(times_s)


def test_a_fix_that_a_device_can_no_longer_use_counts_as_missed() -> None:
    """The first device has been standing since 6 s; the second one walks on."""
    walk = walk_of(np.random.default_rng(10), 2, 30.0, pauses=False)
    stands = tuple(m for m in walk.devices[0] if m.time_s < 6.0)
    walk = Walk((stands, walk.devices[1]), walk.begins_s, walk.ends_s)
    follower = Follower(walk, estimator_of(walk, horizon_s=5.0, wait_s=0.0))
    for event in in_time_order(walk):
        follower.take(event)
    now_s = follower.estimator.now_s
    assert follower.take(PositionFix(now_s - 3.0, np.array([40.0, 0.0]), np.eye(2))) > 0
    assert follower.estimator.filter.missed_fixes == 1


def test_a_state_is_never_changed_by_what_comes_after() -> None:
    """Rewinding relies on it: earlier states share their arrays with the filter."""
    walk = walk_of(np.random.default_rng(11), 2, 15.0, fixes_s=[4.0, 9.0])
    follower = Follower(walk, estimator_of(walk, horizon_s=100.0))
    seen = []
    for event in in_time_order(walk):
        follower.take(event)
        joint = follower.estimator.filter.state.walk.joint
        assert joint is not None
        seen.append((joint, joint.mean.copy(), joint.covariance.copy()))
    follower.finish()
    for joint, mean, covariance in seen:
        assert np.array_equal(joint.mean, mean)
        assert np.array_equal(joint.covariance, covariance)


def test_a_pose_is_given_again_only_if_it_changed() -> None:
    walk = walk_of(np.random.default_rng(12), 1, 10.0, fixes_s=[5.0])
    follower = Follower(walk, estimator_of(walk, horizon_s=100.0))
    (block,) = walk.blocks(0, [])
    steps = sum(hasattr(m, "length_m") for m in block.measurements)
    assert follower.take(block) == steps + 1
    assert follower.take(Block(0, block.end_s + 1.0, ())) == 0
    after = sum(time_s >= 5.0 for _, time_s in follower.poses)
    assert follower.take(walk.fixes[0]) in (after, after + 1)


def test_tethers_join_each_pair_of_three_devices() -> None:
    walk = walk_of(np.random.default_rng(13), 3, 12.0, pauses=False)
    follower = follow(walk, in_time_order(walk), horizon_s=100.0)
    joined = [record.tethers for record in follower.estimator.filter.history if record.tethers]
    pairs = {(one.device_a, one.device_b) for tethers in joined for one in tethers}
    assert pairs == {(0, 1), (0, 2), (1, 2)}
    assert all(tethered_devices(tethers) == {0, 1, 2} for tethers in joined[1:])


def test_steps_wait_for_the_other_device_no_longer_than_told() -> None:
    walk = walk_of(np.random.default_rng(14), 2, 20.0, pauses=False)
    follower = Follower(walk, estimator_of(walk, wait_s=3.0))
    for block in walk.blocks(0, np.arange(0.5, 22.0, 0.5)):
        follower.take(block)
        last_s = max((time_s for _, time_s in follower.poses), default=0.0)
        known_s = max((m.time_s for m in walk.devices[0] if m.time_s + LATENCY_S <= block.end_s), default=0.0)
        assert last_s >= min(known_s, block.end_s - 3.0) - 0.7
        assert last_s <= max(block.end_s - 3.0, 0.0)
