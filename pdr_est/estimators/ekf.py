"""Extended Kalman filter over pose and length scale (filterpy), and its Rauch-Tung-Striebel smoother."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from filterpy.kalman import ExtendedKalmanFilter

from pdr_est.estimators.alignment import HeadingAlignment
from pdr_est.estimators.motion import Moments, known_start, linearise, move, rewind
from pdr_est.estimators.timeline import Node, Timeline, track_from_nodes
from pdr_est.frames import Array, wrap_angle
from pdr_est.records import HeadingPrior, PositionFix, StartPose
from pdr_est.track import Track

NAME = "ekf"
_HUBER = 1.345  # standard deviations; 95 % efficient for Gaussian errors
_POSITION = np.eye(2, 4)
_HEADING = np.array([[0.0, 0.0, 1.0, 0.0]])


@dataclass(frozen=True)
class Filtered:
    """States of the filter. aligned_from: first node with a known direction (0 if the start pose is known, None if
    it never became known); pose (n, 3) and covariance (n, 3, 3) for the track; moments of the nodes from
    `aligned_from` on."""

    aligned_from: int | None
    pose: Array
    covariance: Array
    moments: tuple[Moments, ...]


def estimate(timeline: Timeline, start: StartPose, sigma_length_scale: float) -> Track:
    """Filtered track: each pose from the measurements up to its time."""
    filtered = run_filter(timeline, start, sigma_length_scale)
    scale = (1.0, sigma_length_scale)
    if filtered.moments:
        last = filtered.moments[-1]
        scale = (float(last.mean[3]), float(np.sqrt(last.covariance[3, 3])))
    return track_from_nodes(
        timeline, filtered.pose[:, :2], filtered.pose[:, 2], filtered.covariance, "filtered", NAME, scale
    )


def run_filter(timeline: Timeline, start: StartPose, sigma_length_scale: float) -> Filtered:
    """Filter all nodes: with the heading vector until the direction is known, with the pose from then on."""
    nodes = timeline.nodes
    poses: list[Array] = []
    covariances: list[Array] = []
    aligned_from, moments = 0, known_start(start, sigma_length_scale)
    if _needs_alignment(timeline, start):
        aligned_from, first = _align(timeline, start, sigma_length_scale, poses, covariances)
        if first is None:
            return Filtered(None, np.array(poses), np.array(covariances), ())
        moments = first
    states = _filter_poses(nodes[aligned_from:], moments, update_first=not poses)
    for state in states[1 if poses else 0 :]:
        poses.append(state.mean[:3])
        covariances.append(state.covariance[:3, :3])
    return Filtered(aligned_from, np.array(poses), np.array(covariances), tuple(states))


def find_start(timeline: Timeline, start: StartPose, sigma_length_scale: float) -> Moments:
    """The state at the start: as given, or found from the first fixes that settle the direction.

    Fixes that never settle it leave the heading at what they favour, with the sigma of a uniform direction.
    """
    given = known_start(start, sigma_length_scale)
    if not _needs_alignment(timeline, start):
        return given
    poses: list[Array] = []
    covariances: list[Array] = []
    node, aligned = _align(timeline, start, sigma_length_scale, poses, covariances)
    if aligned is None:
        covariance = given.covariance.copy()
        covariance[:3, :3] = covariances[-1]
        node, aligned = node - 1, Moments(np.array([*poses[-1], 1.0]), covariance)
    return rewind(aligned, timeline.nodes[: node + 1])[0]


def smooth(nodes: tuple[Node, ...], filtered: tuple[Moments, ...]) -> list[Moments]:
    """Rauch-Tung-Striebel smoother over filtered states; nodes[k] leads to filtered[k]."""
    smoothed = [filtered[-1]]
    for k in range(len(filtered) - 2, -1, -1):
        jacobian, noise = linearise(filtered[k].mean, nodes[k + 1])
        predicted = jacobian @ filtered[k].covariance @ jacobian.T + noise
        gain = np.linalg.solve(predicted + 1e-12 * np.eye(4), jacobian @ filtered[k].covariance).T
        innovation = smoothed[-1].mean - move(filtered[k].mean, nodes[k + 1])
        covariance = filtered[k].covariance + gain @ (smoothed[-1].covariance - predicted) @ gain.T
        smoothed.append(Moments(filtered[k].mean + gain @ innovation, 0.5 * (covariance + covariance.T)))
    return smoothed[::-1]


def _needs_alignment(timeline: Timeline, start: StartPose) -> bool:
    return bool(timeline.fixes) and (start.heading_rad is None or start.position_m is None)


def _align(
    timeline: Timeline, start: StartPose, sigma_length_scale: float, poses: list[Array], covariances: list[Array]
) -> tuple[int, Moments | None]:
    """Follow the nodes until the direction is known; collect the poses on the way."""
    alignment = HeadingAlignment(start, timeline.fixes[0])
    for i, node in enumerate(timeline.nodes):
        if i:
            alignment.advance(node)
        for fix in node.fixes:
            alignment.update(fix)
        aligned = alignment.aligned(sigma_length_scale)
        if aligned is not None:
            poses.append(aligned.mean[:3])
            covariances.append(aligned.covariance[:3, :3])
            return i, aligned
        pose, covariance = alignment.pose()
        poses.append(pose)
        covariances.append(covariance)
    return len(timeline.nodes), None


def _filter_poses(nodes: tuple[Node, ...], first: Moments, update_first: bool) -> list[Moments]:
    """EKF over the nodes; `first` is the state at nodes[0], before its measurements if update_first."""
    ekf = _PoseFilter(first)
    states = []
    for i, node in enumerate(nodes):
        if i:
            ekf.advance(node)
        if i or update_first:
            for fix in node.fixes:
                ekf.update_position(fix)
            for prior in node.priors:
                ekf.update_heading(prior)
        states.append(ekf.moments)
    return states


class _PoseFilter(ExtendedKalmanFilter):  # type: ignore[misc]
    """filterpy's EKF with the motion model of `motion.py`; x is one-dimensional throughout."""

    def __init__(self, first: Moments) -> None:
        super().__init__(dim_x=4, dim_z=2)
        self.x = first.mean.copy()
        self.P = first.covariance.copy()

    @property
    def moments(self) -> Moments:
        return Moments(self.x.copy(), 0.5 * (self.P + self.P.T))

    def advance(self, node: Node) -> None:
        self.F, self.Q = linearise(self.x, node)
        self.predict(node)

    def predict_x(self, u: Node) -> None:
        self.x = move(self.x, u)

    def update_position(self, fix: PositionFix) -> None:
        residual = np.asarray(fix.position_m) - self.x[:2]
        noise = fix.covariance_m2
        if fix.robust:
            noise = noise * _inflation(residual, self.P[:2, :2] + noise)
        self._correct(np.asarray(fix.position_m, dtype=np.float64), _POSITION, noise, np.subtract)

    def update_heading(self, prior: HeadingPrior) -> None:
        noise = np.array([[prior.sigma_rad**2]])
        if prior.robust:
            residual = wrap_angle(np.array([prior.heading_rad - self.x[2]]))
            noise = noise * _inflation(residual, self.P[2:3, 2:3] + noise)
        self._correct(np.array([prior.heading_rad]), _HEADING, noise, lambda a, b: wrap_angle(np.subtract(a, b)))

    def _correct(self, z: Array, jacobian: Array, noise: Array, residual: Callable[[Array, Array], Array]) -> None:
        self.update(z, lambda _: jacobian, lambda x: jacobian @ x, R=noise, residual=residual)


def _inflation(residual: Array, covariance: Array) -> float:
    """Huber's weight as an inflation of the noise: far innovations count less, none is thrown away."""
    distance = float(np.sqrt(residual @ np.linalg.solve(covariance, residual)))
    return max(1.0, distance / _HUBER)
