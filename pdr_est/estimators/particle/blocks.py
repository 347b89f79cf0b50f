"""Blocks of a few steps: their motion as one Gaussian, and the poses inside given those at both ends.

The backward simulation goes from block to block instead of from step to step: over several steps the noise adds up,
so that more particles may have led to a pose, and it costs less.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pdr_est.estimators.common.nodes import Node, with_heading_variance
from pdr_est.frames import Array

_LEAST_SIGMA = np.array([0.02, 0.02, 0.004])  # m, m and rad: below, no two particles would fit each other


@dataclass(frozen=True)
class BlockMotion:
    """Motion of a device over the k nodes of a block, seen from the pose before it, for a length scale of 1.

    Attributes
    ----------
    poses
        (k, 3) mean forward m, left m and turn rad at each node.
    gains
        (k, 3, 3) change of each pose for a change of the last one.
    information
        (3, 3) inverse covariance of the last pose.
    log_factor
        Logarithm of the probability of its turns, and of the root of the determinant of `information`: what stands
        before the exponential function in the density of the last pose, but for powers of 2 pi.
    """

    poses: Array
    gains: Array
    information: Array
    log_factor: float = 0.0


def block_motions(nodes: Sequence[Node]) -> list[BlockMotion]:
    """Return the motion over nodes, one for each turn hypothesis of the first node; no other node may have any."""
    first = nodes[0]
    if not first.turn_hypotheses:
        return [_motion(nodes, first.heading_change_rad, first.covariance, 0.0)]
    return [
        _motion(
            nodes,
            one.heading_change_rad,
            with_heading_variance(first.covariance, one.sigma_rad**2),
            float(np.log(max(one.probability, 1e-300))),
        )
        for one in first.turn_hypotheses
    ]


def _motion(nodes: Sequence[Node], turn_rad: float, covariance: Array, log_probability: float) -> BlockMotion:
    """Compose the motions of nodes, of which the first has another turn and covariance."""
    pose, spread = np.zeros(3), np.zeros((3, 3))
    poses, spreads, steps = [], [], []
    for number, node in enumerate(nodes):
        turn, noise = (turn_rad, covariance) if number == 0 else (node.heading_change_rad, node.covariance)
        heading = pose[2] + turn
        c, s = np.cos(heading), np.sin(heading)
        ahead = node.length_m * np.array([c, s])
        step = np.eye(3)
        step[:2, 2] = -ahead[1], ahead[0]
        turned = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        spread = step @ spread @ step.T + turned @ noise @ turned.T
        pose = np.array([*(pose[:2] + ahead), heading])
        poses.append(pose)
        spreads.append(spread)
        steps.append(step)
    information: Array = np.linalg.inv(spread + np.diag(_LEAST_SIGMA**2)).astype(np.float64)
    gains, later = [], np.eye(3)
    for own, step in zip(reversed(spreads), reversed(steps), strict=True):
        gains.append(own @ later.T @ information)
        later = later @ step
    gains[0] = np.eye(3)  # the last pose is where it is
    log_factor = log_probability + 0.5 * float(np.linalg.slogdet(information)[1])
    return BlockMotion(np.array(poses), np.array(gains[::-1]), information, log_factor)


def poses_between(motion: BlockMotion, begin: Array, end: Array, log_scale: Array) -> Array:
    """Return the poses (k, 3, ...) at the nodes of a block for given ends, as they are expected.

    Parameters
    ----------
    motion
        Motion over the block.
    begin, end
        (3, ...) poses before the block and at its end.
    log_scale
        (...) logarithm of the length scale.
    """
    c, s, scale = np.cos(begin[2]), np.sin(begin[2]), np.exp(log_scale)
    last = motion.poses[-1]
    east, north, turned = end - begin
    off = np.array([c * east + s * north - scale * last[0], c * north - s * east - scale * last[1], turned - last[2]])
    own = np.tensordot(motion.gains, off, axes=(2, 0))
    forward = own[:, 0] + np.multiply.outer(motion.poses[:, 0], scale)
    left = own[:, 1] + np.multiply.outer(motion.poses[:, 1], scale)
    turn = own[:, 2] + motion.poses[:, 2].reshape(-1, *[1] * (own.ndim - 2))
    return np.stack([begin[0] + c * forward - s * left, begin[1] + s * forward + c * left, begin[2] + turn], axis=1)
