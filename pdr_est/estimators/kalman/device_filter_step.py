"""Step of the filter of one device by its own measurements: state before a node and the node give the state after it.

A state is never changed in place, so an earlier one can be kept and continued from.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from pdr_est.estimators.common.initial_state import StartPrior, prior_after_lost_heading
from pdr_est.estimators.common.motion_model import GaussianState
from pdr_est.estimators.common.nodes import Node
from pdr_est.estimators.kalman.heading_search import HeadingSearch, search_heading
from pdr_est.estimators.kalman.predict_and_update import MultiDeviceEkf
from pdr_est.frames import Array

HEADING_RESET_VARIANCE_RAD2 = 0.25
"""Heading variance of a turn, rad², above which the heading is too far from Gaussian for an EKF and is given up."""


@dataclass(frozen=True)
class DeviceFilterState:
    """State of one device's filter after a node.

    A segment is a run of nodes between two turns that leave no knowledge of the heading.

    Attributes
    ----------
    segment_begin
        Number of the first node of the present segment.
    segment_prior
        Prior state at that node.
    search
        State of the heading search; None once the heading is known.
    ekf_state
        Mean and covariance as the EKF left them; None until the heading is known.
    pose
        Filtered pose (3,), east m, north m, heading rad, for the track.
    covariance
        Its covariance (3, 3).
    state
        Filtered state of the device.
    heading_found
        True at the node at which the heading became known.
    lost_heading_s
        Time of the first turn, since the last measurement that observes the heading, that left no knowledge of the
        heading. A later measurement of that kind would begin a new segment there.
    """

    segment_begin: int
    segment_prior: GaussianState
    search: HeadingSearch | None
    ekf_state: GaussianState | None
    pose: Array
    covariance: Array
    state: GaussianState
    heading_found: bool
    lost_heading_s: float | None = None

    @property
    def heading_known(self) -> bool:
        """Tell whether the heading is known well enough for the EKF."""
        return self.ekf_state is not None


def start_device(node: Node, number: int, prior: StartPrior, scratch: MultiDeviceEkf) -> DeviceFilterState:
    """Return the state after the first node of a segment.

    Parameters
    ----------
    node
        First node of the segment.
    number
        Its number.
    prior
        Prior of the state there.
    scratch
        EKF of one device, used as working memory only.
    """
    if prior.heading_open:
        return _after_search(None, node, [node], number, prior.state)
    scratch.set_state(prior.state)
    scratch.update_node(node)
    return _after_ekf(number, prior.state, scratch, heading_found=True)


def restart_device(before: DeviceFilterState, node: Node, number: int, scratch: MultiDeviceEkf) -> DeviceFilterState:
    """Return the state after a node at which the heading is given up and a new segment begins.

    The parameters are those of `step_device`.
    """
    return start_device(node, number, prior_after_lost_heading(before.state, node), scratch)


def step_device(
    before: DeviceFilterState,
    node: Node,
    number: int,
    segment: Sequence[Node],
    heading_observed_later: bool,
    scratch: MultiDeviceEkf,
) -> DeviceFilterState:
    """Return the state after a node.

    Parameters
    ----------
    before
        State after the previous node.
    node
        Node to step to.
    number
        Its number.
    segment
        Nodes of the present segment up to and including this one; used only while the heading is unknown.
    heading_observed_later
        True if a measurement at this node or later observes the heading. Only then is a heading given up of which a
        turn leaves no knowledge.
    scratch
        EKF of one device, used as working memory only.
    """
    is_lost = bool(node.covariance[2, 2] > HEADING_RESET_VARIANCE_RAD2)
    if is_lost and heading_observed_later:
        return restart_device(before, node, number, scratch)
    lost_s = before.lost_heading_s if before.lost_heading_s is not None or not is_lost else node.time_s
    lost_s = None if node.observes_heading else lost_s
    if before.ekf_state is None:
        searched = _after_search(before.search, node, segment, before.segment_begin, before.segment_prior)
        return replace(searched, lost_heading_s=lost_s)
    scratch.load(before.ekf_state)
    scratch.predict_node(node)
    scratch.update_node(node)
    return _after_ekf(before.segment_begin, before.segment_prior, scratch, heading_found=False, lost_s=lost_s)


def _after_search(
    before: HeadingSearch | None, node: Node, segment: Sequence[Node], begin: int, prior: GaussianState
) -> DeviceFilterState:
    """Continue the heading search to a node."""
    found, aligned = search_heading(before, node, segment, prior)
    if aligned is None:
        state = with_open_heading(found.pose, found.covariance, prior)
        return DeviceFilterState(begin, prior, found, None, found.pose, found.covariance, state, heading_found=False)
    state = GaussianState(aligned.mean, 0.5 * (aligned.covariance + aligned.covariance.T))
    pose, covariance = aligned.mean[:3], aligned.covariance[:3, :3]
    return DeviceFilterState(begin, prior, None, aligned, pose, covariance, state, heading_found=True)


def _after_ekf(
    begin: int, prior: GaussianState, ekf: MultiDeviceEkf, heading_found: bool, lost_s: float | None = None
) -> DeviceFilterState:
    """Read the state of the EKF."""
    state = ekf.state_of()
    pose, covariance = state.mean[:3], state.covariance[:3, :3]
    return DeviceFilterState(begin, prior, None, ekf.dump(), pose, covariance, state, heading_found, lost_s)


def with_open_heading(pose: Array, covariance: Array, other: GaussianState) -> GaussianState:
    """Combine a pose (3,) of unknown heading with the length scale and reference direction of another state."""
    whole = np.diag([0.0, 0.0, 0.0, *np.diag(other.covariance)[3:]])
    whole[:3, :3] = covariance
    return GaussianState(np.array([*pose, *other.mean[3:]]), whole)
