"""Extended Kalman filter over pose and length scale (filterpy), and its Rauch-Tung-Striebel smoother."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from filterpy.kalman import ExtendedKalmanFilter

from pdr_est.estimators.alignment import align
from pdr_est.estimators.motion import Moments, linearise, move
from pdr_est.estimators.robust import huber_inflation
from pdr_est.estimators.start import start_prior
from pdr_est.estimators.timeline import Node, Timeline, track_from_nodes
from pdr_est.frames import Array, wrap_angle
from pdr_est.records import HeadingPrior, PositionFix, StartPose
from pdr_est.track import Track

NAME = "ekf"
_REGULAR = 1e-12  # variance, far below anything that matters: parts of a state may be known exactly
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
    prior = start_prior(timeline, start)
    if not prior.heading_open:
        states = _filter_poses(timeline.nodes, prior.moments(sigma_length_scale), update_first=True)
        return Filtered(0, *_track_columns(states), tuple(states))
    alignment = align(timeline, prior, sigma_length_scale)
    if alignment.aligned is None:
        return Filtered(None, alignment.pose, alignment.covariance, ())
    aligned_from = len(alignment.pose) - 1
    states = _filter_poses(timeline.nodes[aligned_from:], alignment.aligned, update_first=False)
    pose, covariance = _track_columns(states)
    return Filtered(
        aligned_from,
        np.concatenate([alignment.pose, pose[1:]]),
        np.concatenate([alignment.covariance, covariance[1:]]),
        tuple(states),
    )


def undecided_anchor(timeline: Timeline, filtered: Filtered, sigma_length_scale: float) -> tuple[int, Moments]:
    """The last node with a measurement, if all of them together did not settle the direction."""
    anchor = max(i for i, node in enumerate(timeline.nodes) if node.fixes or node.priors)
    covariance = np.diag([0.0, 0.0, 0.0, sigma_length_scale**2])
    covariance[:3, :3] = filtered.covariance[anchor]
    return anchor, Moments(np.array([*filtered.pose[anchor], 1.0]), covariance)


def smooth(nodes: tuple[Node, ...], filtered: tuple[Moments, ...]) -> list[Moments]:
    """Rauch-Tung-Striebel smoother over filtered states; nodes[k] leads to filtered[k]."""
    if len(filtered) == 1:
        return list(filtered)
    mean = np.array([state.mean for state in filtered])
    covariance = np.array([state.covariance for state in filtered])
    linear = [linearise(state.mean, node) for state, node in zip(filtered[:-1], nodes[1:], strict=True)]
    jacobian, noise = np.array([f for f, _ in linear]), np.array([q for _, q in linear])
    moved = np.array([move(state.mean, node) for state, node in zip(filtered[:-1], nodes[1:], strict=True)])
    predicted = jacobian @ covariance[:-1] @ jacobian.transpose(0, 2, 1) + noise
    gain = np.linalg.solve(predicted + _REGULAR * np.eye(4), jacobian @ covariance[:-1]).transpose(0, 2, 1)
    for k in range(len(gain) - 1, -1, -1):
        mean[k] += gain[k] @ (mean[k + 1] - moved[k])
        covariance[k] += gain[k] @ (covariance[k + 1] - predicted[k]) @ gain[k].T
    covariance = 0.5 * (covariance + covariance.transpose(0, 2, 1))
    return [Moments(*moments) for moments in zip(mean, covariance, strict=True)]


def _track_columns(states: list[Moments]) -> tuple[Array, Array]:
    """Poses (n, 3) and their covariances (n, 3, 3)."""
    return np.array([state.mean[:3] for state in states]), np.array([state.covariance[:3, :3] for state in states])


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
            noise = noise * huber_inflation(residual, self.P[:2, :2] + noise)
        self._correct(np.asarray(fix.position_m, dtype=np.float64), _POSITION, noise, np.subtract)

    def update_heading(self, prior: HeadingPrior) -> None:
        noise = np.array([[prior.sigma_rad**2]])
        if prior.robust:
            residual = wrap_angle(np.array([prior.heading_rad - self.x[2]]))
            noise = noise * huber_inflation(residual, self.P[2:3, 2:3] + noise)
        self._correct(np.array([prior.heading_rad]), _HEADING, noise, lambda a, b: wrap_angle(np.subtract(a, b)))

    def _correct(self, z: Array, jacobian: Array, noise: Array, residual: Callable[[Array, Array], Array]) -> None:
        self.update(z, lambda _: jacobian, lambda x: jacobian @ x, R=noise, residual=residual)
