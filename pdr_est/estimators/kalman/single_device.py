"""Extended Kalman filter over pose and length scale, and its Rauch-Tung-Striebel smoother."""

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from pdr_est.estimators.common.initial_state import StartPrior, prior_after_lost_turn, start_prior
from pdr_est.estimators.common.motion_model import GaussianState
from pdr_est.estimators.common.timeline import Node, Timeline, track_from_nodes
from pdr_est.estimators.kalman.heading_search import align
from pdr_est.estimators.kalman.multi_device_ekf import PoseFilter
from pdr_est.frames import Array
from pdr_est.types.measurements import PositionFix, StartPose
from pdr_est.types.track import Track

NAME = "ekf"
JITTER_VARIANCE = 1e-12  # variance, far below anything that matters: parts of a state may be known exactly
HEADING_RESET_VARIANCE_RAD2 = 0.25  # rad^2; with a turn this uncertain a heading is too far from Gaussian for an EKF


@dataclass(frozen=True)
class FilteredSegment:
    """Consecutive nodes with what the filter knows of them; between two stretches the direction was lost.

    aligned_from: first node with a known direction, None if it never became known; pose (n, 3) and covariance
    (n, 3, 3) for the track; moments of the nodes from `aligned_from` on; end: the state at the last node.
    """

    nodes: tuple[Node, ...]
    aligned_from: int | None
    pose: Array
    covariance: Array
    moments: tuple[GaussianState, ...]
    end: GaussianState


def estimate(timeline: Timeline, start: StartPose, sigma_length_scale: float) -> Track:
    """Filtered track: each pose from the measurements up to its time."""
    stretches = run_filter(timeline, start, sigma_length_scale)
    pose = np.concatenate([stretch.pose for stretch in stretches])
    covariance = np.concatenate([stretch.covariance for stretch in stretches])
    scale = stretches[-1].end.length_scale
    return track_from_nodes(timeline, pose[:, :2], pose[:, 2], covariance, "filtered", NAME, scale)


def run_filter(timeline: Timeline, start: StartPose, sigma_length_scale: float) -> list[FilteredSegment]:
    """Filter all nodes: with the heading vector until the direction is known, with the pose from then on.

    A turn that leaves nothing of the direction begins a new stretch, if there are measurements to find it again.
    """
    prior = start_prior(timeline, start, sigma_length_scale)
    stretches: list[FilteredSegment] = []
    for nodes in _between_lost_turns(_closed(timeline, prior)):
        if stretches:
            prior = prior_after_lost_turn(stretches[-1].end, nodes[0])
        stretches.append(_filter_stretch(nodes, prior))
    return stretches


def undecided_anchor(stretch: FilteredSegment) -> tuple[int, GaussianState]:
    """The last node with a measurement and its state, if all of them together did not settle the direction."""
    anchor = max((i for i, node in enumerate(stretch.nodes) if node.tells_direction), default=0)
    return anchor, undecided(stretch.pose[anchor], stretch.covariance[anchor], stretch.end)


def _closed(timeline: Timeline, prior: StartPrior) -> tuple[Node, ...]:
    """The nodes; the last one of a closed walk gets a fix at the start, if the start is known from the beginning: at
    the end the filter has long forgotten what it learnt of its start on the way."""
    *before, last = timeline.nodes
    if timeline.closure_sigma_m is None or prior.position_open or prior.heading_open:
        return timeline.nodes
    home = home_fix(prior.moments, last.time_s, timeline.closure_sigma_m)
    return (*before, replace(last, fixes=(*last.fixes, home)))


def home_fix(start: GaussianState, time_s: float, sigma_m: float) -> PositionFix:
    """The start of a walk as a fix at its end. sigma_m: how near they are."""
    covariance = start.covariance[:2, :2] + max(sigma_m, JITTER_VARIANCE) ** 2 * np.eye(2)
    return PositionFix(time_s, start.mean[:2], covariance, source="start")


def _between_lost_turns(nodes: tuple[Node, ...]) -> list[tuple[Node, ...]]:
    last = max((i for i, node in enumerate(nodes) if node.tells_direction), default=0)
    lost = [i for i in range(1, last + 1) if nodes[i].covariance[2, 2] > HEADING_RESET_VARIANCE_RAD2]
    return [nodes[i:j] for i, j in pairwise([0, *lost, len(nodes)])]


def _filter_stretch(nodes: tuple[Node, ...], prior: StartPrior) -> FilteredSegment:
    if not prior.heading_open:
        states = _filter_poses(nodes, prior.moments, update_first=True)
        return FilteredSegment(nodes, 0, *_track_columns(states), tuple(states), states[-1])
    alignment = align(nodes, prior.moments)
    if alignment.aligned is None:
        end = undecided(alignment.pose[-1], alignment.covariance[-1], prior.moments)
        return FilteredSegment(nodes, None, alignment.pose, alignment.covariance, (), end)
    aligned_from = len(alignment.pose) - 1
    states = _filter_poses(nodes[aligned_from:], alignment.aligned, update_first=False)
    pose, covariance = _track_columns(states)
    pose = np.concatenate([alignment.pose, pose[1:]])
    covariance = np.concatenate([alignment.covariance, covariance[1:]])
    return FilteredSegment(nodes, aligned_from, pose, covariance, tuple(states), states[-1])


def undecided(pose: Array, covariance: Array, other: GaussianState) -> GaussianState:
    """The state for a pose whose direction is open, with the rest of another state."""
    state = np.diag([0.0, 0.0, 0.0, *np.diag(other.covariance)[3:]])
    state[:3, :3] = covariance
    return GaussianState(np.array([*pose, *other.mean[3:]]), state)


def _track_columns(states: list[GaussianState]) -> tuple[Array, Array]:
    """Poses (n, 3) and their covariances (n, 3, 3)."""
    return np.array([state.mean[:3] for state in states]), np.array([state.covariance[:3, :3] for state in states])


def _filter_poses(nodes: tuple[Node, ...], first: GaussianState, update_first: bool) -> list[GaussianState]:
    """EKF over the nodes; `first` is the state at nodes[0], before its measurements if update_first."""
    ekf = PoseFilter()
    ekf.enter(first)
    states = []
    for i, node in enumerate(nodes):
        if i:
            ekf.advance(node)
        if i or update_first:
            ekf.measure(node)
        states.append(ekf.moments())
    return states
