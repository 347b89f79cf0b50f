"""Newton's method for a walk's graph with tethers.

A tether costs nothing within its length and the square of the excess beyond, so that Newton's method has to find out
which of them are taut. Each step solves the linear system until those that it leaves exceeded are those that it was
solved with; only then does it look at the error, and is shortened only for what is not linear in the walk. For that
stiff tethers allow little: they are soft at first, with the optimum of one strictness the start of the next. And the
steps of several devices are walked again from step to step (`rewalking`): their number then hardly grows with the
length of a walk.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import gtsam
import numpy as np
from numpy.typing import NDArray

from pdr_est.estimators.common.timeline import Timeline
from pdr_est.estimators.factor_graph.chained_retraction import ChainedRetraction
from pdr_est.estimators.factor_graph.factors import Keys
from pdr_est.estimators.factor_graph.marginals import ordering_of
from pdr_est.estimators.factor_graph.tether_constraints import TetherConstraints
from pdr_est.frames import Array

_MOST_STEPS = 200
# Promised falls of the error, half a chi square, behind which no step follows; with tethers the last digits are slow.
EXACTLY, EXACTLY_TETHERED, ROUGHLY = 1e-6, 1e-4, 1e-3
SOFTLY = 1.0  # while tethers are softer than they should be
_HALVINGS = 20
_ENOUGH = 1e-4  # share of the fall that the slope promises (Armijo)
_SWITCHES = 8  # most solutions of one linear system, with one set of taut tethers after the other
_WORTHWHILE = 0.1  # of the step's promise, that another solution must have added for yet another one
CONTINUATION_FACTORS = (64.0, 8.0, 1.0)  # of the tethers' sigmas, one after the other


@dataclass(frozen=True)
class Variables:
    """poses: how many variables, the first ones, are poses of devices; order: of elimination, all of them; rewalking:
    None to move every pose by itself."""

    poses: int
    order: tuple[int, ...]
    ordering: gtsam.Ordering
    rewalking: ChainedRetraction | None

    @classmethod
    def of(cls, timelines: Sequence[Timeline], keys: Keys) -> "Variables":
        """Eliminated are poses from the last to the first, then the references."""
        times = np.concatenate([[node.time_s for node in timeline.nodes] for timeline in timelines])
        latest_first = np.lexsort((np.arange(len(times)), times))[::-1]
        order = (*latest_first.tolist(), *keys.present_references)
        return cls(
            keys.poses, order, ordering_of(order), ChainedRetraction.of(timelines) if len(timelines) > 1 else None
        )

    def pose(self, values: gtsam.Values) -> Array:
        """Poses (poses, 3)."""
        return np.asarray(gtsam.utilities.extractPose2(values)[: self.poses])

    def of_poses(self, change: gtsam.VectorValues) -> Array:
        """Changes (poses, 3) of the poses, along their own axes."""
        return np.asarray(change.vector().reshape(-1, 3)[: self.poses])

    def moved(self, values: gtsam.Values, change: gtsam.VectorValues) -> list[gtsam.Values]:
        """Where a change may lead to: the same to first order."""
        each = values.retract(change)
        if self.rewalking is None:
            return [each]
        together = gtsam.Values()
        walked = self.rewalking.walked(self.pose(values), self.of_poses(change))
        for key, (east_m, north_m, heading_rad) in enumerate(walked.tolist()):
            together.insert(key, gtsam.Pose2(east_m, north_m, heading_rad))
        for key in self.order[self.poses :]:
            together.insert(key, each.atPose2(key))
        return [together, each]


def linearised(
    graph: gtsam.NonlinearFactorGraph,
    tethers: TetherConstraints,
    values: gtsam.Values,
    variables: Variables,
    resisting: bool,
) -> gtsam.GaussianFactorGraph:
    """The linear system at some values, with the taut tethers; resisting: of Newton's method, not Gauss and his."""
    linear = graph.linearize(values)
    if len(tethers):
        near = tethers.near(variables.pose(values))
        linear.push_back(
            near.factors(near.violation_m > 0.0, near.violation_m if resisting else 0.0 * near.violation_m)
        )
    return linear


def minimised(
    graph: gtsam.NonlinearFactorGraph,
    tethers: TetherConstraints,
    values: gtsam.Values,
    variables: Variables,
    least_promise: float,
) -> gtsam.Values:
    """The values of least error, from values near them. least_promise: fall of the error below which the step that
    promises it is the last."""

    def error(at: gtsam.Values) -> float:
        return float(graph.error(at)) + (tethers.error(variables.pose(at)) if len(tethers) else 0.0)

    here, active = error(values), None
    for _ in range(_MOST_STEPS):
        step = _step(graph.linearize(values), tethers, values, variables, active)
        if step.predicted_decrease < least_promise:
            there = values.retract(step.change)
            return there if error(there) <= here else values
        found = line_search(step, values, variables, error, here)
        if found is None:  # rounding leaves no better values
            return values
        (values, here), active = found, step.active
    return values


@dataclass(frozen=True)
class _Step:
    """change: of all variables; promise: by how much the linear system's error falls; taut: (m,) tethers that the
    change leaves exceeded."""

    change: gtsam.VectorValues
    predicted_decrease: float
    active: NDArray[np.bool_]


def _step(
    linear: gtsam.GaussianFactorGraph,
    tethers: TetherConstraints,
    values: gtsam.Values,
    variables: Variables,
    active: NDArray[np.bool_] | None,
) -> _Step:
    """The step of least error in the linear system with those tethers that it leaves exceeded. taut: where the last
    step left them so."""
    if not len(tethers):
        change = _solution(linear, variables)
        predicted_decrease = linear.error(values.zeroVectors()) - linear.error(change)
        return _Step(change, predicted_decrease, np.zeros(0, dtype=np.bool_))
    near = tethers.near(variables.pose(values))
    # Not the graph's own error: a robust factor is linear with its weight, and the square then is not its cost.
    here = linear.error(values.zeroVectors()) + tethers.error(variables.pose(values))
    expected_violation_m, before = near.violation_m, np.inf
    active = expected_violation_m > 0.0 if active is None else active
    best, tried = _Step(gtsam.VectorValues(), -np.inf, active), set[bytes]()
    for _ in range(_SWITCHES):
        system = gtsam.GaussianFactorGraph()
        system.push_back(linear)
        system.push_back(near.factors(active, expected_violation_m))
        change = _solution(system, variables)
        moves = variables.of_poses(change)
        left = linear.error(change) + near.error(moves, expected_violation_m)
        expected_violation_m = near.violation_m + near.moved(moves)[0]
        tried.add(active.tobytes())
        active = expected_violation_m > 0.0
        if here - left > best.predicted_decrease:
            best = _Step(change, here - left, active)
        enough = best.predicted_decrease > 0.0 and before - left < _WORTHWHILE * best.predicted_decrease
        if enough or active.tobytes() in tried:
            break
        before = left
    return best


def _solution(linear: gtsam.GaussianFactorGraph, variables: Variables) -> gtsam.VectorValues:
    return linear.eliminateSequential(variables.ordering, gtsam.EliminateQR).optimize()


def line_search(
    step: _Step,
    values: gtsam.Values,
    variables: Variables,
    error: Callable[[gtsam.Values], float],
    here: float,
) -> tuple[gtsam.Values, float] | None:
    """The first values with a lower error, and that, along a step that is halved until there are some."""
    for halving in range(_HALVINGS):
        share = 0.5**halving
        change = step.change.scale(share) if halving else step.change
        reached = [(there, error(there)) for there in variables.moved(values, change)]
        there, error_there = min(reached, key=lambda one: one[1])
        if error_there <= here - 2.0 * _ENOUGH * share * step.predicted_decrease:
            return there, error_there
    return None
