"""The fixed-lag smoother against the batch graph, and what it may know of the future."""

from dataclasses import replace

import numpy as np
import pytest
from estimator_walks import DEVICE, fix, heading_prior, simulate, smooth_as_given, winding

from pdr_est.estimators import estimate_walk
from pdr_est.estimators.common.initial_state import starts_of
from pdr_est.estimators.common.tethers import TetherParams, node_tethers_between, tethers_between
from pdr_est.estimators.common.timeline import timelines_of
from pdr_est.estimators.factor_graph.initial_values import initial_states
from pdr_est.estimators.factor_graph.newton import minimised
from pdr_est.estimators.factor_graph.smoother import marginals_of
from pdr_est.estimators.factor_graph.smoothing_problem import SmoothingProblem
from pdr_est.estimators.fixed_lag.params import FixedLagParams
from pdr_est.types.measurements import DeviceMeasurements, HeadingPrior, Measurement, StartPose
from pdr_est.types.track import Track

ORIGIN = StartPose((0.0, 0.0), 0.0, 0.1, 0.05)


def lagged(measurements: list[Measurement], start: StartPose, lag_s: float, sigma_scale: float = 0.0) -> Track:
    devices = [DeviceMeasurements(DEVICE, 0.0, tuple(measurements))]
    return estimate_walk("fixed-lag", devices, start, sigma_scale, fixed_lag=FixedLagParams(lag_s=lag_s))


def batch(measurements: list[Measurement], start: StartPose, sigma_scale: float = 0.0) -> Track:
    return smooth_as_given(measurements, start, sigma_scale)


def relative(k: float, heading_rad: float) -> HeadingPrior:
    return replace(heading_prior(k, heading_rad, 0.1), relative=True)


@pytest.mark.parametrize("at", [(), (8, 16, 24)], ids=["none", "headings"])
def test_a_walk_shorter_than_the_lag_is_as_in_the_batch_graph(at: tuple[int, ...]) -> None:
    """With fixes that give no reason to doubt them, and whose clock is certainly right: the graph knows no others."""
    rng = np.random.default_rng(4)
    walk = simulate(rng, winding(40, rng))
    fixes = [fix(k, *(walk.truth[k, :2] + (0.1, -0.2))) for k in range(0, 41, 10)]
    given = [*walk.odometry, *fixes, *(heading_prior(k, float(walk.truth[k, 2]) + 0.03) for k in at)]
    late, whole = lagged(given, ORIGIN, 60.0), batch(given, ORIGIN)
    assert (late.kind, late.estimator) == ("delayed", "fixed-lag")
    assert late.position_m == pytest.approx(whole.position_m, abs=5e-3)
    assert late.heading_rad == pytest.approx(whole.heading_rad, abs=1e-3)
    assert late.covariance_m2 == pytest.approx(whole.covariance_m2, rel=0.01, abs=1e-4)


def test_headings_relative_to_a_direction_that_lives_on() -> None:
    rng = np.random.default_rng(5)
    walk = simulate(rng, np.zeros(80))
    priors = [relative(k, 0.3) for k in range(2, 80, 3)]
    late, whole = lagged([*walk.measurements, *priors], ORIGIN, 5.0), batch([*walk.measurements, *priors], ORIGIN)
    bare = lagged(walk.measurements, ORIGIN, 5.0)
    assert np.abs(late.heading_rad - whole.heading_rad).max() < 1e-4
    assert late.sigma_heading_rad[40] < 0.7 * bare.sigma_heading_rad[40]
    assert late.position_m[-1] == pytest.approx(whole.position_m[-1], abs=0.3)


def test_a_pose_knows_the_lag_after_it_and_no_more() -> None:
    rng = np.random.default_rng(6)
    walk = simulate(rng, winding(60, rng))
    bare = lagged(walk.measurements, ORIGIN, 5.0, 0.1)
    told = lagged([*walk.measurements, fix(40, 0.0, 0.0, 0.5)], ORIGIN, 5.0, 0.1)
    changed = np.abs(told.position_m - bare.position_m).max(axis=1) > 1e-9
    assert not changed[:29].any()
    assert changed[31:].all()


def test_between_the_filter_and_the_batch_graph() -> None:
    """In spread, on walks with fixes: the longer the lag, the nearer to the graph."""
    rng = np.random.default_rng(7)
    walk = simulate(rng, winding(120, rng), fix_every=20)
    start = replace(ORIGIN)
    filtered = estimate_walk("ekf", [DeviceMeasurements(DEVICE, 0.0, tuple(walk.measurements))], start, 0.05)
    spreads = [
        float(np.mean(np.trace(track.covariance_m2, axis1=1, axis2=2)))
        for track in (
            filtered,
            lagged(walk.measurements, start, 3.0, 0.05),
            lagged(walk.measurements, start, 10.0, 0.05),
            batch(walk.measurements, start, 0.05),
        )
    ]
    assert spreads == sorted(spreads, reverse=True)
    assert spreads[2] < 0.75 * spreads[0]


def drifting_devices(steps: int) -> list[DeviceMeasurements]:
    """Two phones of one walker whose headings drift apart."""
    rng = np.random.default_rng(8)
    turns = winding(steps, rng)
    devices = []
    for name, drift in (("a", 0.006), ("b", -0.006)):
        walk = simulate(rng, turns)
        odometry = [
            replace(step, device=name, heading_change_rad=step.heading_change_rad + drift) for step in walk.odometry
        ]
        devices.append(DeviceMeasurements(name, 0.0, tuple(odometry)))
    return devices


def two_devices(lag_s: float) -> tuple[Track, Track]:
    """The track of two phones of one walker, tied and alone."""
    devices = drifting_devices(200)
    tethers = tethers_between({"a": (0.0, 100.0), "b": (0.0, 100.0)}, TetherParams())
    parameters = FixedLagParams(lag_s=lag_s)
    tied = estimate_walk("fixed-lag", devices, ORIGIN, 0.05, tethers, fixed_lag=parameters)
    return tied, estimate_walk("fixed-lag", devices, ORIGIN, 0.05, (), fixed_lag=parameters)


def test_devices_of_one_body_stay_together() -> None:
    tied, alone = two_devices(10.0)
    apart = [np.hypot(*(one.of_device("a").position_m - one.of_device("b").position_m).T) for one in (tied, alone)]
    assert apart[1].max() > 5.0
    at_tethers = apart[0][::4]  # every two seconds
    assert at_tethers.max() < 0.5 * 1.05 + 0.1
    assert apart[0].max() < 1.5


def test_tethers_within_the_lag_are_as_solved_by_gtsam() -> None:
    """By Newton's method on the same measurements; the window has linearised early nodes at earlier estimates."""
    devices = drifting_devices(40)
    tethers = tethers_between({"a": (0.0, 20.0), "b": (0.0, 20.0)}, TetherParams())
    late = estimate_walk("fixed-lag", devices, ORIGIN, 0.0, tethers, fixed_lag=FixedLagParams(lag_s=60.0))
    timelines = timelines_of(devices, tethers)
    node_tethers, starts = node_tethers_between(timelines, tethers), starts_of(timelines, ORIGIN)
    initial = initial_states(timelines, node_tethers, starts, 0.0)
    problem, scale = SmoothingProblem(timelines, node_tethers, starts, initial), np.ones(2)
    values = problem.initial_values(initial)
    values = minimised(problem.without_tethers(scale), problem.tethers, values, problem.variables, 1e-9)
    assert problem.tethers.linearised(problem.poses(values)).violation_m.max() > 1e-4
    pose, covariance = marginals_of(problem, problem.linear(values, scale).factors, values)
    steps = [[node.is_step for node in timeline.nodes] for timeline in timelines]
    kept = np.concatenate(steps)
    assert late.position_m == pytest.approx(pose[kept, :2], abs=5e-3)
    assert late.heading_rad == pytest.approx(pose[kept, 2], abs=1e-3)
    assert late.covariance_m2 == pytest.approx(covariance[kept, :2, :2], rel=0.05, abs=1e-4)
