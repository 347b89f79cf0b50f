"""Newton's method for a walk's graph with tethers.

A tether costs nothing within its length and the square of the excess beyond. Gauss and Newton's method leaves out
that a taut line also resists to be turned: the further its ends move across it, the longer it gets. A stiff tether
then allows steps of centimetres only, and Levenberg and Marquardt's method, which is made for that, takes hundreds.
The force in the line over its length is the missing stiffness. Which tethers are taut is decided anew at each step,
which the cost allows, for it has no jump and no kink. A step that makes others taut would still have to be short:
tethers are soft at first, with the optimum of one strictness the start of the next. Ten to twenty steps lead there.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import gtsam
import numpy as np
from numpy.typing import NDArray

from pdr_est.estimators.gtsam_factors import LEAST_SIGMA, Keys
from pdr_est.estimators.gtsam_marginals import ordering_of, to_map
from pdr_est.estimators.ties import Tie
from pdr_est.frames import Array

_MOST_STEPS = 200
# Promised falls of the error, half a chi square, behind which no step follows; with tethers the last digits are slow.
EXACTLY, EXACTLY_TETHERED, ROUGHLY = 1e-6, 1e-4, 1e-3
_HALVINGS = 20
_ENOUGH = 1e-4  # share of the fall that the slope promises (Armijo)
SOFTENINGS = (64.0, 8.0, 1.0)  # of the tethers' sigmas, one after the other


@dataclass(frozen=True)
class Tethers:
    """Distances between pairs of poses, ends (m, 2) by key, that cost beyond max_distance_m (m,) by sigma_m (m,)."""

    ends: NDArray[np.int64]
    max_distance_m: Array
    sigma_m: Array

    @classmethod
    def of(cls, ties: Sequence[Tie], keys: Keys) -> "Tethers":
        return cls(
            np.array([keys.of_tie(tie) for tie in ties], dtype=np.int64).reshape(-1, 2),
            np.array([tie.max_distance_m for tie in ties]),
            np.maximum(np.array([tie.sigma_m for tie in ties]), LEAST_SIGMA),
        )

    def softened(self, factor: float) -> "Tethers":
        return replace(self, sigma_m=factor * self.sigma_m)

    def error(self, pose: Array) -> float:
        """Half the sum of squares of what poses (n, 3) exceed, in sigmas."""
        excess_m = np.maximum(self._apart(pose)[1] - self.max_distance_m, 0.0)
        return 0.5 * float(np.sum((excess_m / self.sigma_m) ** 2))

    def taut(self, pose: Array, resisting: bool) -> gtsam.GaussianFactorGraph:
        """The tethers that are exceeded at poses (n, 3), linear in the changes of the poses; resisting: turns too."""
        apart, distance_m = self._apart(pose)
        graph = gtsam.GaussianFactorGraph()
        to_body = to_map(pose[:, 2])[:, :2, :]
        for i in np.flatnonzero(distance_m > self.max_distance_m):
            along = apart[i] / distance_m[i]
            excess_m = distance_m[i] - self.max_distance_m[i]
            rows = np.array([along, np.sqrt(excess_m / distance_m[i]) * np.array([-along[1], along[0]])])
            rows, short = rows / self.sigma_m[i], np.array([-excess_m / self.sigma_m[i], 0.0])
            kept = 2 if resisting else 1
            a, b = (int(end) for end in self.ends[i])
            unit = gtsam.noiseModel.Unit.Create(kept)
            graph.add(
                gtsam.JacobianFactor(a, rows[:kept] @ to_body[a], b, -rows[:kept] @ to_body[b], short[:kept], unit)
            )
        return graph

    def _apart(self, pose: Array) -> tuple[Array, Array]:
        apart = pose[self.ends[:, 0], :2] - pose[self.ends[:, 1], :2]
        return apart, np.hypot(apart[:, 0], apart[:, 1])


def poses_of(values: gtsam.Values, count: int) -> Array:
    """Poses (count, 3) with the keys 0 … count - 1."""
    return np.asarray(gtsam.utilities.extractPose2(values)[:count])


def linearised(
    graph: gtsam.NonlinearFactorGraph, tethers: Tethers, values: gtsam.Values, poses: int, resisting: bool = False
) -> gtsam.GaussianFactorGraph:
    """The linear system at some values, with the taut tethers; resisting: of Newton's method, not Gauss and his."""
    linear = graph.linearize(values)
    if len(tethers.ends):
        linear.push_back(tethers.taut(poses_of(values, poses), resisting))
    return linear


def minimised(
    graph: gtsam.NonlinearFactorGraph,
    tethers: Tethers,
    values: gtsam.Values,
    poses: int,
    order: Sequence[int],
    least_promise: float,
) -> gtsam.Values:
    """The values of least error, from values near them. poses: how many variables, the first ones, are poses of
    devices; order: of their elimination; least_promise: fall of the error below which the step
    that promises it is the last."""
    ordering = ordering_of(order)

    def error(at: gtsam.Values) -> float:
        return float(graph.error(at)) + (tethers.error(poses_of(at, poses)) if len(tethers.ends) else 0.0)

    here = error(values)
    for _ in range(_MOST_STEPS):
        linear = linearised(graph, tethers, values, poses, resisting=True)
        change = linear.optimize(ordering, gtsam.EliminateQR)
        promise = linear.error(gtsam.VectorValues.Zero(change)) - linear.error(change)
        if promise < least_promise:
            return values.retract(change)
        for halving in range(_HALVINGS):
            share = 0.5**halving
            there = values.retract(change.scale(share) if halving else change)
            error_there = error(there)
            if error_there <= here - 2.0 * _ENOUGH * share * promise:
                break
        else:  # rounding leaves no better values
            return values
        values, here = there, error_there
    return values
