"""Elimination of a walk's graph from its end to its start, and the covariances that follow from it.

Sigmas reach from a tenth of a millimetre to the reach of a gap of hours. Their squares are further apart than a
number has digits, so systems are eliminated by QR and not by Cholesky, and from the end of the walk to its start,
where there always is a prior: no elimination then depends on what rounding left of nothing.
"""

from collections.abc import Sequence

import gtsam
import numpy as np

from pdr_est.frames import Array


def ordering_of(keys: Sequence[int]) -> gtsam.Ordering:
    """The order in which variables are eliminated."""
    ordering = gtsam.Ordering()
    for key in keys:
        ordering.push_back(key)
    return ordering


def marginal_covariances(graph: gtsam.NonlinearFactorGraph, values: gtsam.Values, order: Sequence[int]) -> Array:
    """Covariances (n, 3, 3) of the variables 0 … n - 1, all of them Pose2, each in its own frame.

    Eliminated in `order`, a variable is R^-1 (white noise - S (those eliminated after it that it is tied to)). Read
    backwards, each covariance follows from those before by sums alone; only the variables that later ones are still
    tied to are kept, one a device and the references, so that a long walk costs its length.
    """
    eliminated = graph.linearize(values).eliminateSequential(ordering_of(order), gtsam.EliminateQR)
    # Of devices that nothing ties GTSAM eliminates the one after the other, whatever the order.
    of_key = {next(iter(one.keys())): one for one in (eliminated.at(k) for k in range(len(order)))}
    conditionals = [of_key[key] for key in reversed(order)]
    parents = [list(conditional.keys())[1:] for conditional in conditionals]
    last_use = {key: k for k, tied in enumerate(parents) for key in tied}
    covariance = np.empty((len(order), 3, 3))
    alive: list[int] = []
    joint = np.zeros((0, 0))  # covariance of the variables that are alive, in this order
    for k, (key, conditional) in enumerate(zip(reversed(order), conditionals, strict=True)):
        inverse = np.linalg.inv(conditional.R())
        own = inverse @ inverse.T
        across = np.zeros((3, len(joint)))
        if parents[k]:
            rows = np.concatenate([3 * alive.index(parent) + np.arange(3) for parent in parents[k]])
            carried = -inverse @ conditional.S()
            across = carried @ joint[rows]
            own = own + across[:, rows] @ carried.T
        covariance[key] = own
        joint = np.block([[joint, across.T], [across, own]])
        alive.append(key)
        stay = [i for i, other in enumerate(alive) if last_use.get(other, -1) > k]
        rows = (3 * np.array(stay, dtype=np.intp)[:, None] + np.arange(3)).ravel()
        alive, joint = [alive[i] for i in stay], joint[np.ix_(rows, rows)]
    return covariance


def in_map(change: gtsam.VectorValues, heading_rad: Array) -> Array:
    """Changes (n, 3) of the variables 0 … n - 1, turned from their own frames into the map frame."""
    body = change.vector().reshape(-1, 3)[: len(heading_rad)]
    turned: Array = np.einsum("nij,nj->ni", to_map(heading_rad), body)
    return turned


def to_map(heading_rad: Array) -> Array:
    """Rotations (n, 3, 3) of (forward, left, heading) into (east, north, heading)."""
    c, s = np.cos(heading_rad), np.sin(heading_rad)
    rotation = np.zeros((len(heading_rad), 3, 3))
    rotation[:, 0, 0], rotation[:, 0, 1], rotation[:, 1, 0], rotation[:, 1, 1] = c, -s, s, c
    rotation[:, 2, 2] = 1.0
    return rotation
