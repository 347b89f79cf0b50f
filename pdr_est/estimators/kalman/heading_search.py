"""Search for the heading of a walk that begins with an unknown one, from fixes and heading priors on the way.

While the heading is unknown, the pose is far from Gaussian in angle, but exactly linear in the heading vector
(u, v) = scale (cos heading, sin heading): a turn rotates the vector, and a step adds L (u, v) to the position. A
uniformly distributed heading has mean and covariance (u, v) ~ N(0, I/2). A linear Kalman filter can therefore follow
the walk with a consistent covariance from the first step, and hands over to the EKF of the pose once the measurements
have determined the heading.

Until then the noise of a step is averaged over all headings. Once the heading is known, the same nodes are filtered a
second time with the noise in the right directions.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, sin

import numpy as np
from filterpy.kalman import KalmanFilter

from pdr_est.estimators.common.huber import huber_inflation
from pdr_est.estimators.common.initial_state import UNKNOWN_SIGMA_RAD
from pdr_est.estimators.common.motion_model import LOG_SCALE, STATES, GaussianState
from pdr_est.estimators.common.nodes import Node
from pdr_est.frames import Array
from pdr_est.types.measurements import HeadingPrior, PositionFix

ALIGNED_SIGMA_RAD = 0.2
"""Standard deviation of the heading, rad, below which the pose is close enough to Gaussian for an EKF."""

_UNIFORM_VARIANCE = 0.5  # of each component of a unit vector with a uniformly distributed direction
_VAGUE_VARIANCE = 50.0  # the same, but so large that it does not matter
_SIGMA_OF_NORM = 0.5  # a heading prior tells next to nothing about the norm of (u, v), which is the length scale
_NOW, _POSITION, _DIRECTION, _FIRST_DIRECTION = slice(0, 4), slice(0, 2), slice(2, 4), slice(4, 6)


@dataclass(frozen=True)
class HeadingSearch:
    """State of the heading search after a node.

    Attributes
    ----------
    vector
        Mean (6,) of (east m, north m, u, v, u at the start, v at the start).
    vector_covariance
        Its covariance (6, 6).
    pose
        Pose (3,) that follows from it, east m, north m, heading rad.
    covariance
        Its covariance (3, 3).
    """

    vector: Array
    vector_covariance: Array
    pose: Array
    covariance: Array


def search_heading(
    before: HeadingSearch | None, node: Node, nodes: Sequence[Node], prior: GaussianState
) -> tuple[HeadingSearch, GaussianState | None]:
    """Continue the heading search to the next node.

    Parameters
    ----------
    before
        State of the search at the node before; None at the first node.
    node
        Node to continue to.
    nodes
        All nodes from the first one up to this one.
    prior
        Prior of the state at the first node; its heading is ignored.

    Returns
    -------
    HeadingSearch
        State of the search after the node. Until the heading is known, its pose has the heading that the measurements
        favour, with at most the standard deviation of a uniform distribution.
    GaussianState or None
        State of the device once the heading is known.
    """
    heading_vector = _HeadingVectorFilter(prior, before)
    heading_vector.filter_node(node, before is None, None)
    found = heading_vector.search()
    if heading_vector.sigma_heading_rad() > ALIGNED_SIGMA_RAD:
        return found, None
    return found, _filter_again(nodes, prior, float(found.pose[2])).state()


def _filter_again(nodes: Sequence[Node], prior: GaussianState, heading_rad: float) -> "_HeadingVectorFilter":
    """Filter all nodes a second time with an approximately known heading at the last one."""
    turns = np.array([node.heading_change_rad for node in nodes])
    headings = heading_rad - turns.sum() + turns.cumsum()
    heading_vector = _HeadingVectorFilter(prior)
    for i, node in enumerate(nodes):
        heading_vector.filter_node(node, i == 0, float(headings[i]))
    return heading_vector


class _HeadingVectorFilter:
    """Linear Kalman filter of (east, north, u, v, u at the start, v at the start)."""

    def __init__(self, prior: GaussianState, before: HeadingSearch | None = None) -> None:
        self._prior = prior
        self._filter = KalmanFilter(dim_x=6, dim_z=2)
        if before is not None:
            self._filter.x, self._filter.P = before.vector, before.vector_covariance
            return
        self._filter.x = np.array([*prior.mean[:2], 0.0, 0.0, 0.0, 0.0])
        self._filter.P = _UNIFORM_VARIANCE * np.eye(6)
        self._filter.P[_POSITION, _POSITION] = prior.covariance[:2, :2]
        self._filter.P[_DIRECTION, _FIRST_DIRECTION] = _UNIFORM_VARIANCE * np.eye(2)
        self._filter.P[_FIRST_DIRECTION, _DIRECTION] = _UNIFORM_VARIANCE * np.eye(2)

    def sigma_heading_rad(self) -> float:
        """Return the standard deviation of the heading; infinity while the heading vector is zero."""
        vector, covariance = self._filter.x[_DIRECTION], self._filter.P[_DIRECTION, _DIRECTION]
        norm = float(np.hypot(*vector))
        if norm < 1e-6:
            return float("inf")
        across = np.array([-vector[1], vector[0]]) / norm
        return float(np.sqrt(across @ covariance @ across)) / norm

    def filter_node(self, node: Node, first: bool, heading_rad: float | None) -> None:
        """Predict the motion to a node, unless it is the first, and update with the measurements there.

        The heading on the way to the node is needed to about a radian, or None.
        """
        if not first:
            self._predict(node, heading_rad)
        for fix in node.fixes:
            self._update_position(fix)
        for prior in node.priors:
            if not prior.relative:
                self._update_heading(prior)

    def search(self) -> HeadingSearch:
        """Return the state of the search, with the pose and its covariance for the track."""
        x, y, u, v = self._filter.x[_NOW]
        covariance = np.diag([0.0, 0.0, min(self.sigma_heading_rad(), UNKNOWN_SIGMA_RAD) ** 2])
        covariance[:2, :2] = self._filter.P[_POSITION, _POSITION]
        return HeadingSearch(self._filter.x, self._filter.P, np.array([x, y, np.arctan2(v, u)]), covariance)

    def state(self) -> GaussianState:
        """Convert to the state of a device, to first order: the heading vector must be known well enough."""
        mean, covariance = self._without_uniform_prior()
        return _with_scale_prior(_to_state(mean[_NOW], covariance[_NOW, _NOW], self._prior), self._prior)

    def _predict(self, node: Node, heading_rad: float | None) -> None:
        c, s = cos(node.heading_change_rad), sin(node.heading_change_rad)
        turn = np.array([[c, -s], [s, c]])
        transition, noise = np.eye(6), np.zeros((6, 6))
        transition[_POSITION, _DIRECTION] = node.length_m * turn
        transition[_DIRECTION, _DIRECTION] = turn
        noise[_NOW, _NOW] = _even_noise(node) if heading_rad is None else _directed_noise(node, heading_rad)
        self._filter.predict(F=transition, Q=noise)

    def _update_position(self, fix: PositionFix) -> None:
        self._update(np.asarray(fix.position_m, dtype=np.float64), fix.covariance_m2, _POSITION, fix.robust)

    def _update_heading(self, prior: HeadingPrior) -> None:
        c, s = cos(prior.heading_rad), sin(prior.heading_rad)
        to_map = np.array([[c, -s], [s, c]])
        noise = to_map @ np.diag([_SIGMA_OF_NORM**2, prior.sigma_rad**2]) @ to_map.T
        self._update(np.array([c, s]), noise, _DIRECTION, prior.robust)

    def _update(self, z: Array, noise: Array, part: slice, robust: bool) -> None:
        if robust:
            noise = noise * huber_inflation(z - self._filter.x[part], self._filter.P[part, part] + noise)
        self._filter.update(z, R=noise, H=np.eye(6)[part])

    def _without_uniform_prior(self) -> tuple[Array, Array]:
        """Replace the prior of the heading vector at the start by a vague one.

        The uniform prior is centred at zero and shortens the vector. This is the Kalman update with the information
        of the vague prior less that of the uniform one.
        """
        x, covariance = self._filter.x, self._filter.P
        variance = 1.0 / (1.0 / _VAGUE_VARIANCE - 1.0 / _UNIFORM_VARIANCE)
        first = covariance[:, _FIRST_DIRECTION]
        gain = first @ np.linalg.inv(first[_FIRST_DIRECTION] + variance * np.eye(2))
        return x - gain @ x[_FIRST_DIRECTION], covariance - gain @ first.T


def _even_noise(node: Node) -> Array:
    """Return the process noise (4, 4) of (x, y, u, v), averaged over all headings of the walker."""
    of_length = node.covariance[0, 0] + node.covariance[1, 1]
    turn = node.covariance[2, 2]
    of_turn = -np.expm1(-turn)  # the error of a unit vector that turns is bounded
    shared = node.covariance[1, 2] * (of_turn / turn if turn > 0.0 else 0.0)
    return np.kron(0.5 * np.array([[of_length, shared], [shared, of_turn]]), np.eye(2)).astype(np.float64)


def _directed_noise(node: Node, heading_rad: float) -> Array:
    """Return the process noise (4, 4) of (x, y, u, v) at a heading, whose error moves (u, v) to the left."""
    c, s = cos(heading_rad), sin(heading_rad)
    to_map = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, -s], [0.0, 0.0, c]])
    return np.asarray(to_map @ node.covariance @ to_map.T)


def _to_state(vector_state: Array, covariance: Array, prior: GaussianState) -> GaussianState:
    """Convert (x, y, u, v) to a state, to first order; the reference direction keeps its prior."""
    x, y, u, v = vector_state
    norm = np.hypot(u, v)
    jacobian = np.eye(STATES, 4)
    jacobian[2, 2:] = [-v / norm**2, u / norm**2]
    jacobian[LOG_SCALE, 2:] = [u / norm**2, v / norm**2]
    state = jacobian @ covariance @ jacobian.T
    state[4, 4] = prior.covariance[4, 4]
    return GaussianState(np.array([x, y, np.arctan2(v, u), np.log(norm), prior.mean[4]]), state)


def _with_scale_prior(state: GaussianState, prior: GaussianState) -> GaussianState:
    """Update a state with the prior of the length scale."""
    gain = state.covariance[:, LOG_SCALE] / (
        state.covariance[LOG_SCALE, LOG_SCALE] + prior.covariance[LOG_SCALE, LOG_SCALE]
    )
    mean = state.mean + gain * (prior.mean[LOG_SCALE] - state.mean[LOG_SCALE])
    return GaussianState(mean, state.covariance - np.outer(gain, state.covariance[LOG_SCALE]))
