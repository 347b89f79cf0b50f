"""Elimination of a walk's graph from its end to its start, and the covariances that follow from it.

Sigmas reach from a tenth of a millimetre to the reach of a gap of hours. Their squares are further apart than a
number has digits, so systems are eliminated by QR and not by Cholesky, and from the end of the walk to its start,
where there always is a prior: no elimination then depends on what rounding left of nothing.
"""

from collections import defaultdict
from collections.abc import Iterator, Sequence

import gtsam
import numpy as np

from pdr_est.frames import Array


def ordering_of(keys: Sequence[int]) -> gtsam.Ordering:
    """The order in which variables are eliminated."""
    ordering = gtsam.Ordering()
    for key in keys:
        ordering.push_back(key)
    return ordering


def marginal_covariances(linear: gtsam.GaussianFactorGraph, order: Sequence[int]) -> Array:
    """Covariances (n, 3, 3) of the variables 0 … n - 1 of a linear system, all of them Pose2, each in its own frame.

    Eliminated in `order`, a variable is R^-1 (white noise - S (those eliminated after it that it is tied to)). Read
    backwards, each covariance follows from those before by sums alone; only the variables that later ones are still
    tied to are kept, one a device and the references, so that a long walk costs its length.
    """
    eliminated = linear.eliminateSequential(ordering_of(order), gtsam.EliminateQR)
    # Of devices that nothing ties GTSAM eliminates the one after the other, whatever the order.
    of_key = {conditional.keys()[0]: conditional for conditional in map(eliminated.at, range(len(order)))}
    keys = list(reversed(order))
    conditionals = [of_key[key] for key in keys]
    parents = [list(conditional.keys())[1:] for conditional in conditionals]
    inverse = np.linalg.inv(np.array([conditional.R() for conditional in conditionals]))
    own = inverse @ inverse.transpose(0, 2, 1)
    covariance = np.empty((len(order), 3, 3))
    joint = np.zeros((0, 0))  # covariance of the variables in their places
    for k, place, known, size in _places(keys, parents):
        if len(joint) < 3 * size:
            joint = np.pad(joint, (0, 3 * size - len(joint)))
        if parents[k]:
            carried = -inverse[k] @ conditionals[k].S()
            across = carried @ (
                joint[known[0]] if len(known) == 1 else np.concatenate([joint[rows] for rows in known])
            )
            joint[place], joint[:, place] = across, across.T
            columns = [across[:, rows] for rows in known]
            own[k] += (columns[0] if len(known) == 1 else np.concatenate(columns, axis=1)) @ carried.T
        else:
            joint[place], joint[:, place] = 0.0, 0.0
        joint[place, place] = covariance[keys[k]] = own[k]
    return covariance


def _places(keys: Sequence[int], parents: Sequence[Sequence[int]]) -> Iterator[tuple[int, slice, list[slice], int]]:
    """For each variable its number, the rows in which it is kept, those of its parents, and how many variables are
    kept. A place is used again once nothing later is tied to who had it; what stands there until then is not read."""
    last_use = {key: k for k, tied in enumerate(parents) for key in tied}
    ends: dict[int, list[int]] = defaultdict(list)
    for key, k in last_use.items():
        ends[k].append(key)
    rows: dict[int, slice] = {}
    free: list[slice] = []
    size = 0
    for k, key in enumerate(keys):
        if not free:
            free.append(slice(3 * size, 3 * size + 3))
            size += 1
        rows[key] = free.pop()
        yield k, rows[key], [rows[parent] for parent in parents[k]], size
        free += [rows[gone] for gone in ends.pop(k, ())]
        if key not in last_use:
            free.append(rows[key])


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
