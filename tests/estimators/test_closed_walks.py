"""Walks that end where they began."""

import numpy as np
import pytest
from estimator_walks import DEVICE, SIGMA_SCALE, SimulatedWalk, fix, run, simulate
from least_squares import solve

from pdr_est.errors import EstimationError
from pdr_est.estimators.common.timeline import build_timeline
from pdr_est.types.measurements import LoopClosure, StartPose

START = StartPose((3.0, -2.0), 0.4, sigma_position_m=0.1, sigma_heading_rad=0.1)


def square(last_turn_rad: float = 0.0) -> SimulatedWalk:
    """Round a block of 6 by 6 steps; two of the last side are missing, and it ends with a turn."""
    turns = np.zeros(22)
    turns[[6, 12, 18]] = np.pi / 2.0
    turns[-1] += last_turn_rad
    return simulate(np.random.default_rng(3), turns, (3.0, -2.0, 0.5), 1.05)


def closed(sigma_m: float, device: str = DEVICE) -> LoopClosure:
    return LoopClosure(device, sigma_m)


@pytest.mark.parametrize("last_turn_rad", [-np.pi / 2.0, 0.0, np.pi / 2.0])
@pytest.mark.parametrize(("sigma_m", "share"), [(0.01, 0.01), (0.3, 0.15)])
def test_the_graph_is_dense_least_squares(sigma_m: float, share: float, last_turn_rad: float) -> None:
    """In any direction at the end, though GTSAM's error of a pose mixes the turn into the position; the
    covariances up to the curvature of the problem, if the walk misses its start by two sigma."""
    measurements = [*square(last_turn_rad).measurements, closed(sigma_m)]
    track = run("factor-graph", measurements, START)
    timeline = build_timeline(DEVICE, 0.0, measurements)
    mean, covariance = solve(timeline, START, SIGMA_SCALE, np.column_stack([track.position_m, track.heading_rad]))
    poses = mean[:-1].reshape(-1, 3)
    assert track.position_m == pytest.approx(poses[:, :2], abs=2e-3)
    assert np.sin(track.heading_rad - poses[:, 2]) == pytest.approx(np.zeros(23), abs=2e-3)
    assert track.length_scale == pytest.approx(np.exp(mean[-1]), abs=2e-3)
    for k in range(23):
        expected = covariance[3 * k : 3 * k + 2, 3 * k : 3 * k + 2]
        assert np.linalg.norm(track.covariance_m2[k] - expected) < share * np.linalg.norm(expected)


@pytest.mark.parametrize("name", ["ekf", "factor-graph"])
@pytest.mark.parametrize("start", [StartPose(), StartPose((3.0, -2.0), 0.4)])
def test_the_end_is_where_the_start_was(name: str, start: StartPose) -> None:
    track = run(name, [*square().measurements, closed(0.001)], start)  # type: ignore[arg-type]
    open_track = run(name, square().measurements, start)  # type: ignore[arg-type]
    assert np.linalg.norm(open_track.position_m[-1] - open_track.position_m[0]) > 0.5
    assert track.position_m[-1] == pytest.approx(track.position_m[0], abs=5e-3)
    assert np.sqrt(np.trace(track.covariance_m2[-1])) < 0.01


def test_the_middle_of_a_smoothed_walk_is_known_better() -> None:
    plain = run("factor-graph", square().measurements, START)
    with_closure = run("factor-graph", [*square().measurements, closed(0.1)], START)
    assert np.trace(with_closure.covariance_m2[18]) < 0.8 * np.trace(plain.covariance_m2[18])


def test_without_a_start_fixes_place_the_loop() -> None:
    fixes = [fix(6, 3.0, 4.0, 0.1), fix(12, -1.0, 4.0, 0.1)]
    track = run("factor-graph", [*square().measurements, *fixes, closed(0.01)], StartPose())
    assert track.position_m[-1] == pytest.approx(track.position_m[0], abs=0.03)
    assert np.sqrt(np.trace(track.covariance_m2[0])) > 0.1
    filtered = run("ekf", [*square().measurements, *fixes, closed(0.01)], StartPose())
    assert filtered.position_m == pytest.approx(
        run("ekf", [*square().measurements, *fixes], StartPose()).position_m, abs=1e-9
    )  # the filter has forgotten its start


def test_dead_reckoning_takes_no_notice_of_it_nor_one_device_of_that_of_another() -> None:
    plain = run("dead-reckoning", square().measurements, START)
    assert run("dead-reckoning", [*square().measurements, closed(0.1)], START).position_m == pytest.approx(
        plain.position_m
    )
    other = run("ekf", [*square().measurements, closed(0.1, "watch")], START)
    assert other.position_m == pytest.approx(run("ekf", square().measurements, START).position_m)


def test_a_walk_of_no_step_is_closed() -> None:
    for name in ("ekf", "factor-graph"):
        track = run(name, [closed(0.1)], StartPose((1.0, 2.0), 0.0, 0.1, 0.1))  # type: ignore[arg-type]
        assert track.position_m == pytest.approx(np.array([[1.0, 2.0]]))


@pytest.mark.parametrize("sigma_m", [0.0, -1.0, np.nan, np.inf])
def test_a_sigma_that_is_none_is_refused(sigma_m: float) -> None:
    with pytest.raises(EstimationError, match=r"loop closure of phone has the sigma .* m: give it one above 0"):
        run("factor-graph", [*square().measurements, closed(sigma_m)], START)
