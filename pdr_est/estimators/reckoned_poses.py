"""Dead reckoning of all poses of a walk at once."""

from collections.abc import Sequence
from math import exp

import numpy as np

from pdr_est.estimators.common.motion_model import LOG_SCALE, GaussianState
from pdr_est.estimators.common.nodes import Node
from pdr_est.frames import Array


def reckon_means(nodes: Sequence[Node], first: Array) -> Array:
    """Compute the means (n, 5) at all nodes by dead reckoning from the mean (5,) at the first node."""
    pose = _reckoned(nodes, 0, first)
    return np.column_stack([pose, np.tile(first[3:], (len(nodes), 1))])


def reckon_poses(nodes: Sequence[Node], anchor: int, state: GaussianState) -> tuple[Array, Array]:
    """Compute the poses at all nodes by dead reckoning from the state at one of them, without a loop.

    The parameters are those of `motion_model.reckon`. The heading noise of motion j, of variance v, turns the rest of
    the way about the place p of node j. With J a quarter turn, its share of the position covariance at node k is
    v J(p_k - p_j) (J(p_k - p_j))ᵀ, and its covariance c with the displacement adds c (J(p_k - p_j))ᵀ and the
    transpose. Multiplied out, all of it follows from running sums over j of v, c - v J p_j, and what has no p_k.

    Returns
    -------
    Array
        Poses (n, 3).
    Array
        Their covariances (n, 3, 3).
    """
    pose = _reckoned(nodes, anchor, state.mean)
    off = pose[:, :2] - pose[anchor, :2]
    across = np.stack([-off[:, 1], off[:, 0]], axis=1)
    seen = np.zeros((len(nodes), 3, LOG_SCALE + 1))
    seen[:, range(3), range(3)] = 1.0
    seen[:, :2, 2], seen[:, :2, LOG_SCALE] = across, off
    covariance = seen @ state.covariance[: LOG_SCALE + 1, : LOG_SCALE + 1] @ seen.transpose(0, 2, 1)
    c, s = np.cos(pose[:, 2]), np.sin(pose[:, 2])
    to_map = np.zeros((len(nodes), 3, 3))
    to_map[:, 0, 0], to_map[:, 0, 1], to_map[:, 1, 0], to_map[:, 1, 1], to_map[:, 2, 2] = c, -s, s, c, 1.0
    noise = to_map @ np.array([node.covariance for node in nodes]) @ to_map.transpose(0, 2, 1)
    joint, variance = noise[:, :2, 2], noise[:, 2, 2]
    turned = variance[:, None] * across
    both = (0.5 * turned - joint)[:, :, None] * across[:, None, :]
    spread, aside, variance = (
        _summed_from(anchor, one)
        for one in (noise[:, :2, :2] + both + both.transpose(0, 2, 1), joint - turned, variance)
    )
    half = (aside + 0.5 * variance[:, None] * across)[:, :, None] * across[:, None, :]
    covariance[:, :2, :2] += spread + half + half.transpose(0, 2, 1)
    covariance[:, :2, 2] += aside + variance[:, None] * across
    covariance[:, 2, :2] = covariance[:, :2, 2]
    covariance[:, 2, 2] += variance
    return pose, covariance


def _reckoned(nodes: Sequence[Node], anchor: int, mean: Array) -> Array:
    """Return the poses (n, 3) at all nodes, given the mean of the state at one of them."""
    turn_rad, length_m = np.array([(node.heading_change_rad, node.length_m) for node in nodes]).T
    turned_rad = np.cumsum(turn_rad)
    heading_rad = mean[2] + (turned_rad - turned_rad[anchor])
    moves_m = exp(mean[LOG_SCALE]) * length_m[:, None] * np.stack([np.cos(heading_rad), np.sin(heading_rad)], axis=1)
    place_m = np.cumsum(moves_m, axis=0)
    return np.column_stack([mean[:2] + (place_m - place_m[anchor]), heading_rad])


def _summed_from(anchor: int, value: Array) -> Array:
    """Return the sums of values (n, ...) of the motions between the anchor and each node, in either direction."""
    total = np.cumsum(value, axis=0)
    total = total - total[anchor]
    total[:anchor] *= -1.0
    return np.asarray(total)
