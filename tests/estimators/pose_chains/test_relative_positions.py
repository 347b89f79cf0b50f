"""Normal equations in relative positions: their solution and covariances, also of walks that go far."""

from dataclasses import replace

import numpy as np
import pytest

from pdr_est.estimators.common.initial_state import starts_of
from pdr_est.estimators.common.tethers import node_tethers_between
from pdr_est.estimators.common.timeline import timelines_of
from pdr_est.estimators.factor_graph.initial_values import initial_states
from pdr_est.estimators.factor_graph.smoother import marginals_of
from pdr_est.estimators.factor_graph.smoothing_problem import SmoothingProblem, as_values
from pdr_est.estimators.pose_chains.linear_rows import LinearRows
from pdr_est.estimators.pose_chains.normal_equations import Elimination, NotBandedError
from pdr_est.estimators.pose_chains.pose_chains import PoseChains, linearised_rows
from pdr_est.frames import Array
from pdr_est.performance.odometry import SIGMA_SCALE, STEP_S, walk_of
from pdr_est.types.measurements import DeviceMeasurements, DeviceTether, HeadingPrior, StartPose, StepOdometry

START = StartPose((1.0, 2.0), 0.3, 0.1, 0.1)


def with_headings(devices: list[DeviceMeasurements], relative: bool) -> list[DeviceMeasurements]:
    """Give the first device headings, in the map or to a reference."""
    priors = [
        HeadingPrior("phone1", k * STEP_S, 0.1 * k, 0.2, relative=relative and k % 2 == 0, robust=k % 3 == 0)
        for k in range(0, 50, 5)
    ]
    return [replace(devices[0], measurements=(*devices[0].measurements, *priors)), *devices[1:]]


def problem_of(
    devices: list[DeviceMeasurements], tethers: list[DeviceTether], start: StartPose = START
) -> tuple[SmoothingProblem, Array]:
    """Return the problem of a walk, and its poses and references at the optimum."""
    timelines = timelines_of(devices, tethers)
    node_tethers, starts = node_tethers_between(timelines, tethers), starts_of(timelines, start)
    initial = initial_states(timelines, node_tethers, starts, SIGMA_SCALE)
    problem = SmoothingProblem(timelines, node_tethers, starts, initial)
    return problem, problem.optimised(problem.initial_point(initial), np.ones(len(devices)), 1e-8)


def rows_of(problem: SmoothingProblem, pose: Array) -> list[LinearRows]:
    starts = starts_of(problem.timelines, START)
    initial = initial_states(problem.timelines, [], starts, SIGMA_SCALE)
    keys = problem.keys
    chains = PoseChains.of_timelines(problem.timelines, keys.first, keys.references, starts, initial)
    near = problem.tethers.linearised(pose)
    rows = linearised_rows(chains.at_scales(np.ones(len(problem.timelines))), pose)
    return [*rows, *near.rows(near.violation_m > 0.0, near.violation_m)]


@pytest.mark.parametrize("relative", [False, True])
def test_changes_are_those_in_absolute_positions(relative: bool) -> None:
    known, tethers = walk_of(60, 2)
    problem, pose = problem_of(with_headings(known, relative), tethers)
    pose = pose + 0.1 * np.random.default_rng(0).standard_normal(pose.shape)
    rows, border = rows_of(problem, pose), len(problem.keys.present_references)
    found = [
        one.solution(one.equations(rows, pose[:, 2]))
        for one in (Elimination(problem.variables.order, border, relative) for relative in (False, True))
    ]
    assert border == relative
    assert found[1] == pytest.approx(found[0], rel=1e-6, abs=1e-7)


@pytest.mark.parametrize("relative", [False, True])
@pytest.mark.parametrize("start", [START, StartPose((1.0, 2.0))], ids=["known", "direction-unknown"])
def test_covariances_are_those_of_gtsam(start: StartPose, relative: bool) -> None:
    """A device that begins a little later, and does not step for a while, is none of the simple cases."""
    known, tethers = walk_of(60, 2)
    paused = [
        step for k, step in enumerate(known[1].measurements) if isinstance(step, StepOdometry) and not 20 < k < 30
    ]
    devices = with_headings([known[0], replace(known[1], measurements=tuple(paused))], relative)
    problem, pose = problem_of(devices, tethers, start)
    assert len(problem.keys.present_references) == relative
    found = problem.banded_marginals(pose, np.ones(2))
    assert found is not None
    values = as_values(pose)
    linear = problem.linear(values, np.ones(2), with_stiffness=False)
    expected = marginals_of(problem, linear.factors, values)
    assert found[0] == pytest.approx(expected[0], abs=1e-12)
    assert found[1] == pytest.approx(expected[1], rel=1e-6, abs=1e-8)


def test_a_walk_that_goes_far_has_well_conditioned_equations() -> None:
    known, tethers = walk_of(1500, 2)
    problem, pose = problem_of(known, tethers)
    pose[:, :2] *= 1e3
    rows = rows_of(problem, pose)
    absolute, relative = (Elimination(problem.variables.order, 0, one) for one in (False, True))
    with pytest.raises(NotBandedError):
        absolute.solution(absolute.equations(rows, pose[:, 2]))
    assert np.isfinite(relative.solution(relative.equations(rows, pose[:, 2]))).all()
