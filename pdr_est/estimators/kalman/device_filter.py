"""Offline filter of one device by its own measurements: a fold of the filter's step over its nodes.

Where nothing is measured over some nodes, the motions to all of them are linearised at once. The states are those
that the steps of `device_filter_step` give, to the last bit, so that they are those of the online filter.
"""

from collections.abc import Iterator, Sequence

import numpy as np

from pdr_est.estimators.common.initial_state import StartPrior
from pdr_est.estimators.common.motion_model import GaussianState, linearise_in_turn
from pdr_est.estimators.common.nodes import Node
from pdr_est.estimators.kalman.device_filter_step import (
    DeviceFilterState,
    agrees,
    loses_heading,
    start_device,
    step_device,
)
from pdr_est.estimators.kalman.hypothesis_bank import HypothesisBank
from pdr_est.estimators.kalman.predict_and_update import NodeFilter
from pdr_est.estimators.kalman.source_clock import with_node
from pdr_est.frames import Array
from pdr_est.records import changed, made

_FEW = 3  # nodes; fewer are stepped to in less time than they are predicted at once (ours)
_MOST_NODES, _MOST_STATES = 256, 2048  # that are predicted at once, which bounds the memory


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
    for node in nodes:
        trail = with_node(trail, node)
    return trail
