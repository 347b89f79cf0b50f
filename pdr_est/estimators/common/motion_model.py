"""The motion model that all estimators share: a pose, the walker's length scale, and the reference of headings.

State (5,): east m, north m, heading rad, length scale (true over modelled step length), and the direction in the map
from which relative heading priors count, rad. One node of the timeline moves it by
x' = x + scale L (cos, sin)(heading + turn), MMPDR eq. 1 in map convention.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, sin, sqrt

import numpy as np

from pdr_est.estimators.common.timeline import Node
from pdr_est.frames import Array

STATES = 5
LENGTH_SCALE = 3  # its place in the state


@dataclass(frozen=True)
class GaussianState:
    """Mean (5,) and covariance (5, 5) of the state."""

    mean: Array
    covariance: Array

    @property
    def length_scale(self) -> tuple[float, float]:
        """The length scale and its standard deviation."""
        variance = float(self.covariance[LENGTH_SCALE, LENGTH_SCALE])
        return float(self.mean[LENGTH_SCALE]), sqrt(max(variance, 0.0))


def move(state: Array, node: Node) -> Array:
    """The state after the motion that leads to `node`."""
    x, y, heading, scale, reference = state
    heading = heading + node.heading_change_rad
    length = scale * node.length_m
    return np.array([x + length * cos(heading), y + length * sin(heading), heading, scale, reference])


def linearise(state: Array, node: Node) -> tuple[Array, Array]:
    """Jacobian F (5, 5) of `move` at `state`, and process noise Q (5, 5) in the map frame."""
    heading = state[2] + node.heading_change_rad
    c, s = cos(heading), sin(heading)
    length = state[3] * node.length_m
    jacobian = np.eye(STATES)
    jacobian[:2, 2] = [-length * s, length * c]
    jacobian[:2, 3] = [node.length_m * c, node.length_m * s]
    to_map = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    noise = np.zeros((STATES, STATES))
    noise[:3, :3] = to_map @ node.covariance @ to_map.T
    return jacobian, noise


def linearise_each(states: Array, nodes: Sequence[Node]) -> tuple[Array, Array, Array]:
    """`move` (n, 5), and `linearise` (n, 5, 5) twice, of states (n, 5) that nodes (n) follow."""
    turn_rad, length_m = np.array([(node.heading_change_rad, node.length_m) for node in nodes]).T
    heading_rad = states[:, 2] + turn_rad
    c, s = np.cos(heading_rad), np.sin(heading_rad)
    scaled_m = states[:, 3] * length_m
    moved = np.column_stack([states[:, 0] + scaled_m * c, states[:, 1] + scaled_m * s, heading_rad, states[:, 3:]])
    jacobian = np.tile(np.eye(STATES), (len(nodes), 1, 1))
    jacobian[:, 0, 2], jacobian[:, 1, 2] = -scaled_m * s, scaled_m * c
    jacobian[:, 0, 3], jacobian[:, 1, 3] = length_m * c, length_m * s
    to_map = np.zeros((len(nodes), 3, 3))
    to_map[:, 0, 0], to_map[:, 0, 1], to_map[:, 1, 0], to_map[:, 1, 1], to_map[:, 2, 2] = c, -s, s, c, 1.0
    noise = np.zeros((len(nodes), STATES, STATES))
    noise[:, :3, :3] = to_map @ np.array([node.covariance for node in nodes]) @ to_map.transpose(0, 2, 1)
    return moved, jacobian, noise


def advance(moments: GaussianState, node: Node) -> GaussianState:
    """Mean and covariance after the motion that leads to `node`."""
    jacobian, noise = linearise(moments.mean, node)
    return GaussianState(move(moments.mean, node), jacobian @ moments.covariance @ jacobian.T + noise)


def retreat(moments: GaussianState, node: Node) -> GaussianState:
    """Mean and covariance before the motion that led to `node`: `advance` in the other direction of time."""
    x, y, heading, scale, reference = moments.mean
    length = scale * node.length_m
    before = heading - node.heading_change_rad
    mean = np.array([x - length * cos(heading), y - length * sin(heading), before, scale, reference])
    jacobian, noise = linearise(mean, node)
    jacobian[:2, 2:4] *= -1.0  # its inverse
    return GaussianState(mean, jacobian @ (moments.covariance + noise) @ jacobian.T)


def reckon(nodes: tuple[Node, ...], anchor: int, moments: GaussianState) -> list[GaussianState]:
    """States at all nodes from the state at one of them and the motion between them."""
    earlier, later = [moments], [moments]
    for node in reversed(nodes[1 : anchor + 1]):
        earlier.append(retreat(earlier[-1], node))
    for node in nodes[anchor + 1 :]:
        later.append(advance(later[-1], node))
    return earlier[:0:-1] + later


def reckoned(nodes: Sequence[Node], first: Array) -> Array:
    """Means (n, 5) of the states at all nodes from that at the first (5,) and the motion between them alone."""
    turn_rad, length_m = np.array([(node.heading_change_rad, node.length_m) for node in nodes]).T
    turn_rad[0], length_m[0] = first[2], 0.0
    heading_rad = np.cumsum(turn_rad)
    steps_m = first[3] * length_m[:, None] * np.stack([np.cos(heading_rad), np.sin(heading_rad)], axis=1)
    return np.column_stack([first[:2] + np.cumsum(steps_m, axis=0), heading_rad, np.tile(first[3:], (len(nodes), 1))])
