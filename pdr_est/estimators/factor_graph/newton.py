"""Newton's method for a walk's factor graph with tethers as inequality constraints.

An active-set method: a tether costs nothing while it holds, so each step must identify the active set, the tethers
that are violated at the optimum. Each step solves the linear system of the graph with the factors of the active
tethers (`tether_factors`) until the tethers that the solution leaves violated are those it was solved with. Only then
is the error evaluated, and the step is shortened only because the walk is not linear in its poses. As stiff tethers
allow short steps only, their standard deviations are larger at first, and the optimum of one factor is the start of
the next one (continuation). For several devices each step is also composed anew from pose to pose
(`chained_retraction`), which keeps the number of steps from growing with the length of the walk.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import gtsam
import numpy as np
from numpy.typing import NDArray

from pdr_est.estimators.common.timeline import Timeline
from pdr_est.estimators.factor_graph.keys import GraphKeys, pose_array
from pdr_est.estimators.factor_graph.marginals import ordering_of
from pdr_est.estimators.factor_graph.tether_factors import add_rows
from pdr_est.estimators.factor_graph.wandering_errors import WalkFactors, WanderingFixes
from pdr_est.estimators.pose_chains.active_sets import NewtonStep, step_with_tethers
from pdr_est.estimators.pose_chains.chained_retraction import ChainedRetraction
from pdr_est.estimators.pose_chains.line_search import MAX_HALVINGS, MAX_STEPS, decreases_enough, may_end, unsettled
from pdr_est.estimators.pose_chains.tether_constraints import LinearTethers, TetherConstraints
from pdr_est.frames import Array

# Predicted decrease of the error, half a chi square, of the last step. With tethers the last digits converge slowly.
EXACTLY_TETHERED, ROUGHLY = 1e-4, 1e-3
SOFTLY = 1.0  # while the standard deviations of tethers are enlarged
CONTINUATION_FACTORS = (64.0, 8.0, 1.0)  # of the tethers' standard deviations, one after the other


@dataclass(frozen=True)
class Variables:
    """Variables of a walk's graph and their elimination ordering.

    Attributes
    ----------
    poses : int
        Number of poses; they have the keys 0 … poses - 1.
    order : tuple of int
        Keys of all variables in the order of elimination: poses from the last to the first, each wandering error
        behind the earliest pose that its fix belongs to, then references.
    ordering : gtsam.Ordering
        The same for GTSAM.
    retraction : ChainedRetraction or None
        How changes are composed along the walk; None to move every pose by itself.
    """

    poses: int
    order: tuple[int, ...]
    ordering: gtsam.Ordering
    retraction: ChainedRetraction | None

    @classmethod
    def of_timelines(cls, timelines: Sequence[Timeline], keys: GraphKeys, fixes: WanderingFixes) -> "Variables":
        """Order the variables of all devices."""
        times, errors = np.concatenate(keys.times_s), len(keys.fix_errors)
        # Of the variables at one time poses go first, then the errors from the last to the first.
        in_time = np.argsort(np.argsort([time_s for _, time_s in keys.fix_errors]))
        rank = np.concatenate([errors + np.arange(keys.poses), in_time])
        latest_first = np.lexsort((rank, np.concatenate([times, fixes.earliest_pose_s(times)])))[::-1]
        key = np.concatenate([np.arange(keys.poses), keys.first_fix_error + np.arange(errors)])
        order = (*key[latest_first].tolist(), *keys.present_references)
        retraction = ChainedRetraction.of_timelines(timelines) if len(timelines) > 1 else None
        return cls(keys.poses, order, ordering_of(order), retraction)

    def pose(self, values: gtsam.Values) -> Array:
        """Return the poses (poses, 3)."""
        return pose_array(values, self.poses)

    def pose_changes(self, change: gtsam.VectorValues) -> Array:
        """Return the changes (poses, 3) of the poses along their own axes."""
        return np.asarray(change.vector()[: 3 * self.poses].reshape(-1, 3))

    def retracted(self, values: gtsam.Values, change: gtsam.VectorValues) -> list[gtsam.Values]:
        """Return the values that a change leads to, in each of the ways that agree to first order."""
        each = values.retract(change)
        if self.retraction is None:
            return [each]
        chained = gtsam.Values(each)
        moved = self.retraction.moved(self.pose(values), self.pose_changes(change))
        for key, (east_m, north_m, heading_rad) in enumerate(moved.tolist()):
            chained.update(key, gtsam.Pose2(east_m, north_m, heading_rad))
        return [chained, each]


@dataclass(frozen=True)
class LinearSystem:
    """Linear system of the graph with active tethers.

    Attributes
    ----------
    factors : gtsam.GaussianFactorGraph
        The linear factors. A tether is one row in the poses that its ends lie between.
    """

    factors: gtsam.GaussianFactorGraph

    def solution(self, variables: Variables) -> gtsam.VectorValues:
        """Return the changes of least error of all variables."""
        return self.factors.eliminateSequential(variables.ordering, gtsam.EliminateQR).optimize()


def linear_system(
    graph: gtsam.NonlinearFactorGraph | WalkFactors,
    tethers: TetherConstraints,
    values: gtsam.Values,
    variables: Variables,
    with_stiffness: bool,
) -> LinearSystem:
    """Linearise a graph together with the tethers that are violated at some values.

    Parameters
    ----------
    graph : gtsam.NonlinearFactorGraph or WalkFactors
        All factors but the tethers.
    tethers : TetherConstraints
        All tethers.
    values : gtsam.Values
        Values of all variables but those of tethers.
    variables : Variables
        Their ordering.
    with_stiffness : bool
        Whether active tethers also resist displacements across them, as for Newton's method; otherwise the system is
        that of Gauss-Newton.
    """
    linear = graph.linearize(values)
    if not len(tethers):
        return LinearSystem(linear)
    near = tethers.linearised(variables.pose(values))
    violation_m = near.violation_m if with_stiffness else 0.0 * near.violation_m
    return _with_tethers(linear, near, near.violation_m > 0.0, violation_m)


def _with_tethers(
    linear: gtsam.GaussianFactorGraph,
    near: LinearTethers,
    active: NDArray[np.bool_],
    expected_violation_m: Array,
) -> LinearSystem:
    """Add the rows of the active tethers, and their stiffness, to a copy of a linear system."""
    system = gtsam.GaussianFactorGraph()
    system.push_back(linear)
    for rows in near.rows(active, expected_violation_m):
        add_rows(system, rows)
    return LinearSystem(system)


def minimised(
    graph: gtsam.NonlinearFactorGraph | WalkFactors,
    tethers: TetherConstraints,
    values: gtsam.Values,
    variables: Variables,
    tolerance: float,
) -> gtsam.Values:
    """Minimise the error of a graph and its tethers.

    Parameters
    ----------
    graph, tethers, variables
        As for `linear_system`.
    values : gtsam.Values
        Initial values.
    tolerance : float
        Predicted decrease of the error below which a step is the last one.

    Raises
    ------
    EstimationError
        If the variables do not settle.
    """

    def error(at: gtsam.Values) -> float:
        return float(graph.error(at)) + (tethers.error(variables.pose(at)) if len(tethers) else 0.0)

    here, active = error(values), None
    for _ in range(MAX_STEPS):
        step = newton_step(graph.linearize(values), tethers, values, variables, active)
        if step.predicted_decrease < tolerance:
            there = values.retract(step.change)
            return there if error(there) <= here else values
        found = line_search(step, values, variables, error, here)
        if found is None:  # no decrease beyond rounding
            return values
        (values, here), active = found, step.active
    if not may_end(variables.poses, step.predicted_decrease, tolerance):
        raise unsettled(variables.poses, step.predicted_decrease)
    return values


GraphStep = NewtonStep[gtsam.VectorValues]
"""Step in the variables of a graph."""


def newton_step(
    linear: gtsam.GaussianFactorGraph,
    tethers: TetherConstraints,
    values: gtsam.Values,
    variables: Variables,
    active: NDArray[np.bool_] | None,
) -> GraphStep:
    """Find the step of least error whose active set is the one that it was computed with.

    Parameters
    ----------
    linear : gtsam.GaussianFactorGraph
        Graph without tethers, linearised at `values`.
    tethers, values, variables
        As for `linear_system`.
    active : (m,) array of bool or None
        Active set to begin with, that of the last step; None for the tethers that are violated at `values`.
    """
    if not len(tethers):
        change = LinearSystem(linear).solution(variables)
        predicted_decrease = linear.error(values.zeroVectors()) - linear.error(change)
        return NewtonStep(change, predicted_decrease, np.zeros(0, dtype=np.bool_))
    pose = variables.pose(values)
    near = tethers.linearised(pose)

    def solve(tight: NDArray[np.bool_], expected_violation_m: Array) -> tuple[gtsam.VectorValues, Array, float]:
        change = _with_tethers(linear, near, tight, expected_violation_m).solution(variables)
        return change, variables.pose_changes(change), linear.error(change)

    # Not the graph's own error: a robust factor is linearised with its weight, and the square is not its cost.
    here = linear.error(values.zeroVectors()) + tethers.error(pose)
    return step_with_tethers(near, active, here, gtsam.VectorValues(), solve)


def line_search(
    step: GraphStep,
    values: gtsam.Values,
    variables: Variables,
    error: Callable[[gtsam.Values], float],
    here: float,
) -> tuple[gtsam.Values, float] | None:
    """Halve a step until the error decreases enough (Armijo's condition).

    Parameters
    ----------
    step : GraphStep
        Step to shorten.
    values, variables
        Values that the step begins at.
    error : callable
        Error of the graph and its tethers at some values.
    here : float
        Error at `values`.

    Returns
    -------
    values, error : gtsam.Values and float, or None
        Values with a lower error; None if there are none along the step.
    """
    for halving in range(MAX_HALVINGS):
        share = 0.5**halving
        change = step.change.scale(share) if halving else step.change
        reached = [(there, error(there)) for there in variables.retracted(values, change)]
        there, error_there = min(reached, key=lambda one: one[1])
        if decreases_enough(error_there, here, share, step.predicted_decrease):
            return there, error_there
    return None
