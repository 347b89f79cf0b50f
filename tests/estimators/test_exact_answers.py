"""Walks whose exact answer is known: Kalman filter, least squares, smoother and graph must agree."""

import numpy as np
import pytest
from estimator_walks import (
    DEVICE,
    SIGMA_SCALE,
    SimulatedWalk,
    fix,
    heading_prior,
    simulate,
    smooth_as_given,
    winding,
    with_near_fixes,
)
from least_squares import solve, solve_linear

from pdr_est.estimators.common.timeline import Timeline, build_timeline
from pdr_est.estimators.kalman import ekf, rts_smoother
from pdr_est.estimators.kalman.offline_filter import run_filter
from pdr_est.frames import Array
from pdr_est.types.measurements import StartPose

EAST = StartPose((3.0, -2.0), 0.0, sigma_position_m=0.3)
STRAIGHT = np.zeros(12)


def straight_walk(sigma_heading_rad: float) -> SimulatedWalk:
    covariance = np.diag([0.005, 0.004, sigma_heading_rad**2])
    covariance[0, 1] = covariance[1, 0] = 0.001
    walk = simulate(
        np.random.default_rng(4), STRAIGHT, (3.2, -2.1, 0.0), 1.1, fix_every=4, first_fix=2, covariance=covariance
    )
    return SimulatedWalk(walk.truth, walk.odometry, [*walk.fixes, fix(8.4, 9.2, -2.0)])


def timeline_of(walk: SimulatedWalk) -> Timeline:
    return build_timeline(DEVICE, 0.0, walk.measurements)


def kalman_filter(timeline: Timeline, sigma_scale: float) -> tuple[Array, Array]:
    """The textbook's filter over (x, y, log scale) on a walk due east: means (n, 3), covariances (n, 3, 3)."""
    x = np.array([3.0, -2.0, 0.0])
    p = np.diag([0.3**2, 0.3**2, sigma_scale**2])
    h = np.eye(2, 3)
    means, covariances = [], []
    for i, node in enumerate(timeline.nodes):
        if i:
            length_m = np.exp(x[2]) * node.length_m
            f = np.array([[1.0, 0.0, length_m], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
            q = np.zeros((3, 3))
            q[:2, :2] = node.covariance[:2, :2]
            x, p = x + np.array([length_m, 0.0, 0.0]), f @ p @ f.T + q
        for measured in node.fixes:
            gain = p @ h.T @ np.linalg.inv(h @ p @ h.T + measured.covariance_m2)
            x, p = x + gain @ (measured.position_m - h @ x), (np.eye(3) - gain @ h) @ p
        means.append(x)
        covariances.append(p)
    return np.array(means), np.array(covariances)


@pytest.mark.parametrize("sigma_scale", [0.0, SIGMA_SCALE])
def test_on_a_walk_due_east_the_ekf_is_the_textbook_s(sigma_scale: float) -> None:
    timeline = timeline_of(straight_walk(0.0))
    mean, covariance = kalman_filter(timeline, sigma_scale)
    steps = [node.is_step for node in timeline.nodes]
    track = ekf.estimate([timeline], (), EAST, sigma_scale)
    assert track.position_m == pytest.approx(mean[steps, :2], abs=1e-9)
    assert track.covariance_m2 == pytest.approx(covariance[steps, :2, :2], abs=1e-9)
    assert track.length_scale == pytest.approx(np.exp(mean[-1, 2]), abs=1e-9)
    assert track.sigma_length_scale == pytest.approx(track.length_scale * np.sqrt(covariance[-1, 2, 2]), abs=1e-9)
    assert track.sigma_heading_rad == pytest.approx(np.zeros(13), abs=1e-9)
    assert track.kind == "filtered"


def test_on_a_linear_walk_filter_and_smoother_are_least_squares() -> None:
    """Linear, because the length scale is known."""
    timeline = timeline_of(straight_walk(0.0))
    (position,), (covariance,), _, _ = solve_linear([timeline], EAST, 0.0)
    filtered = run_filter(timeline, EAST, 0.0)[0]
    smoothed = rts_smoother.smooth(timeline.nodes, filtered.states)
    assert filtered.states[-1].mean[:2] == pytest.approx(position[-1], abs=1e-9)
    assert filtered.states[-1].covariance[:2, :2] == pytest.approx(covariance[-1], abs=1e-9)
    for i, state in enumerate(smoothed):
        assert state.mean[:2] == pytest.approx(position[i], abs=1e-8)
        assert state.covariance[:2, :2] == pytest.approx(covariance[i], abs=1e-8)


def test_with_a_scale_filter_and_smoother_are_least_squares_to_first_order() -> None:
    timeline = timeline_of(straight_walk(0.0))
    (position,), (covariance,), (log_scale,), of_scale = solve_linear([timeline], EAST, SIGMA_SCALE)
    smoothed = rts_smoother.smooth(timeline.nodes, run_filter(timeline, EAST, SIGMA_SCALE)[0].states)
    for i, state in enumerate(smoothed):
        assert state.mean[:2] == pytest.approx(position[i], abs=0.01)
        assert np.linalg.norm(state.covariance[:2, :2] - covariance[i]) < 0.05 * np.linalg.norm(covariance[i])
        assert state.mean[3] == pytest.approx(log_scale, abs=0.1 * np.sqrt(of_scale[0, 0]))
        assert state.covariance[3, 3] == pytest.approx(of_scale[0, 0], rel=0.1)


@pytest.mark.parametrize("sigma_scale", [0.0, SIGMA_SCALE])
def test_on_a_walk_due_east_the_graph_is_least_squares(sigma_scale: float) -> None:
    walk = straight_walk(1e-4)
    timeline = timeline_of(walk)
    (position,), (covariance,), (log_scale,), of_scale = solve_linear([timeline], EAST, sigma_scale)
    steps = [node.is_step for node in timeline.nodes]
    track = smooth_as_given(walk.measurements, EAST, sigma_scale)
    assert track.position_m == pytest.approx(position[steps], abs=5e-6)
    assert track.covariance_m2 == pytest.approx(covariance[steps], abs=5e-6)
    assert track.length_scale == pytest.approx(np.exp(log_scale), abs=5e-6)
    assert track.sigma_length_scale == pytest.approx(np.exp(log_scale) * np.sqrt(of_scale[0, 0]), abs=5e-6)
    assert track.kind == "smoothed"


def test_on_a_gently_turning_walk_the_graph_is_the_smoothed_filter() -> None:
    """Up to the curvature of the problem: 1 cm and 2 % of the covariances for headings known to 1 degree."""
    rng = np.random.default_rng(6)
    covariance = np.diag([0.001, 0.001, 0.002**2])
    start = StartPose((3.0, -2.0), 0.5, sigma_position_m=0.1, sigma_heading_rad=0.02)
    turns = 0.05 * np.sin(np.arange(80) / 9.0)
    walk = simulate(rng, turns, (3.0, -2.0, 0.5), 1.02, fix_every=10, sigma_fix_m=0.2, covariance=covariance)
    walk = with_near_fixes(walk)
    timeline = timeline_of(walk)
    smoothed = rts_smoother.smooth(timeline.nodes, run_filter(timeline, start, 0.03)[0].states)
    track = smooth_as_given(walk.measurements, start, 0.03)
    assert track.position_m == pytest.approx(np.array([state.mean[:2] for state in smoothed]), abs=0.01)
    for k, state in enumerate(smoothed):
        expected = state.covariance[:2, :2]
        assert np.linalg.norm(track.covariance_m2[k] - expected) < 0.02 * np.linalg.norm(expected)


def test_with_turns_the_graph_is_dense_least_squares_over_poses_and_scale() -> None:
    rng = np.random.default_rng(7)
    start = StartPose((3.0, -2.0), 2.5, sigma_position_m=0.1, sigma_heading_rad=0.1)
    walk = simulate(rng, 2.0 * winding(24, rng), (3.0, -2.0, 2.6), 1.1, fix_every=5, first_fix=4, sigma_fix_m=0.2)
    priors = [heading_prior(k, walk.truth[k, 2] + 0.02) for k in (10, 20)]
    track = smooth_as_given([*walk.measurements, *priors], start)
    timeline = build_timeline(DEVICE, 0.0, [*walk.measurements, *priors])
    guess = np.column_stack([track.position_m, track.heading_rad])
    mean, covariance = solve(timeline, start, SIGMA_SCALE, guess)
    poses = mean[:-1].reshape(-1, 3)
    assert track.position_m == pytest.approx(poses[:, :2], abs=1e-3)
    assert np.sin(track.heading_rad - poses[:, 2]) == pytest.approx(np.zeros(25), abs=1e-4)
    assert track.length_scale == pytest.approx(np.exp(mean[-1]), abs=1e-4)
    assert track.sigma_length_scale == pytest.approx(np.exp(mean[-1]) * np.sqrt(covariance[-1, -1]), rel=0.01)
    for k in range(25):
        expected = covariance[3 * k : 3 * k + 2, 3 * k : 3 * k + 2]
        assert np.linalg.norm(track.covariance_m2[k] - expected) < 0.01 * np.linalg.norm(expected)
        assert track.sigma_heading_rad[k] == pytest.approx(np.sqrt(covariance[3 * k + 2, 3 * k + 2]), rel=0.01)
