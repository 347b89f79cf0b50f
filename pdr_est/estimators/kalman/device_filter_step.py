"""Filter of one device by its own measurements: state before a node and the node give the state after it.

A state is never changed in place, so an earlier one can be kept and continued from. `filtered_states` is the fold of
the steps over all nodes. Where nothing is measured over some nodes, it linearises the motions to all of them at once;
the states are those of the steps to the last bit, so that they are those of the online filter.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from pdr_est.estimators.common.initial_state import StartPrior, prior_after_lost_heading
from pdr_est.estimators.common.motion_model import GaussianState, linearise_in_turn
from pdr_est.estimators.common.nodes import Node
from pdr_est.estimators.kalman.hypothesis_bank import HypothesisBank, Lineage
from pdr_est.estimators.kalman.predict_and_update import NodeFilter
from pdr_est.estimators.kalman.source_clock import with_node
from pdr_est.frames import Array
from pdr_est.records import changed, made

HEADING_RESET_VARIANCE_RAD2 = 0.25
"""Heading variance of a turn, rad², above which the heading is too far from Gaussian for an EKF and is given up."""

ALIGNED_SIGMA_RAD = 0.3
"""Standard deviation of the heading over all hypotheses, rad, below which one Gaussian describes the state."""


_FEW = 3  # nodes; fewer are stepped to in less time than they are predicted at once (ours)
_MOST_NODES, _MOST_STATES = 256, 2048  # that are predicted at once, which bounds the memory


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


def filtered_states(nodes: Sequence[Node], prior: StartPrior) -> Iterator[DeviceFilterState]:
    """Yield the state of a device's filter after each of its nodes, at least one.

    The trail of nodes behind a state, over which a fix may be late, is that of the last node of those that were
    predicted at once; the states at the others have none.

    Parameters
    ----------
    nodes
        All nodes of the device.
    prior
        Prior of the state at the first one.
    """
    observing = max((i for i, node in enumerate(nodes) if node.observes_heading), default=0)
    scratch, number = NodeFilter(1), 1
    state = start_device(nodes[0], 0, prior, scratch)
    yield state
    stops = _stops(nodes)
    while number < len(nodes):
        count = min(stops[number] - number, _MOST_NODES, _MOST_STATES // _hypotheses(state))
        if count < _FEW:
            state = step_device(state, nodes[number], number, number <= observing, scratch)
            number += 1
            yield state
            continue
        states = _predicted(state, nodes[number : number + count])
        state, number = states[-1], number + len(states)
        yield from states


def _stops(nodes: Sequence[Node]) -> list[int]:
    """Return for each node the number of the first one, from it on, at which more than a sure motion is known."""
    stops, stop = [], len(nodes)
    for number in range(len(nodes) - 1, -1, -1):
        node = nodes[number]
        if node.fixes or node.priors or node.turn_hypotheses or loses_heading(node):
            stop = number
        stops.append(stop)
    return stops[::-1]


def _hypotheses(state: DeviceFilterState) -> int:
    return 1 if state.bank is None else len(state.bank)


def _predicted(before: DeviceFilterState, nodes: Sequence[Node]) -> list[DeviceFilterState]:
    """Return the states after nodes at which nothing is measured, up to the one at which the hypotheses agree."""
    bank = before.bank
    if bank is None:
        moments = _reckoned_state(before.state, nodes)
        return _with_moments(before, nodes, moments, [None] * len(nodes))
    means, covariances = _reckoned_bank(bank, nodes)
    mean, covariance = bank.moments_of(means, covariances)
    covariance = 0.5 * (covariance + covariance.transpose(0, 2, 1))
    agree = agrees(covariance[:, 2, 2], len(bank))
    count = int(np.argmax(agree)) + 1 if agree.any() else len(nodes)
    banks: list[HypothesisBank | None] = [
        changed(bank, means=own, covariances=spread, trail=(), taken=())
        for own, spread in zip(means[:count], covariances[:count], strict=True)
    ]
    trail = _trail(bank.trail, nodes[:count])
    if not agree.any():
        banks[-1] = changed(banks[-1], trail=trail)
    found = _with_moments(before, nodes[:count], (mean[:count], covariance[:count]), banks)
    if agree.any():
        decided = bank.lineages[bank.likeliest]
        found[-1] = changed(
            found[-1], bank=None, heading_known=True, heading_found=not before.heading_known, decided=decided
        )
    return found


def _reckoned_state(state: GaussianState, nodes: Sequence[Node]) -> tuple[Array, Array]:
    """Predict one state: means (n, s) at the nodes, and covariances (n, s, s)."""
    mean, jacobian, noise = linearise_in_turn(state.mean[None], nodes)
    covariance, covariances = state.covariance, np.empty(jacobian.shape)[:, 0]
    for found, change, added in zip(covariances, jacobian[:, 0], noise[:, 0], strict=True):
        covariance = np.dot(change, covariance).dot(change.T) + added
        covariance = np.multiply(covariance + covariance.T, 0.5, out=found)
    return mean[:, 0], covariances


def _reckoned_bank(bank: HypothesisBank, nodes: Sequence[Node]) -> tuple[Array, Array]:
    """Predict all hypotheses: means (n, k, s) at the nodes, and covariances (n, k, s, s)."""
    means, jacobian, noise = linearise_in_turn(bank.means, nodes)
    covariance, covariances = bank.covariances, np.empty(jacobian.shape)
    for found, change, added in zip(covariances, jacobian, noise, strict=True):
        covariance = np.add(change @ covariance @ change.transpose(0, 2, 1), added, out=found)
    return means, covariances


def _with_moments(
    before: DeviceFilterState,
    nodes: Sequence[Node],
    moments: tuple[Array, Array],
    banks: Sequence[HypothesisBank | None],
) -> list[DeviceFilterState]:
    """Make the states after nodes from means (n, s) and covariances (n, s, s), and the hypotheses there."""
    mean, covariance = moments
    state = changed(before.state, trails=((),), taken=())
    states = [
        made(
            GaussianState,
            mean=own,
            covariance=spread,
            sources=state.sources,
            trusts=state.trusts,
            trails=state.trails,
            taken=(),
        )
        for own, spread in zip(mean, covariance, strict=True)
    ]
    own_trail = before.state.trails[0] if before.state.trails else ()
    states[-1] = changed(states[-1], trails=(_trail(own_trail, nodes),))
    common = changed(before, heading_found=False)
    return [changed(common, state=one, bank=bank) for one, bank in zip(states, banks, strict=True)]


def _trail(trail: tuple[Node, ...], nodes: Sequence[Node]) -> tuple[Node, ...]:
    """Return the last nodes of a device after some more."""
    *before, last = (*trail, *nodes)
    return with_node(tuple(before), last)
