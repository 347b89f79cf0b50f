"""Costs, rows and optimum on arrays are those of the factor graph in GTSAM."""

from dataclasses import replace

import gtsam
import numpy as np
import pytest

from pdr_est.errors import EstimationError
from pdr_est.estimators.common.initial_state import starts_of
from pdr_est.estimators.common.tethers import node_tethers_between
from pdr_est.estimators.common.timeline import timelines_of
from pdr_est.estimators.factor_graph.initial_values import initial_states
from pdr_est.estimators.factor_graph.keys import pose_array, values_of_poses
from pdr_est.estimators.factor_graph.newton import minimised
from pdr_est.estimators.factor_graph.smoothing_problem import SmoothingProblem
from pdr_est.estimators.pose_chains.linear_rows import LinearRows
from pdr_est.estimators.pose_chains.normal_equations import Elimination, NotBandedError
from pdr_est.estimators.pose_chains.pose_chains import PoseChains, cost_of, linearised_rows
from pdr_est.performance.odometry import SIGMA_SCALE, STEP_S, walk_of
from pdr_est.types.measurements import HeadingPrior, PositionFix, StartPose

START = StartPose((1.0, 2.0), 0.3, 0.1, 0.1)


def test_costs_rows_and_optimum_are_those_of_gtsam() -> None:
    known, tethers = walk_of(60, 2)
    priors = [
        HeadingPrior("phone1", k * STEP_S, 0.1 * k, 0.2, relative=k % 2 == 0, robust=k % 3 == 0)
        for k in range(0, 50, 5)
    ]
    fixes = [PositionFix(k * STEP_S, np.array([k, 1.0]), np.diag([1.0, 4.0]), robust=k == 20) for k in (10, 20)]
    devices = [replace(known[0], measurements=(*known[0].measurements, *priors, *fixes)), known[1]]
    timelines = timelines_of(devices, tethers)
    node_tethers, starts = node_tethers_between(timelines, tethers), starts_of(timelines, START)
    initial = initial_states(timelines, node_tethers, starts, SIGMA_SCALE)
    problem, scale = SmoothingProblem(timelines, node_tethers, starts, initial), np.array([1.1, 0.9])
    chains = PoseChains.of_timelines(timelines, problem.keys.first, problem.keys.references, starts, initial)
    residuals, factors = chains.at_scales(scale), problem.without_tethers(scale)
    rng, start = np.random.default_rng(0), problem.initial_values(initial)
    pose = pose_array(start, problem.keys.poses + 1)
    pose = pose + 0.3 * rng.standard_normal(pose.shape)
    values, change = values_of_poses(pose), rng.standard_normal(pose.shape)
    assert cost_of(residuals, pose) == pytest.approx(factors.error(values), rel=1e-12)
    moved = gtsam.VectorValues()
    for key, own in enumerate(change):
        moved.insert(key, own)
    square = sum(0.5 * np.sum(rows.left_over(change) ** 2) for rows in linearised_rows(residuals, pose))
    assert square == pytest.approx(factors.linearize(values).error(moved), rel=1e-9)
    found = problem.poses(problem.optimised(start, scale, 1e-8))
    expected = problem.poses(minimised(factors, problem.tethers, start, problem.variables, 1e-8))
    assert found == pytest.approx(expected, abs=1e-5)


def test_border_and_band_give_the_least_squares() -> None:
    rng = np.random.default_rng(1)
    rows = [
        LinearRows(
            np.array(pose), rng.standard_normal((len(pose), 3, 3 * len(pose[0]))), rng.standard_normal((len(pose), 3))
        )
        for pose in ([[0]], [[k, k + 1] for k in range(5)], [[6, k] for k in range(6)])
    ]
    elimination = Elimination([5, 4, 3, 2, 1, 0, 6], 1)
    found = elimination.solution(elimination.equations(rows, np.zeros(7)))
    matrix, right = [], []
    for one in rows:
        for pose, jacobian, wanted in zip(one.pose, one.jacobian, one.right, strict=True):
            whole = np.zeros((3, 7, 3))
            for k, number in enumerate(pose):
                whole[:, number] += jacobian[:, 3 * k : 3 * k + 3]
            matrix.append(whole.reshape(3, 21))
            right.append(wanted)
    expected = np.linalg.lstsq(np.concatenate(matrix), np.concatenate(right), rcond=None)[0]
    assert found == pytest.approx(expected.reshape(7, 3), rel=1e-6, abs=1e-9)
    with pytest.raises(NotBandedError, match="no Cholesky factor"):
        elimination.solution(elimination.equations(rows[:1], np.zeros(7)))


@pytest.mark.parametrize("place", ["pose_chains.newton_on_arrays", "factor_graph.newton"])
def test_poses_that_do_not_settle_are_refused_in_words(place: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(f"pdr_est.estimators.{place}.MAX_STEPS", 1)
    known, tethers = walk_of(40, 2)
    timelines = timelines_of(known, tethers)
    node_tethers, starts = node_tethers_between(timelines, tethers), starts_of(timelines, START)
    initial = initial_states(timelines, node_tethers, starts, SIGMA_SCALE)
    problem, scale = SmoothingProblem(timelines, node_tethers, starts, initial), np.ones(2)
    turned = np.add(pose_array(problem.initial_values(initial), problem.keys.poses), (0.0, 0.0, 0.3))
    begin, factors = values_of_poses(turned), problem.without_tethers(scale)
    on_arrays = place.startswith("pose_chains")
    with pytest.raises(EstimationError, match=r"\d+ poses do not settle: .* or use ekf"):
        _ = (
            problem.optimised(begin, scale, 1e-8)
            if on_arrays
            else minimised(factors, problem.tethers, begin, problem.variables, 1e-8)
        )
