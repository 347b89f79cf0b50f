"""Where and in which direction a walk began, found from fixes and heading priors on the way.

While the start heading is unknown, the pose is far from Gaussian in angle, but exactly linear in the heading vector
(u, v) = scale (cos heading, sin heading): a turn rotates the vector and a step adds L (u, v) to the position. A
uniform heading has the moments (u, v) ~ N(0, I/2), so a linear Kalman filter follows the walk honestly from the
first step, and hands over to the pose once the measurements have settled the direction.

Before, the noise of a step is spread evenly over the directions it may have. Once the direction is known, the same
nodes are followed a second time with the noise where it belongs.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, sin

import numpy as np
from filterpy.kalman import KalmanFilter

from pdr_est.estimators.common.huber import huber_inflation
from pdr_est.estimators.common.initial_state import UNKNOWN_SIGMA_RAD
from pdr_est.estimators.common.motion_model import STATES, GaussianState
from pdr_est.estimators.common.timeline import Node
from pdr_est.frames import Array
from pdr_est.types.measurements import HeadingPrior, PositionFix

ALIGNED_SIGMA_RAD = 0.2  # below this the pose is close enough to Gaussian for an EKF
_UNIFORM_VARIANCE = 0.5  # of each component of a unit vector of uniform direction
_VAGUE_VARIANCE = 50.0  # as before, but so wide that it does not matter
_SIGMA_OF_NORM = 0.5  # what a heading prior says of the norm of (u, v), the length scale: next to nothing
_NOW, _POSITION, _DIRECTION, _FIRST_DIRECTION = slice(0, 4), slice(0, 2), slice(2, 4), slice(4, 6)


@dataclass(frozen=True)
class Alignment:
    """The nodes followed until the direction was known: all of them if it never was.

    pose (k, 3) and covariance (k, 3, 3) for the track; aligned: the state at the last of these nodes, or None.
    """

    pose: Array
    covariance: Array
    aligned: GaussianState | None


def align(nodes: tuple[Node, ...], prior: GaussianState) -> Alignment:
    """Follow the walk with the heading vector until its direction is known.

    prior: of the state at the first node; its heading is ignored. Until the direction is known, the heading is what
    the measurements favour, with the sigma of a uniform direction or less.
    """
    seeking: HeadingSearch | None = None
    poses: list[Array] = []
    covariances: list[Array] = []
    for i, node in enumerate(nodes):
        seeking, aligned = search_heading(seeking, node, nodes[: i + 1], prior)
        if aligned is not None:
            poses.append(aligned.mean[:3])
            covariances.append(aligned.covariance[:3, :3])
            return Alignment(np.array(poses), np.array(covariances), aligned)
        poses.append(seeking.pose)
        covariances.append(seeking.covariance)
    return Alignment(np.array(poses), np.array(covariances), None)


@dataclass(frozen=True)
class HeadingSearch:
    """How far the search for the direction has come: the heading vector's mean (6,) and covariance (6, 6), and what
    they say of the pose, (3,) and (3, 3)."""

    vector: Array
    vector_covariance: Array
    pose: Array
    covariance: Array


def search_heading(
    before: HeadingSearch | None, node: Node, nodes: Sequence[Node], prior: GaussianState
) -> tuple[HeadingSearch, GaussianState | None]:
    """Follow the walk to its next node; with the state there once the direction is known.

    before: None at the first node, where `prior` holds. nodes: all of them up to this one.
    """
    heading_vector = _HeadingVectorFilter(prior, before)
    heading_vector.follow(node, before is None, None)
    found = heading_vector.found()
    if heading_vector.sigma_heading_rad() > ALIGNED_SIGMA_RAD:
        return found, None
    return found, _follow_again(nodes, prior, float(found.pose[2])).state()


def _follow_again(nodes: Sequence[Node], prior: GaussianState, heading_rad: float) -> "_HeadingVectorFilter":
    """The filter at the last of some nodes, when the heading there is known about."""
    turns = np.array([node.heading_change_rad for node in nodes])
    headings = heading_rad - turns.sum() + turns.cumsum()
    heading_vector = _HeadingVectorFilter(prior)
    for i, node in enumerate(nodes):
        heading_vector.follow(node, i == 0, float(headings[i]))
    return heading_vector


class _HeadingVectorFilter:
    """Linear Kalman filter over (east, north, u, v, u at the start, v at the start)."""

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
        """Of the direction now; infinite while the heading vector may as well be zero."""
        vector, covariance = self._filter.x[_DIRECTION], self._filter.P[_DIRECTION, _DIRECTION]
        norm = float(np.hypot(*vector))
        if norm < 1e-6:
            return float("inf")
        across = np.array([-vector[1], vector[0]]) / norm
        return float(np.sqrt(across @ covariance @ across)) / norm

    def follow(self, node: Node, first: bool, heading_rad: float | None) -> None:
        """The motion that leads to `node`, unless it is the first, and what was measured there.

        heading_rad: of the walker on the way to `node`, to about a radian, or None.
        """
        if not first:
            self._advance(node, heading_rad)
        for fix in node.fixes:
            self._update_position(fix)
        for prior in node.priors:
            if not prior.relative:
                self._update_heading(prior)

    def found(self) -> HeadingSearch:
        """With mean (x, y, heading) and covariance (3, 3) for the track."""
        x, y, u, v = self._filter.x[_NOW]
        covariance = np.diag([0.0, 0.0, min(self.sigma_heading_rad(), UNKNOWN_SIGMA_RAD) ** 2])
        covariance[:2, :2] = self._filter.P[_POSITION, _POSITION]
        return HeadingSearch(self._filter.x, self._filter.P, np.array([x, y, np.arctan2(v, u)]), covariance)

    def state(self) -> GaussianState:
        """The state for a heading vector that is known well enough for a first-order conversion."""
        mean, covariance = self._without_uniform_prior()
        return _with_scale_prior(_to_state(mean[_NOW], covariance[_NOW, _NOW], self._prior), self._prior)

    def _advance(self, node: Node, heading_rad: float | None) -> None:
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
        """Make the prior of the heading vector at the start vague: it is centred at zero and shortens the vector.

        This is the Kalman update with the information of the one less that of the other.
        """
        x, covariance = self._filter.x, self._filter.P
        variance = 1.0 / (1.0 / _VAGUE_VARIANCE - 1.0 / _UNIFORM_VARIANCE)
        first = covariance[:, _FIRST_DIRECTION]
        gain = first @ np.linalg.inv(first[_FIRST_DIRECTION] + variance * np.eye(2))
        return x - gain @ x[_FIRST_DIRECTION], covariance - gain @ first.T


def _even_noise(node: Node) -> Array:
    """Of (x, y, u, v), the mean over all directions of the walker."""
    of_length = node.covariance[0, 0] + node.covariance[1, 1]
    turn = node.covariance[2, 2]
    of_turn = -np.expm1(-turn)  # a vector of length one that turns is never off by more than that
    shared = node.covariance[1, 2] * (of_turn / turn if turn > 0.0 else 0.0)
    return np.kron(0.5 * np.array([[of_length, shared], [shared, of_turn]]), np.eye(2)).astype(np.float64)


def _directed_noise(node: Node, heading_rad: float) -> Array:
    """Of (x, y, u, v) for a walker with this heading: a heading error moves the heading vector to its left."""
    c, s = cos(heading_rad), sin(heading_rad)
    to_map = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, -s], [0.0, 0.0, c]])
    return np.asarray(to_map @ node.covariance @ to_map.T)


def _to_state(vector_state: Array, covariance: Array, prior: GaussianState) -> GaussianState:
    """The state from (x, y, u, v), to first order; nothing was learnt of the reference direction."""
    x, y, u, v = vector_state
    norm = np.hypot(u, v)
    jacobian = np.eye(STATES, 4)
    jacobian[2, 2:] = [-v / norm**2, u / norm**2]
    jacobian[3, 2:] = [u / norm, v / norm]
    state = jacobian @ covariance @ jacobian.T
    state[4, 4] = prior.covariance[4, 4]
    return GaussianState(np.array([x, y, np.arctan2(v, u), norm, prior.mean[4]]), state)


def _with_scale_prior(moments: GaussianState, prior: GaussianState) -> GaussianState:
    """What is known of the length scale beside these measurements: one Kalman update of the last state."""
    gain = moments.covariance[:, 3] / (moments.covariance[3, 3] + prior.covariance[3, 3])
    mean = moments.mean + gain * (prior.mean[3] - moments.mean[3])
    return GaussianState(mean, moments.covariance - np.outer(gain, moments.covariance[3]))
