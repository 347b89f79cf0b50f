"""Steps of the filter: pure functions of state and node, the same for one device and for many."""

from dataclasses import replace

import numpy as np
import pytest
from event_streams import SIGMA_SCALE, TETHER, Walk, offline, walk_of

from pdr_est.estimators.common.initial_state import StartPrior, start_prior, starts_of
from pdr_est.estimators.common.motion_model import GaussianState
from pdr_est.estimators.common.tethers import PairTether, node_tethers_between, tethers_between
from pdr_est.estimators.common.timeline import Timeline, build_timeline
from pdr_est.estimators.kalman.filterpy_ekf import MultiDeviceEkf
from pdr_est.estimators.kalman.joint_filter_step import WalkFilterState, WalkStepper
from pdr_est.estimators.kalman.offline_filter import filter_walk, run_filter
from pdr_est.types.measurements import DeviceTether, LoopClosure, StartPose, StepOdometry

EAST = StartPose((0.0, 0.0), 0.0, 0.1, 0.1)


def timelines_of(walk: Walk) -> list[Timeline]:
    return [build_timeline(str(d), walk.begins_s[d], (*own, *walk.fixes)) for d, own in enumerate(walk.devices)]


def frozen(state: WalkFilterState) -> list[np.ndarray]:
    """Copies of all arrays of a state."""
    known = [own for own in state.devices if own is not None]
    states = [state.joint, *[own.state for own in known]]
    return [array.copy() for one in states if one is not None for array in (one.mean, one.covariance)]


def test_a_step_depends_on_state_and_node_only_and_changes_neither() -> None:
    (first, second) = timelines_of(walk_of(np.random.default_rng(1), 2, 12.0, fixes_s=[3.0]))
    stepper = WalkStepper(2)
    state, history = stepper.initial(joint=True), []

    def step(before: WalkFilterState, device: int, i: int) -> WalkFilterState:
        timeline = (first, second)[device]
        prior: StartPrior = start_prior(timeline, EAST, 0.1)
        after, _ = stepper.step(before, device, i, timeline.nodes[i], heading_observed_later=False, prior=prior)
        return stepper.apply_tethers(after, [PairTether(0, 1, 0.1, 0.02)])[0]

    for i in range(15):
        for device in (0, 1):
            history.append((state, device, i, frozen(state)))
            state = step(state, device, i)
    for before, device, i, arrays in history[::-1]:  # again from every state, the last one first
        assert all(map(np.array_equal, frozen(before), arrays))
        again = step(before, device, i)
        assert all(map(np.array_equal, frozen(again), frozen(state)))
        state = before


@pytest.mark.parametrize("start", [EAST, StartPose(), StartPose((0.0, 1.0))])
@pytest.mark.parametrize("lost_headings", [False, True])
def test_a_device_in_company_is_filtered_by_itself_as_if_alone(start: StartPose, lost_headings: bool) -> None:
    walk = walk_of(np.random.default_rng(2), 2, 25.0, lost_headings=lost_headings, fixes_s=[1.0, 9.0, 20.0])
    timelines = timelines_of(walk)
    together = filter_walk(timelines, (), [start] * 2, 0.1)
    for timeline, segments in zip(timelines, together.segments, strict=True):
        alone = run_filter(timeline, start, 0.1)
        assert [one.aligned_from for one in segments] == [one.aligned_from for one in alone]
        for one, other in zip(segments, alone, strict=True):
            assert np.array_equal(one.pose, other.pose)
            assert np.array_equal(one.covariance, other.covariance)
            assert len(one.states) == len(other.states)
            assert sum(len(part.nodes) for part in alone) == len(timeline.nodes)


def test_without_tethers_the_joint_state_has_no_correlation_between_devices() -> None:
    walk = walk_of(np.random.default_rng(3), 3, 10.0)
    posteriors = filter_walk(timelines_of(walk), (), [EAST] * 3, 0.1).posteriors
    assert len(posteriors) == sum(len(one.nodes) for one in timelines_of(walk))
    covariance = posteriors[-1].joint.covariance
    for a in range(3):
        for b in range(a):
            assert not covariance[5 * a : 5 * a + 5, 5 * b : 5 * b + 5].any()


def test_posteriors_name_the_nodes_that_tethers_changed() -> None:
    walk = walk_of(np.random.default_rng(4), 2, 20.0, pauses=False)
    timelines = timelines_of(walk)
    spans_s = {str(d): (0.0, walk.ends_s[d]) for d in (0, 1)}
    tethers = node_tethers_between(timelines, tethers_between(spans_s, TETHER))
    posteriors = filter_walk(timelines, tethers, starts_of(timelines, EAST), SIGMA_SCALE).posteriors
    applied = [tether for posterior in posteriors for tether in posterior.node_tethers]
    assert applied == tethers
    times_s = [timelines[d].nodes[i].time_s for d, i in (posterior.touched[0] for posterior in posteriors)]
    assert times_s == sorted(times_s)
    for posterior, following in zip(posteriors, [*times_s[1:], np.inf], strict=True):
        for tether in posterior.node_tethers:
            assert tether.time_s < following
            assert {(0, tether.node_a), (1, tether.node_b)} <= set(posterior.touched)


def test_a_loop_closure_draws_the_end_of_a_single_device_only() -> None:
    """Several devices are drawn by their tethers; the closure belongs to a device's own filter."""
    walk = walk_of(np.random.default_rng(5), 1, 10.0)
    (timeline,) = timelines_of(walk)
    closed = build_timeline("0", 0.0, [*walk.devices[0], LoopClosure("0", 0.1)])
    free, drawn = run_filter(timeline, EAST, 0.1)[-1].end, run_filter(closed, EAST, 0.1)[-1].end
    assert np.hypot(*drawn.mean[:2]) < 0.3 * np.hypot(*free.mean[:2])
    joint = [filter_walk([one], (), [EAST], 0.1).posteriors[-1].joint.mean for one in (timeline, closed)]
    assert np.array_equal(*joint)


@pytest.mark.parametrize(("off_s", "node"), [(0.0, 4), (5e-10, 4), (2e-9, 3)])
def test_a_tether_at_the_time_of_a_node_applies_after_it(off_s: float, node: int) -> None:
    """Times within a nanosecond are the same."""
    devices = [
        [StepOdometry(name, 0.5 * k + off_s, 0.5 * k - 0.5, 0.7, turn, 0.01 * np.eye(3)) for k in range(1, 9)]
        for name, turn in (("a", 0.2), ("b", -0.2))
    ]
    timelines = [build_timeline(own[0].device, 0.0, own) for own in devices]
    tethers = node_tethers_between(timelines, [DeviceTether("a", "b", 2.0, 0.1, 0.02)])
    posteriors = filter_walk(timelines, tethers, [EAST] * 2, 0.1).posteriors
    (tethered,) = [posterior for posterior in posteriors if posterior.node_tethers]
    assert tethered.touched == ((1, node), (0, node))


def two_apart(offset_m: tuple[float, float]) -> MultiDeviceEkf:
    """Two devices of known heading and length scale, with elongated covariances in different directions."""
    ekf = MultiDeviceEkf(2)
    for device, (place, turn) in enumerate((((0.0, 0.0), 0.4), (offset_m, 2.0))):
        c, s = np.cos(turn), np.sin(turn)
        axes = np.array([[c, -s], [s, c]])
        covariance = np.zeros((5, 5))
        covariance[:2, :2] = axes @ np.diag([1.0, 0.2]) @ axes.T
        ekf.set_state(GaussianState(np.array([*place, 0.0, 1.0, 0.0]), covariance), device)
    return ekf


@pytest.mark.parametrize("offset_m", [(0.7, 0.1), (1.2, 0.3), (-1.0, 0.9)])
def test_a_tether_is_linearised_three_times(offset_m: tuple[float, float]) -> None:
    """The iterated EKF by hand, in the vector from one device to the other."""
    ekf, reach_m, sigma_m = two_apart(offset_m), 0.5, 0.02
    before = ekf.x[:2] - ekf.x[5:7]
    covariance = ekf.P[:2, :2] + ekf.P[5:7, 5:7]
    apart = before
    for _ in range(3):
        along = apart / np.hypot(*apart)
        gain = covariance @ along / (along @ covariance @ along + sigma_m**2)
        apart = before + gain * (reach_m - along @ before)
    ekf.update_tether(0, 1, reach_m, sigma_m)
    assert ekf.x[:2] - ekf.x[5:7] == pytest.approx(apart, abs=1e-12)


def test_devices_little_too_far_apart_are_brought_within_reach() -> None:
    ekf = two_apart((0.6, 0.05))
    before = np.trace(ekf.P)
    ekf.update_tether(0, 1, 0.5, 0.02)
    assert np.hypot(*(ekf.x[:2] - ekf.x[5:7])) == pytest.approx(0.5, abs=2e-3)
    assert np.trace(ekf.P) < before
    assert np.linalg.eigvalsh(ekf.P).min() > -1e-12
    assert np.allclose(ekf.P, ekf.P.T, rtol=0.0, atol=1e-15)


def test_devices_within_reach_are_left_as_they_are() -> None:
    ekf, same = two_apart((0.3, 0.3)), two_apart((0.3, 0.3))
    ekf.update_tether(0, 1, 0.5, 0.02)
    assert np.array_equal(ekf.x, same.x)
    assert np.array_equal(ekf.P, same.P)


def test_a_device_without_node_has_no_state() -> None:
    state = WalkStepper(2).initial(joint=True)
    assert not state.heading_known(1)
    with pytest.raises(LookupError, match="device 1 has no node"):
        state.state_of(1)
    (timeline,) = timelines_of(walk_of(np.random.default_rng(6), 1, 3.0))
    node = timeline.nodes[0]
    with pytest.raises(LookupError, match="device 0 without prior"):
        WalkStepper(2).step(state, 0, 0, node, heading_observed_later=False, prior=None)


def test_tethers_hold_the_tracks_of_two_devices_together() -> None:
    walk = walk_of(np.random.default_rng(7), 2, 40.0, pauses=False)
    track = offline(walk)
    apart = offline(replace(walk, devices=walk.devices[:1], begins_s=walk.begins_s[:1], ends_s=walk.ends_s[:1]))
    left, right = track.of_device("0"), track.of_device("1")
    gaps_m = np.linalg.norm(left.position_m - right.at(left.time_s)[0], axis=1)
    assert gaps_m.max() < 4.0
    assert np.linalg.norm(apart.position_m[-1] - left.position_m[-1]) > 3.0  # free, it drifts to its own side
