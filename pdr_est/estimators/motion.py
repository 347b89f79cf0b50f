"""The motion model that all estimators share: a pose, the walker's length scale, and the reference of headings.

State (5,): east m, north m, heading rad, length scale (true over modelled step length), and the direction in the map
from which relative heading priors count, rad. One node of the timeline moves it by
x' = x + scale L (cos, sin)(heading + turn), MMPDR eq. 1 in map convention.
"""

from dataclasses import dataclass
from math import cos, sin

import numpy as np

from pdr_est.estimators.timeline import Node
from pdr_est.frames import Array

STATES = 5


@dataclass(frozen=True)
class Moments:
    """Mean (5,) and covariance (5, 5) of the state."""

    mean: Array
    covariance: Array


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


def advance(moments: Moments, node: Node) -> Moments:
    """Mean and covariance after the motion that leads to `node`."""
    jacobian, noise = linearise(moments.mean, node)
    return Moments(move(moments.mean, node), jacobian @ moments.covariance @ jacobian.T + noise)


def retreat(moments: Moments, node: Node) -> Moments:
    """Mean and covariance before the motion that led to `node`: `advance` in the other direction of time."""
    x, y, heading, scale, reference = moments.mean
    length = scale * node.length_m
    before = heading - node.heading_change_rad
    mean = np.array([x - length * cos(heading), y - length * sin(heading), before, scale, reference])
    jacobian, noise = linearise(mean, node)
    jacobian[:2, 2:4] *= -1.0  # its inverse
    return Moments(mean, jacobian @ (moments.covariance + noise) @ jacobian.T)


def reckon(nodes: tuple[Node, ...], anchor: int, moments: Moments) -> list[Moments]:
    """States at all nodes from the state at one of them and the motion between them."""
    earlier, later = [moments], [moments]
    for node in reversed(nodes[1 : anchor + 1]):
        earlier.append(retreat(earlier[-1], node))
    for node in nodes[anchor + 1 :]:
        later.append(advance(later[-1], node))
    return earlier[:0:-1] + later
