"""The motion model that all estimators share: a pose and the walker's length scale.

State (4,): east m, north m, heading rad, length scale (true over modelled step length). One node of the timeline
moves it by x' = x + scale L (cos, sin)(heading + turn), MMPDR eq. 1 in map convention.
"""

from dataclasses import dataclass

import numpy as np

from pdr_est.estimators.timeline import Node
from pdr_est.frames import Array
from pdr_est.records import StartPose


@dataclass(frozen=True)
class Moments:
    """Mean (4,) and covariance (4, 4) of the state."""

    mean: Array
    covariance: Array


def known_start(start: StartPose, sigma_length_scale: float) -> Moments:
    """The state at a start whose unknown parts are taken as zero: the frame is then the walker's own."""
    x, y = start.position_m or (0.0, 0.0)
    sigma_position = start.sigma_position_m if start.position_m else 0.0
    sigma_heading = start.sigma_heading_rad if start.heading_rad is not None else 0.0
    return Moments(
        np.array([x, y, start.heading_rad or 0.0, 1.0]),
        np.diag([sigma_position**2, sigma_position**2, sigma_heading**2, sigma_length_scale**2]),
    )


def move(state: Array, node: Node) -> Array:
    """The state after the motion that leads to `node`."""
    x, y, heading, scale = state
    heading = heading + node.heading_change_rad
    length = scale * node.length_m
    return np.array([x + length * np.cos(heading), y + length * np.sin(heading), heading, scale])


def linearise(state: Array, node: Node) -> tuple[Array, Array]:
    """Jacobian F (4, 4) of `move` at `state`, and process noise Q (4, 4) in the map frame."""
    heading = state[2] + node.heading_change_rad
    c, s = np.cos(heading), np.sin(heading)
    length = state[3] * node.length_m
    jacobian = np.array(
        [
            [1.0, 0.0, -length * s, node.length_m * c],
            [0.0, 1.0, length * c, node.length_m * s],
            [0.0, 0.0, 1.0, 0.0],
            [0.0, 0.0, 0.0, 1.0],
        ]
    )
    to_map = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    noise = np.zeros((4, 4))
    noise[:3, :3] = to_map @ node.covariance @ to_map.T
    return jacobian, noise


def advance(moments: Moments, node: Node) -> Moments:
    """Mean and covariance after the motion that leads to `node`."""
    jacobian, noise = linearise(moments.mean, node)
    return Moments(move(moments.mean, node), jacobian @ moments.covariance @ jacobian.T + noise)


def rewind(moments: Moments, nodes: tuple[Node, ...]) -> list[Moments]:
    """States at all `nodes` from the state at the last of them, by running the motion backwards.

    Process noise is not taken out again, so the covariances are a little too large.
    """
    states = [moments]
    for node in reversed(nodes[1:]):
        mean, covariance = states[-1].mean, states[-1].covariance
        heading, length = mean[2], mean[3] * node.length_m
        earlier = np.array(
            [
                mean[0] - length * np.cos(heading),
                mean[1] - length * np.sin(heading),
                heading - node.heading_change_rad,
                mean[3],
            ]
        )
        backwards = np.linalg.inv(linearise(earlier, node)[0])
        states.append(Moments(earlier, backwards @ covariance @ backwards.T))
    return states[::-1]
