"""Motion model of all estimators: a pose, the walker's length scale, and the reference direction of headings.

The state (5,) of a device holds east m, north m, heading rad, the logarithm of the length scale (true over modelled
step length, which is thus positive), and the direction in the map from which relative heading priors count, rad. The
motion to a node changes it by x' = x + scale L (cos, sin)(heading + turn), MMPDR eq. 1 in the convention of the map
frame.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, exp, sin, sqrt

import numpy as np

from pdr_est.estimators.common.timeline import Node
from pdr_est.frames import Array

STATES = 5
"""Number of states of a device."""

LOG_SCALE = 3
"""Index of the logarithm of the length scale in the state of a device."""

JITTER_VARIANCE = 1e-12
"""Variance far below all that matters; it keeps matrices regular where parts of a state are known exactly."""


@dataclass(frozen=True)
class GaussianState:
    """Gaussian distribution of the state of one device, or of d devices side by side.

    Attributes
    ----------
    mean
        Mean, (5,) or (5 d,).
    covariance
        Covariance, (5, 5) or (5 d, 5 d).
    """

    mean: Array
    covariance: Array

    @property
    def length_scale(self) -> tuple[float, float]:
        """Return the length scale of the first device and its standard deviation, to first order."""
        variance = float(self.covariance[LOG_SCALE, LOG_SCALE])
        scale = exp(float(self.mean[LOG_SCALE]))
        return scale, scale * sqrt(max(variance, 0.0))


def move(state: Array, node: Node) -> Array:
    """Return the state (5,) after the motion that leads to a node."""
    x, y, heading, log_scale, reference = state
    heading = heading + node.heading_change_rad
    length = exp(log_scale) * node.length_m
    return np.array([x + length * cos(heading), y + length * sin(heading), heading, log_scale, reference])


def linearise(state: Array, node: Node) -> tuple[Array, Array]:
    """Linearise the motion that leads to a node.

    Parameters
    ----------
    state
        State (5,) before the motion.
    node
        Node that the motion leads to.

    Returns
    -------
    Array
        Jacobian F (5, 5) of `move`.
    Array
        Process noise covariance Q (5, 5) in the map frame.
    """
    heading = state[2] + node.heading_change_rad
    c, s = cos(heading), sin(heading)
    length = exp(state[LOG_SCALE]) * node.length_m
    jacobian = np.eye(STATES)
    jacobian[:2, 2] = [-length * s, length * c]
    jacobian[:2, LOG_SCALE] = [length * c, length * s]
    to_map = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    noise = np.zeros((STATES, STATES))
    noise[:3, :3] = to_map @ node.covariance @ to_map.T
    return jacobian, noise


def linearise_each(states: Array, nodes: Sequence[Node]) -> tuple[Array, Array, Array]:
    """Apply `move` and `linearise` to many states at once.

    Parameters
    ----------
    states
        States (n, 5) before the motions.
    nodes
        Nodes (n) that the motions lead to.

    Returns
    -------
    Array
        States (n, 5) after the motions.
    Array
        Jacobians (n, 5, 5).
    Array
        Process noise covariances (n, 5, 5) in the map frame.
    """
    turn_rad, length_m = np.array([(node.heading_change_rad, node.length_m) for node in nodes]).T
    heading_rad = states[:, 2] + turn_rad
    c, s = np.cos(heading_rad), np.sin(heading_rad)
    scaled_m = np.exp(states[:, LOG_SCALE]) * length_m
    moved = np.column_stack([states[:, 0] + scaled_m * c, states[:, 1] + scaled_m * s, heading_rad, states[:, 3:]])
    jacobian = np.tile(np.eye(STATES), (len(nodes), 1, 1))
    jacobian[:, 0, 2], jacobian[:, 1, 2] = -scaled_m * s, scaled_m * c
    jacobian[:, 0, LOG_SCALE], jacobian[:, 1, LOG_SCALE] = scaled_m * c, scaled_m * s
    to_map = np.zeros((len(nodes), 3, 3))
    to_map[:, 0, 0], to_map[:, 0, 1], to_map[:, 1, 0], to_map[:, 1, 1], to_map[:, 2, 2] = c, -s, s, c, 1.0
    noise = np.zeros((len(nodes), STATES, STATES))
    noise[:, :3, :3] = to_map @ np.array([node.covariance for node in nodes]) @ to_map.transpose(0, 2, 1)
    return moved, jacobian, noise


def advance(state: GaussianState, node: Node) -> GaussianState:
    """Predict the state after the motion that leads to a node."""
    jacobian, noise = linearise(state.mean, node)
    return GaussianState(move(state.mean, node), jacobian @ state.covariance @ jacobian.T + noise)


def retreat(state: GaussianState, node: Node) -> GaussianState:
    """Predict the state before the motion that led to a node: `advance` backwards in time."""
    x, y, heading, log_scale, reference = state.mean
    length = exp(log_scale) * node.length_m
    before = heading - node.heading_change_rad
    mean = np.array([x - length * cos(heading), y - length * sin(heading), before, log_scale, reference])
    jacobian, noise = linearise(mean, node)
    jacobian[:2, 2:4] *= -1.0  # its inverse
    return GaussianState(mean, jacobian @ (state.covariance + noise) @ jacobian.T)


def reckon(nodes: tuple[Node, ...], anchor: int, state: GaussianState) -> list[GaussianState]:
    """Compute the states at all nodes by dead reckoning from the state at one of them.

    Parameters
    ----------
    nodes
        Nodes in order of time.
    anchor
        Index of the node whose state is given.
    state
        State at that node.
    """
    earlier, later = [state], [state]
    for node in reversed(nodes[1 : anchor + 1]):
        earlier.append(retreat(earlier[-1], node))
    for node in nodes[anchor + 1 :]:
        later.append(advance(later[-1], node))
    return earlier[:0:-1] + later


def reckon_means(nodes: Sequence[Node], first: Array) -> Array:
    """Compute the means (n, 5) at all nodes by dead reckoning from the mean (5,) at the first node."""
    turn_rad, length_m = np.array([(node.heading_change_rad, node.length_m) for node in nodes]).T
    turn_rad[0], length_m[0] = first[2], 0.0
    heading_rad = np.cumsum(turn_rad)
    steps_m = exp(first[LOG_SCALE]) * length_m[:, None] * np.stack([np.cos(heading_rad), np.sin(heading_rad)], axis=1)
    return np.column_stack([first[:2] + np.cumsum(steps_m, axis=0), heading_rad, np.tile(first[3:], (len(nodes), 1))])
