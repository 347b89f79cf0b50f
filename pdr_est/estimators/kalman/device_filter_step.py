"""Step of the filter of one device by its own measurements: state before a node and the node give the state after it.

A state is never changed in place, so an earlier one can be kept and continued from.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from pdr_est.estimators.common.initial_state import StartPrior, prior_after_lost_heading
from pdr_est.estimators.common.motion_model import GaussianState
from pdr_est.estimators.common.nodes import Node
from pdr_est.estimators.kalman.hypothesis_bank import HypothesisBank, Lineage
from pdr_est.estimators.kalman.predict_and_update import NodeFilter
from pdr_est.frames import Array

HEADING_RESET_VARIANCE_RAD2 = 0.25
"""Heading variance of a turn, rad², above which the heading is too far from Gaussian for an EKF and is given up."""

ALIGNED_SIGMA_RAD = 0.3
"""Standard deviation of the heading over all hypotheses, rad, below which one Gaussian describes the state."""


@dataclass(frozen=True)
class DeviceFilterState:
    """State of one device's filter after a node.

    A segment is a run of nodes between two turns that leave no knowledge of the heading.

    Attributes
    ----------
    segment_begin
        Number of the first node of the present segment.
    state
        Filtered state of the device; of several hypotheses the moments of their mixture.
    bank
        Hypotheses about the heading; None where one Gaussian describes the state.
    heading_known
        False from the begin of a segment with an unknown heading until one Gaussian describes the state.
    heading_found
        True at the node at which the heading became known.
    lost_heading_s
        Time of the first turn, since the last measurement that observes the heading, that left no knowledge of the
        heading. A later measurement of that kind would begin a new segment there.
    decided
        Turns that were chosen where there were hypotheses about them, up to the last one that is decided.
    """

    segment_begin: int
    state: GaussianState
    bank: HypothesisBank | None
    heading_known: bool
    heading_found: bool
    lost_heading_s: float | None = None
    decided: Lineage = ()

    @property
    def pose(self) -> Array:
        """Filtered pose (3,), east m, north m, heading rad, for the track."""
        return self.state.mean[:3]

    @property
    def covariance(self) -> Array:
        """Covariance (3, 3) of the pose."""
        return self.state.covariance[:3, :3]


def loses_heading(node: Node) -> bool:
    """Tell whether a turn is too uncertain to leave any knowledge of the heading."""
    return bool(node.covariance[2, 2] > HEADING_RESET_VARIANCE_RAD2) and not node.turn_hypotheses


def agrees(heading_variance: Array, hypotheses: int) -> NDArray[np.bool_]:
    """Tell for which variances (n,) of the heading over so many hypotheses one Gaussian describes the state."""
    largest = HEADING_RESET_VARIANCE_RAD2 if hypotheses == 1 else ALIGNED_SIGMA_RAD**2
    return np.asarray(heading_variance < largest)


def start_device(
    node: Node, number: int, prior: StartPrior, scratch: NodeFilter, decided: Lineage = ()
) -> DeviceFilterState:
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
    decided
        Turns that were chosen before.
    """
    if prior.heading_open:
        bank = HypothesisBank.of_unknown_heading(prior.state, decided).updated(node)
        return _after_bank(bank, number, heading_known=False)
    scratch.load(prior.state)
    scratch.update_node(node)
    return DeviceFilterState(number, scratch.state_of(), None, True, True, decided=decided)


def restart_device(before: DeviceFilterState, node: Node, number: int, scratch: NodeFilter) -> DeviceFilterState:
    """Return the state after a node at which the heading is given up and a new segment begins.

    The parameters are those of `step_device`.
    """
    return start_device(node, number, prior_after_lost_heading(before.state, node), scratch, before.decided)


def step_device(
    before: DeviceFilterState, node: Node, number: int, heading_observed_later: bool, scratch: NodeFilter
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
    heading_observed_later
        True if a measurement at this node or later observes the heading. Only then is a heading given up of which a
        turn leaves no knowledge.
    scratch
        EKF of one device, used as working memory only.
    """
    is_lost = loses_heading(node)
    if is_lost and heading_observed_later:
        return restart_device(before, node, number, scratch)
    lost_s = before.lost_heading_s if before.lost_heading_s is not None or not is_lost else node.time_s
    lost_s = None if node.observes_heading else lost_s
    bank = before.bank
    if bank is None and node.turn_hypotheses:
        bank = HypothesisBank.of_state(before.state, before.decided)
    if bank is not None:
        after = _after_bank(bank.predicted(node, number).updated(node), before.segment_begin, before.heading_known)
        decided = before.decided if after.bank is not None else after.decided
        return replace(after, lost_heading_s=lost_s, decided=decided)
    scratch.load(before.state)
    scratch.predict_node(node)
    scratch.update_node(node)
    return DeviceFilterState(before.segment_begin, scratch.state_of(), None, True, False, lost_s, before.decided)


def _after_bank(bank: HypothesisBank, begin: int, heading_known: bool) -> DeviceFilterState:
    """Return the state after a node up to which there were hypotheses; they end where they agree."""
    state = bank.moments()
    agree = bool(agrees(state.covariance[2, 2], len(bank)))
    found, decided = agree and not heading_known, bank.lineages[bank.likeliest]
    return DeviceFilterState(begin, state, None if agree else bank, heading_known or agree, found, decided=decided)
