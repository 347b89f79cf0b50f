"""Heading priors that count from a direction nobody knows: they tell angles between stretches, not where north is."""

from dataclasses import replace

import numpy as np
import pytest
from estimator_walks import (
    DEVICE,
    SIGMA_SCALE,
    SimulatedWalk,
    fix,
    heading_prior,
    run,
    simulate,
    smooth_as_given,
    straight,
    winding,
    with_near_fixes,
)
from least_squares import solve

from pdr_est.estimators.common.timeline import build_timeline
from pdr_est.estimators.kalman import rts_smoother
from pdr_est.estimators.kalman.offline_filter import run_filter
from pdr_est.frames import wrap_angle
from pdr_est.types.measurements import HeadingPrior, Measurement, StartPose

START = StartPose((3.0, -2.0), 2.5, sigma_position_m=0.1, sigma_heading_rad=0.1)


def relative(k: float, heading_rad: float, sigma_rad: float = 0.05, robust: bool = False) -> HeadingPrior:
    return replace(heading_prior(k, heading_rad, sigma_rad, robust), relative=True)


def tied(walk: SimulatedWalk, zero_rad: float, steps: range) -> list[Measurement]:
    """The walk with relative priors at some steps, counted from zero_rad."""
    return [*walk.measurements, *(relative(k, walk.truth[k, 2] - zero_rad + 0.02 * (-1) ** k) for k in steps)]


def turning_walk() -> SimulatedWalk:
    rng = np.random.default_rng(7)
    return simulate(rng, 2.0 * winding(24, rng), (3.0, -2.0, 2.6), 1.1, fix_every=5, first_fix=4, sigma_fix_m=0.2)


def test_the_graph_is_dense_least_squares_with_the_reference_as_a_variable() -> None:
    measurements = tied(turning_walk(), 1.3, range(3, 24, 3))
    track = smooth_as_given(measurements, START)
    timeline = build_timeline(DEVICE, 0.0, measurements)
    mean, covariance = solve(timeline, START, SIGMA_SCALE, np.column_stack([track.position_m, track.heading_rad]))
    poses = mean[:75].reshape(-1, 3)
    assert len(mean) == 77
    assert mean[-2] == pytest.approx(1.3, abs=0.1)
    assert track.position_m == pytest.approx(poses[:, :2], abs=1e-3)
    assert np.sin(track.heading_rad - poses[:, 2]) == pytest.approx(np.zeros(25), abs=1e-4)
    for k in range(25):
        expected = covariance[3 * k : 3 * k + 2, 3 * k : 3 * k + 2]
        assert np.linalg.norm(track.covariance_m2[k] - expected) < 0.01 * np.linalg.norm(expected)
        assert track.sigma_heading_rad[k] == pytest.approx(np.sqrt(covariance[3 * k + 2, 3 * k + 2]), rel=0.01)


def test_on_a_gently_turning_walk_the_graph_is_the_smoothed_filter() -> None:
    covariance = np.diag([0.001, 0.001, 0.002**2])
    start = StartPose((3.0, -2.0), 0.5, sigma_position_m=0.1, sigma_heading_rad=0.02)
    turns = 0.05 * np.sin(np.arange(80) / 9.0)
    rng = np.random.default_rng(6)
    walk = simulate(rng, turns, (3.0, -2.0, 0.5), 1.02, fix_every=10, sigma_fix_m=0.2, covariance=covariance)
    walk = with_near_fixes(walk)
    measurements = [*walk.measurements, *(relative(k, walk.truth[k, 2] + 0.7, 0.01) for k in range(0, 81, 8))]
    timeline = build_timeline(DEVICE, 0.0, measurements)
    smoothed = rts_smoother.smooth(timeline.nodes, run_filter(timeline, start, 0.03)[0].states)
    track = smooth_as_given(measurements, start, 0.03)
    assert track.position_m == pytest.approx(np.array([state.mean[:2] for state in smoothed]), abs=0.01)
    assert track.heading_rad == pytest.approx(np.array([state.mean[2] for state in smoothed]), abs=2e-3)
    for k, state in enumerate(smoothed):
        expected = state.covariance[:2, :2]
        assert np.linalg.norm(track.covariance_m2[k] - expected) < 0.02 * np.linalg.norm(expected)
        assert track.sigma_heading_rad[k] == pytest.approx(np.sqrt(state.covariance[2, 2]), rel=0.02)


@pytest.mark.parametrize("name", ["ekf", "factor-graph"])
@pytest.mark.parametrize("zero_rad", [0.0, 2.0, -3.0])
def test_the_zero_of_the_priors_is_of_no_meaning(name: str, zero_rad: float) -> None:
    plain = run(name, tied(turning_walk(), 0.0, range(3, 24, 3)), START)  # type: ignore[arg-type]
    other = run(name, tied(turning_walk(), zero_rad, range(3, 24, 3)), START)  # type: ignore[arg-type]
    assert other.position_m == pytest.approx(plain.position_m, abs=2e-3)
    assert other.sigma_heading_rad == pytest.approx(plain.sigma_heading_rad, rel=0.01)


@pytest.mark.parametrize("name", ["ekf", "factor-graph"])
def test_a_single_one_tells_nothing(name: str) -> None:
    walk = turning_walk().measurements
    alone = run(name, walk, START)  # type: ignore[arg-type]
    with_one = run(name, [*walk, relative(12, -2.0, 0.001)], START)  # type: ignore[arg-type]
    assert with_one.position_m == pytest.approx(alone.position_m, abs=1e-3)
    assert with_one.sigma_heading_rad == pytest.approx(alone.sigma_heading_rad, rel=1e-3)


def test_they_do_not_tell_where_north_is_and_need_no_start() -> None:
    walk = [*straight(20), *(relative(k, 1.0) for k in range(1, 21))]
    track = run("factor-graph", walk, StartPose())
    assert track.position_m[-1] == pytest.approx([14.0, 0.0], abs=1e-3)
    assert track.sigma_heading_rad[0] == pytest.approx(0.0, abs=1e-3)


def test_a_gross_one_counts_little_if_it_is_robust() -> None:
    walk = [*straight(30), *(relative(k, 0.5, 0.02, robust=True) for k in range(1, 31) if k != 15)]
    at_once = {
        robust: abs(run("factor-graph", [*walk, relative(15, 2.0, 0.02, robust)], StartPose()).heading_rad[15])
        for robust in (True, False)
    }
    assert at_once[False] > 0.02
    assert at_once[True] < 0.1 * at_once[False]


@pytest.mark.parametrize("shift_m", [0.0, 5e6])
def test_far_from_the_origin_they_tell_the_same(shift_m: float) -> None:
    """As in UTM coordinates, where a reference at the origin would be millions of metres away."""
    priors = [relative(k, 1.0 + 0.1 * (-1) ** k, 0.1, robust=True) for k in range(1, 31)]
    far = [*straight(30), *priors, fix(0, shift_m, shift_m, 0.3), fix(30, shift_m, shift_m + 21.0, 0.3)]
    near = [*straight(30), *priors, fix(0, 0.0, 0.0, 0.3), fix(30, 0.0, 21.0, 0.3)]
    found, expected = (run("factor-graph", walk, StartPose()) for walk in (far, near))
    assert found.position_m - shift_m == pytest.approx(expected.position_m, abs=1e-3)
    assert found.sigma_heading_rad == pytest.approx(expected.sigma_heading_rad, rel=1e-3)
    assert wrap_angle(found.heading_rad - expected.heading_rad) == pytest.approx(np.zeros(31), abs=1e-4)
