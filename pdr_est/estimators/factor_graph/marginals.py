"""Elimination of a walk's linear system from the end of the walk to its start, and the marginal covariances.

Standard deviations range from a tenth of a millimetre to the reach of a gap of hours. The ratio of their squares
exceeds the precision of floating-point numbers. Systems are therefore eliminated by QR and not by Cholesky, and from
the end of the walk to its start, where there always is a prior, so that no elimination depends on rounding errors.
"""

from collections import defaultdict
from collections.abc import Iterator, Sequence

import gtsam
import numpy as np

from pdr_est.estimators.pose_chains.linear_rows import to_map
from pdr_est.frames import Array


def ordering_of(keys: Sequence[int]) -> gtsam.Ordering:
    """Make the elimination ordering that eliminates the given keys one after the other."""
    ordering = gtsam.Ordering()
    for key in keys:
        ordering.push_back(key)
    return ordering


def marginal_covariances(
    linear: gtsam.GaussianFactorGraph, order: Sequence[int], first: Sequence[int] = ()
) -> dict[int, Array]:
    """Compute the marginal covariances of a linear system's variables.

    Eliminated in `order`, a variable is R⁻¹ (white noise - S parents), its parents the variables that it is connected
    to and that are eliminated later. In reverse order each covariance follows from those before by sums alone, and
    only the joint covariance of variables that are still parents is kept, so that the cost is linear in the length of
    a walk.

    Parameters
    ----------
    linear : gtsam.GaussianFactorGraph
        Linear system.
    order : sequence of int
        Keys in the order of elimination.
    first : sequence of int
        Keys that are eliminated before, and whose covariances are not wanted.

    Returns
    -------
    dict of int to (k, k) arrays
        Covariance of each variable of `order` in its own frame.
    """
    eliminated = linear.eliminateSequential(ordering_of((*first, *order)), gtsam.EliminateQR)
    # GTSAM eliminates disconnected parts of a graph one after the other, whatever the ordering.
    of_key = {conditional.keys()[0]: conditional for conditional in map(eliminated.at, range(eliminated.size()))}
    keys = list(reversed(order))
    conditionals = [of_key[key] for key in keys]
    roots = [conditional.R() for conditional in conditionals]
    parents = [list(conditional.keys())[1:] for conditional in conditionals]
    inverse, own = _inverses(roots)
    covariance: dict[int, Array] = {}
    joint = np.zeros((0, 0))  # covariance of the variables that are kept, in their places
    for k, place, known, size in _places(keys, parents, [len(root) for root in roots]):
        if len(joint) < size:
            joint = np.pad(joint, (0, size - len(joint)))
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


def _inverses(roots: Sequence[Array]) -> tuple[list[Array], list[Array]]:
    """Return the inverse R⁻¹ of every matrix, and R⁻¹ R⁻ᵀ; matrices of one size are inverted together."""
    inverse: list[Array] = [np.zeros(0)] * len(roots)
    own: list[Array] = [np.zeros(0)] * len(roots)
    rows_of_size: dict[int, list[int]] = defaultdict(list)
    for k, root in enumerate(roots):
        rows_of_size[len(root)].append(k)
    for rows in rows_of_size.values():
        inverses = np.linalg.inv(np.array([roots[k] for k in rows]))
        for k, one, product in zip(rows, inverses, inverses @ inverses.transpose(0, 2, 1), strict=True):
            inverse[k], own[k] = one, product
    return inverse, own


def _places(
    keys: Sequence[int], parents: Sequence[Sequence[int]], sizes: Sequence[int]
) -> Iterator[tuple[int, slice, list[slice], int]]:
    """Assign rows of the joint covariance to the variables.

    Yields for each variable its number, its rows, those of its parents, and the number of rows in use. Rows are used
    again once no later variable has the variable that had them for a parent; what is in them by then is not read.
    """
    last_use = {key: k for k, connected in enumerate(parents) for key in connected}
    ends: dict[int, list[int]] = defaultdict(list)
    for key, k in last_use.items():
        ends[k].append(key)
    rows: dict[int, slice] = {}
    free: dict[int, list[slice]] = defaultdict(list)  # by number of rows
    in_use = 0
    for k, (key, size) in enumerate(zip(keys, sizes, strict=True)):
        if not free[size]:
            free[size].append(slice(in_use, in_use + size))
            in_use += size
        rows[key] = free[size].pop()
        yield k, rows[key], [rows[parent] for parent in parents[k]], in_use
        for gone in ends.pop(k, ()):
            free[rows[gone].stop - rows[gone].start].append(rows[gone])
        if key not in last_use:
            free[size].append(rows[key])


def in_map(change: gtsam.VectorValues, heading_rad: Array) -> Array:
    """Turn the changes (n, 3) of the variables 0 … n - 1 from their own frames into the map frame."""
    body = change.vector()[: 3 * len(heading_rad)].reshape(-1, 3)
    turned: Array = np.einsum("nij,nj->ni", to_map(heading_rad), body)
    return turned
