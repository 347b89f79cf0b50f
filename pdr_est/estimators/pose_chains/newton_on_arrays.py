"""Newton's method with an active set of tethers, on arrays of poses and banded matrices.

The method is that of `factor_graph.newton`, which explains it, and takes the same steps but for rounding.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pdr_est.estimators.pose_chains.active_sets import NewtonStep, step_with_tethers
from pdr_est.estimators.pose_chains.chained_retraction import ChainedRetraction
from pdr_est.estimators.pose_chains.line_search import MAX_HALVINGS, MAX_STEPS, decreases_enough, may_end, unsettled
from pdr_est.estimators.pose_chains.linear_rows import LinearRows
from pdr_est.estimators.pose_chains.normal_equations import Elimination
from pdr_est.estimators.pose_chains.pose_chains import cost_of, linearised_rows
from pdr_est.estimators.pose_chains.residuals import Residuals, moved_by
from pdr_est.estimators.pose_chains.tether_constraints import TetherConstraints
from pdr_est.frames import Array


@dataclass(frozen=True)
class ChainProblem:
    """Residuals and tethers of a walk.

    Attributes
    ----------
    residuals
        All residuals but those of tethers.
    tethers
        All tethers.
    elimination
        Elimination of the poses.
    retraction
        How changes are composed along the walk; None to move every pose by itself.
    """

    residuals: Sequence[Residuals]
    tethers: TetherConstraints
    elimination: Elimination
    retraction: ChainedRetraction | None

    def cost(self, pose: Array) -> float:
        """Return the cost of everything at poses (n, 3)."""
        return cost_of(self.residuals, pose) + (self.tethers.error(pose) if len(self.tethers) else 0.0)

    def moved(self, pose: Array, change: Array) -> list[Array]:
        """Return the poses that a change leads to, in each of the ways that agree to first order."""
        each = moved_by(pose, change)
        if self.retraction is None:
            return [each]
        count = self.retraction.count
        chained = self.retraction.moved(pose[:count], change[:count])
        return [np.concatenate([chained, each[count:]]), each]


def minimised_poses(problem: ChainProblem, pose: Array, tolerance: float) -> Array:
    """Minimise the cost of residuals and tethers.

    Parameters
    ----------
    problem
        Residuals and tethers.
    pose
        Initial poses (n, 3), references included.
    tolerance
        Predicted decrease of the cost below which a step is the last one.

    Raises
    ------
    NotBandedError
        If a linear system cannot be solved this way.
    EstimationError
        If the poses do not settle.
    """
    here, active = problem.cost(pose), None
    for _ in range(MAX_STEPS):
        step = _step(problem, pose, active)
        if step.predicted_decrease < tolerance:
            there = moved_by(pose, step.change)
            return there if problem.cost(there) <= here else pose
        found = _line_search(problem, step, pose, here)
        if found is None:  # no decrease beyond rounding
            return pose
        (pose, here), active = found, step.active
    if not may_end(len(pose), step.predicted_decrease, tolerance):
        raise unsettled(len(pose), step.predicted_decrease)
    return pose


def _step(problem: ChainProblem, pose: Array, active: NDArray[np.bool_] | None) -> NewtonStep[Array]:
    """Find the step of least cost whose active set is the one that it was computed with."""
    rows = linearised_rows(problem.residuals, pose)
    fixed = problem.elimination.equations(rows, pose[:, 2], keep_places=True)
    start, tethers = _square(rows, np.zeros_like(pose)), problem.tethers
    if not len(tethers):
        change = problem.elimination.solution(fixed)
        return NewtonStep(change, start - _square(rows, change), np.zeros(0, dtype=np.bool_))
    near = tethers.linearised(pose)

    def solve(tight: NDArray[np.bool_], expected_violation_m: Array) -> tuple[Array, Array, float]:
        held = near.rows(tight, expected_violation_m)
        change = problem.elimination.solution(fixed + problem.elimination.equations(held, pose[:, 2]))
        return change, change, _square(rows, change)

    here = start + tethers.error(pose)  # not the residuals' own cost: a kernel is linearised with its weight
    return step_with_tethers(near, active, here, np.zeros_like(pose), solve)


def _square(rows: Sequence[LinearRows], change: Array) -> float:
    """Return half the sum of squares that rows have left over after a change (n, 3)."""
    return 0.5 * float(sum(np.sum(one.left_over(change) ** 2) for one in rows if len(one.pose)))


def _line_search(
    problem: ChainProblem, step: NewtonStep[Array], pose: Array, here: float
) -> tuple[Array, float] | None:
    """Halve a step until the cost decreases enough (Armijo's condition); return poses and cost, or None."""
    for halving in range(MAX_HALVINGS):
        share = 0.5**halving
        reached = [(there, problem.cost(there)) for there in problem.moved(pose, share * step.change)]
        there, cost_there = min(reached, key=lambda one: one[1])
        if decreases_enough(cost_there, here, share, step.predicted_decrease):
            return there, cost_there
    return None
