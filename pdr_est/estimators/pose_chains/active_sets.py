"""Search for the active set of one step of Newton's method: the tethers that its solution leaves violated."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from pdr_est.estimators.pose_chains.tether_constraints import LinearTethers
from pdr_est.frames import Array

MAX_ACTIVE_SETS = 8
"""Solutions of one linear system with different active sets."""

WORTHWHILE = 0.1
"""Share of the predicted decrease by which another active set must improve it to go on."""

Change = TypeVar("Change")


@dataclass(frozen=True)
class NewtonStep(Generic[Change]):
    """One step of Newton's method.

    Attributes
    ----------
    change
        Changes of the variables.
    predicted_decrease
        Decrease of the error of the linear system.
    active
        (m,) tethers that are violated after the change.
    """

    change: Change
    predicted_decrease: float
    active: NDArray[np.bool_]


def step_with_tethers(
    near: LinearTethers,
    active: NDArray[np.bool_] | None,
    here: float,
    nothing: Change,
    solve: Callable[[NDArray[np.bool_], Array], tuple[Change, Array, float]],
) -> NewtonStep[Change]:
    """Find the step of least error whose active set is the one that it was computed with.

    Parameters
    ----------
    near
        The tethers (m,), linearised.
    active
        Active set to begin with (m,), that of the last step; None for the tethers that are violated now.
    here
        Error of the linear system and of the tethers before the step.
    nothing
        Change that changes nothing, for a search that improves nothing.
    solve
        Solution of the linear system for an active set (m,) and the violations (m,), m, that are expected: changes of
        the variables, changes (n, 3) of the poses, and the error that they leave without the tethers.
    """
    expected_violation_m, before = near.violation_m, np.inf
    active = expected_violation_m > 0.0 if active is None else active
    best, tried = NewtonStep(nothing, -np.inf, active), set[bytes]()
    for _ in range(MAX_ACTIVE_SETS):
        change, moves, rest = solve(active, expected_violation_m)
        left = rest + near.error(moves, expected_violation_m)
        expected_violation_m = near.violation_m + near.displacements(moves)[0]
        tried.add(active.tobytes())
        active = expected_violation_m > 0.0
        if here - left > best.predicted_decrease:
            best = NewtonStep(change, here - left, active)
        enough = best.predicted_decrease > 0.0 and before - left < WORTHWHILE * best.predicted_decrease
        if enough or active.tobytes() in tried:
            break
        before = left
    return best
