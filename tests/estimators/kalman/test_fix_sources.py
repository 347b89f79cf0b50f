"""Sources of fixes as states of the filter: wandering errors, and the trust that a source has earned."""

import pickle
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from estimator_walks import fix, simulate
from hypothesis import given, settings
from hypothesis import strategies as st
from least_squares import fix_covariance, solve_linear, wander_variances

from pdr_est.estimators.common.motion_model import SOURCE_STATES, STATES, GaussianState
from pdr_est.estimators.common.timeline import Timeline, build_timeline, timelines_of
from pdr_est.estimators.kalman.filterpy_ekf import MultiDeviceEkf
from pdr_est.estimators.kalman.fix_sources import (
    fix_rows,
    place_of_source,
    with_source_at,
)
from pdr_est.estimators.kalman.joint_filter_step import WalkStepper
from pdr_est.estimators.kalman.offline_filter import filter_walk, run_filter
from pdr_est.estimators.kalman.rts_smoother import smooth_segments, smooth_walk
from pdr_est.frames import Array
from pdr_est.types.measurements import DeviceMeasurements, PositionFix, StartPose, StepOdometry

EAST = StartPose((3.0, -2.0), 0.0, sigma_position_m=2.0)
STRAIGHT = np.diag([0.005, 0.004, 1e-12])


def wandering(
    k: float, x_m: float, y_m: float, source: str = "gps", sigma_m: float = 3.0, time_s: float = 8.0
) -> PositionFix:
    return replace(fix(k, x_m, y_m, 0.7), source=source, sigma_wander_m=sigma_m, wander_time_s=time_s)


def standing(variance: float = 9.0) -> GaussianState:
    """A walker who stands somewhere near the origin."""
    return GaussianState(np.zeros(STATES), np.diag([variance, variance, 0.1, 0.01, 1.0]))


def filtered(state: GaussianState, fixes: Sequence[PositionFix]) -> GaussianState:
    ekf = MultiDeviceEkf()
    ekf.load(state)
    for one in fixes:
        ekf.update_position(one)
    return ekf.state_of()


SERIES = st.lists(
    st.tuples(st.sampled_from(["gps", "network", "survey"]), st.floats(0.01, 5.0), st.floats(0.5, 20.0)),
    min_size=1,
    max_size=10,
)


@settings(deadline=None)
@given(SERIES, st.floats(0.5, 100.0))
def test_wandering_errors_are_dense_gaussian_conditioning(
    series: list[tuple[str, float, float]], time_s: float
) -> None:
    """A walker who stands, and sources whose stated accuracy changes; one of them has no wandering error."""
    k, fixes = 0.0, []
    for source, pause, sigma_m in series:
        k += pause
        wander_m = 0.0 if source == "survey" else sigma_m
        fixes.append(replace(wandering(k, 0.05 * len(fixes), -0.04 * len(fixes), source, wander_m, time_s)))
    found = filtered(standing(), fixes)
    errors = fix_covariance(fixes)
    rows = np.tile(np.eye(2), (len(fixes), 1))
    spread = rows @ (9.0 * np.eye(2)) @ rows.T + errors
    gain = 9.0 * rows.T @ np.linalg.inv(spread)
    assert found.mean[:2] == pytest.approx(gain @ np.concatenate([one.position_m for one in fixes]), abs=1e-6)
    assert found.covariance[:2, :2] == pytest.approx(9.0 * (np.eye(2) - gain @ rows), abs=1e-6)


def test_the_states_of_a_source_are_the_error_over_its_sigma() -> None:
    fixes = [wandering(0, 2.0, 1.0), wandering(4, 1.0, 0.5, sigma_m=6.0), wandering(10, 2.0, 0.0, sigma_m=1.0)]
    found = filtered(standing(), fixes)
    variance = wander_variances(fixes)["gps", 5.0]
    assert found.sources[0].sigma_m == pytest.approx(np.sqrt(variance))
    errors = fix_covariance(fixes)
    spread = np.tile(9.0 * np.eye(2), (3, 3)) + errors
    wander = errors[-2:] - np.block([[np.zeros((2, 4)), 0.49 * np.eye(2)]])
    expected = wander @ np.linalg.solve(spread, np.concatenate([one.position_m for one in fixes]))
    assert found.mean[STATES : STATES + 2] * found.sources[0].sigma_m == pytest.approx(expected, abs=1e-9)


def test_a_fix_of_a_known_source_at_the_same_time_adds_no_error() -> None:
    before = with_source_at(standing(), 1, wandering(2, 0.0, 0.0))
    again = with_source_at(before, 1, wandering(2, 5.0, 5.0))
    assert np.array_equal(again.covariance, before.covariance)
    assert again.sources == before.sources


def test_rows_of_sources() -> None:
    two = with_source_at(with_source_at(standing(), 1, wandering(0, 0, 0)), 1, wandering(1, 0, 0, "beacon", 2.0))
    assert place_of_source(two.sources, 1, wandering(2, 0, 0, "beacon")) == STATES + SOURCE_STATES
    assert place_of_source(two.sources, 1, replace(fix(2, 0, 0), source="start")) is None
    rows = fix_rows(two, 1, wandering(2, 0, 0, "beacon"))
    assert rows[:, :2] == pytest.approx(np.eye(2))
    assert rows[:, STATES:] == pytest.approx(np.hstack([np.zeros((2, 3)), 2.0 * np.eye(2), np.zeros((2, 1))]))


def many_fixes(truth: Array) -> list[PositionFix]:
    places = np.arange(1.3, 40.0, 2.6)
    near = [truth[round(k), :2] for k in places]
    gps = [wandering(k, at[0] + 1.5, at[1] - 1.0, sigma_m=3.0 + 0.1 * k) for k, at in zip(places, near, strict=True)]
    beacon = [wandering(k, *truth[int(k), :2], "beacon", 1.0, 30.0) for k in (9.5, 30.0)]
    return [*gps, *beacon, fix(20.2, *(truth[20, :2] + 0.1), 0.4)]


def linear_walk() -> Timeline:
    walk = simulate(np.random.default_rng(4), np.zeros(40), (3.5, -2.5, 0.0), 1.0, covariance=STRAIGHT)
    return build_timeline("phone", 0.0, [*walk.odometry, *many_fixes(walk.truth)])


def test_on_a_linear_walk_filter_and_smoother_are_dense_least_squares() -> None:
    timeline = linear_walk()
    (position,), (covariance,), _, _ = solve_linear([timeline], EAST, 0.0)
    segments = run_filter(timeline, EAST, 0.0)
    assert segments[-1].end.mean[:2] == pytest.approx(position[-1], abs=1e-4)
    assert segments[-1].end.covariance[:2, :2] == pytest.approx(covariance[-1], abs=1e-4)
    states = smooth_segments(segments)
    assert np.array([state.mean[:2] for state in states]) == pytest.approx(position, abs=1e-4)
    assert np.array([state.covariance[:2, :2] for state in states]) == pytest.approx(covariance, abs=1e-4)
    assert all(len(state.sources) == 3 for state in states)  # from the first pose on, for the smoother


def two_devices() -> list[Timeline]:
    """Two phones of one walker whose steps end at other times, with the same fixes."""
    walks = [
        simulate(np.random.default_rng(seed), np.zeros(40), (3.5, -2.5, 0.0), 1.0, covariance=STRAIGHT)
        for seed in (4, 5)
    ]
    fixes = many_fixes(walks[0].truth)
    later = [
        replace(one, device="b", time_s=one.time_s + 0.2, start_s=one.start_s + 0.2) for one in walks[1].odometry
    ]
    devices: list[tuple[str, list[StepOdometry]]] = [("phone", walks[0].odometry), ("b", later)]
    return timelines_of([DeviceMeasurements(name, 0.0, (*own, *fixes)) for name, own in devices])


def test_devices_share_the_wandering_error_of_a_source() -> None:
    """And so the joint filter and its smoother are dense least squares with one error for both."""
    timelines = two_devices()
    positions, covariances, _, _ = solve_linear(timelines, EAST, 0.0)
    posterior = filter_walk(timelines, (), [EAST] * 2, 0.0).posteriors[-1]
    assert len(posterior.joint.sources) == 3
    states = smooth_walk(timelines, (), [EAST] * 2, 0.0)
    for device in (0, 1):
        assert posterior.state_of(device).mean[:2] == pytest.approx(positions[device][-1], abs=1e-3)
        assert posterior.state_of(device).covariance[:2, :2] == pytest.approx(covariances[device][-1], abs=1e-3)
        assert np.array([one.mean[:2] for one in states[device]]) == pytest.approx(positions[device], abs=1e-3)
        spread = np.array([one.covariance[:2, :2] for one in states[device]])
        assert spread == pytest.approx(covariances[device], abs=1e-3)
    alone = run_filter(timelines[0], EAST, 0.0)[-1].end
    assert alone.covariance[0, 0] > 1.2 * posterior.state_of(0).covariance[0, 0]


def contradicting(off_m: float) -> GaussianState:
    """A walk of 42 m to the east, and a fix at its end that is further on."""
    walk = simulate(np.random.default_rng(1), np.zeros(60), covariance=STRAIGHT)
    at = fix(60, 42.0 + off_m, 0.0, 0.5)
    start = StartPose((0.0, 0.0), 0.0, 0.1, 0.05)
    return run_filter(build_timeline("phone", 0.0, [*walk.odometry, at]), start, 0.06)[-1].end


def test_a_contradiction_is_told_by_the_covariance_and_moves_the_scale_little() -> None:
    usual, wrong = contradicting(1.0), contradicting(60.0)
    assert abs(wrong.length_scale[0] - 1.0) < 0.06
    assert wrong.length_scale[1] > 1.5 * usual.length_scale[1]
    assert wrong.covariance[0, 0] > 100.0 * usual.covariance[0, 0]
    assert 42.0 < wrong.mean[0] < 72.0  # the fix is doubted more than the track


def test_a_contradiction_of_one_device_doubts_the_position_of_that_device_only() -> None:
    ekf = MultiDeviceEkf(2)
    for device in (0, 1):
        ekf.set_state(standing(1.0), device)
    before = ekf.dump()
    ekf.update_position(fix(1, 50.0, 0.0, 0.5), device=1)
    after = ekf.dump()
    assert after.covariance[:STATES, :STATES] == pytest.approx(before.covariance[:STATES, :STATES], rel=1e-12)
    assert after.covariance[STATES, STATES] > 10.0 * 0.2
    assert np.linalg.eigvalsh(after.covariance)[0] > -1e-12


EVENTS = st.lists(
    st.tuples(st.floats(-80.0, 80.0), st.floats(-80.0, 80.0), st.floats(0.05, 30.0), st.booleans(), st.booleans()),
    max_size=15,
)


@settings(deadline=None)
@given(EVENTS)
def test_no_series_of_fixes_breaks_the_filter(events: list[tuple[float, float, float, bool, bool]]) -> None:
    fixes = []
    for k, (east_m, north_m, sigma_m, robust, wanders) in enumerate(events):
        one = fix(4.0 * k, east_m, north_m, sigma_m, robust)
        fixes.append(replace(one, source="gps", sigma_wander_m=2.0 * sigma_m, wander_time_s=10.0) if wanders else one)
    found = filtered(standing(), fixes)
    assert np.isfinite(found.mean).all()
    assert np.linalg.eigvalsh(found.covariance)[0] > -1e-9 * np.trace(found.covariance)
    assert (np.diag(found.covariance)[:STATES] > 0.0).all()
    assert 0.0 < found.length_scale[0] < 10.0


def test_a_device_brings_the_errors_that_the_filter_does_not_know() -> None:
    """With what its pose has in common with them; the error of a source that the filter has is left as it is."""
    known = filtered(standing(), [wandering(0, 2.0, 1.0), wandering(1, 2.0, 1.0, "beacon")])
    first = filtered(standing(), [wandering(0, 5.0, 5.0, "beacon")])
    ekf = MultiDeviceEkf(2)
    ekf.set_state(first, 0)
    ekf.set_state(known, 1)
    joint = ekf.dump()
    assert [source.name for source in joint.sources] == ["beacon", "gps"]
    rows = [*range(STATES, 2 * STATES), *range(2 * STATES + SOURCE_STATES, 2 * STATES + 2 * SOURCE_STATES)]
    own = STATES + SOURCE_STATES
    assert joint.mean[rows] == pytest.approx(known.mean[:own])
    assert joint.covariance[np.ix_(rows, rows)] == pytest.approx(known.covariance[:own, :own])
    others = [*range(STATES), *range(2 * STATES, 2 * STATES + SOURCE_STATES)]
    assert joint.covariance[np.ix_(others, others)] == pytest.approx(first.covariance)
    assert not joint.covariance[np.ix_(rows, others)].any()
    ekf.set_state(first, 0)  # a device that enters anew leaves what it had brought to the other one
    assert [source.name for source in ekf.dump().sources] == ["beacon", "gps"]


def test_a_device_that_enters_alone_brings_all_errors_anew() -> None:
    ekf = MultiDeviceEkf(2)
    ekf.set_state(filtered(standing(), [wandering(0, 5.0, 5.0, "beacon")]), 0)
    again = filtered(standing(), [wandering(0, 2.0, 1.0, "beacon"), wandering(1, 2.0, 1.0)])
    ekf.set_state(again, 0)
    assert ekf.dump().sources == again.sources
    assert ekf.dump().covariance[2 * STATES :, 2 * STATES :] == pytest.approx(again.covariance[STATES:, STATES:])


def test_a_source_remembers_all_its_jumps() -> None:
    """Also those of two fixes at one time, so that a smoother knows what was added between two nodes."""
    bad, again = (replace(wandering(2, 18.0, north_m), robust=True) for north_m in (0.0, 20.0))
    once, twice = filtered(standing(), [bad]).sources[0], filtered(standing(), [bad, again]).sources[0]
    later = filtered(standing(), [bad, again, replace(wandering(4, 0.0, 0.0), robust=True)]).sources[0]
    assert 0.0 < once.jump_variance < twice.jump_variance <= later.jump_variance


@pytest.mark.parametrize("together", [False, True])
def test_smoothing_goes_through_jumps_of_a_source(together: bool) -> None:
    """Fixes that disagree grossly, also several at one node; the covariance stays one, and the last state is kept."""
    walk = simulate(np.random.default_rng(6), np.zeros(30), (3.0, -2.0, 0.0), covariance=STRAIGHT)
    fixes = []
    for k in range(0, 30, 2):
        off = 40.0 if 10 <= k < 20 else 0.0
        for east_m in (0.0, 0.5) if together else (0.0,):
            fixes.append(replace(wandering(k, walk.truth[k, 0] + east_m, walk.truth[k, 1] + off), robust=True))
    segments = run_filter(build_timeline("phone", 0.0, [*walk.odometry, *fixes]), EAST, 0.05)
    states = smooth_segments(segments)
    assert segments[-1].end.sources[0].jump_variance > 0.0
    for state in states:
        assert np.linalg.eigvalsh(state.covariance)[0] > -1e-9
    assert np.array_equal(states[-1].mean, segments[-1].end.mean)


def test_a_joint_state_with_sources_is_pickled_whole() -> None:
    timelines, stepper = two_devices(), WalkStepper(2)
    state = stepper.with_joint_of([None, None], 0.0)
    again = pickle.loads(pickle.dumps(state))
    assert again == replace(state, joint=again.joint)
    joint = filter_walk(timelines, (), [EAST] * 2, 0.05).posteriors[-1].joint
    same: GaussianState = pickle.loads(pickle.dumps(joint))
    assert np.array_equal(same.covariance, joint.covariance)
    assert same.sources == joint.sources
