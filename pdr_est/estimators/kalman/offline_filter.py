"""Offline filter of a walk: a fold of the filter's step over the nodes of all devices in order of time."""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from pdr_est.estimators.common.initial_state import StartPrior, closing_fix, start_prior
from pdr_est.estimators.common.motion_model import GaussianState
from pdr_est.estimators.common.nodes import SAME_S, Node
from pdr_est.estimators.common.tethers import NodeTether
from pdr_est.estimators.common.timeline import Timeline
from pdr_est.estimators.kalman.device_filter_step import DeviceFilterState, filtered_states
from pdr_est.estimators.kalman.hypothesis_bank import HypothesisBank
from pdr_est.estimators.kalman.joint_filter_step import WalkFilterState, WalkStepper
from pdr_est.estimators.kalman.predict_and_update import marginal_of
from pdr_est.frames import Array
from pdr_est.types.measurements import StartPose

_MORE_THAN_MOST = 2.0  # share of a hypothesis over the mean share, from which on it is more probable than others


@dataclass(frozen=True)
class FilteredSegment:
    """Filter results at consecutive nodes of one device; between two segments the heading was lost.

    Attributes
    ----------
    nodes
        Nodes (n) of the segment.
    aligned_from
        Index of the first node with a known heading; None if it never became known.
    pose
        Filtered poses (n, 3), east m, north m, heading rad.
    covariance
        Their covariances (n, 3, 3).
    states
        Filtered states at the nodes from `aligned_from` on.
    end
        Filtered state at the last node.
    bank
        Hypotheses at the last node that the measurements could not decide; None where one Gaussian describes the
        state.
    """

    nodes: tuple[Node, ...]
    aligned_from: int | None
    pose: Array
    covariance: Array
    states: tuple[GaussianState, ...]
    end: GaussianState
    bank: HypothesisBank | None

    def open_anchor(self) -> tuple[int, GaussianState]:
        """Return a node and a state there to reckon from, if the heading never became known.

        It is the last node, and its most probable state, if some headings are more probable than others; otherwise
        the last node that observes the heading.
        """
        if self.bank is not None and self.bank.weights.max() > _MORE_THAN_MOST / len(self.bank):
            return len(self.nodes) - 1, self.bank.state_of_hypothesis(self.bank.likeliest)
        anchor = max((i for i, node in enumerate(self.nodes) if node.observes_heading), default=0)
        mean, covariance = self.end.mean.copy(), self.end.covariance.copy()
        mean[:3] = self.pose[anchor]
        covariance[:3, :], covariance[:, :3] = 0.0, 0.0
        covariance[:3, :3] = self.covariance[anchor]
        return anchor, replace(self.end, mean=mean, covariance=covariance)


@dataclass(frozen=True)
class JointPosterior:
    """Joint state of all devices after one node and the tethers that follow it.

    Attributes
    ----------
    touched
        Numbers of device and node: first the node itself, then the nodes of other devices that tethers changed.
    states
        Filtered states at these nodes: each after the node itself and the tethers that join its device, as of that
        time.
    node_tethers
        Tethers that were applied after the node.
    entered
        State with which the device entered the joint state at this node, if it did.
    joint
        Joint state of all devices and sources.
    devices
        Number of devices.
    """

    touched: tuple[tuple[int, int], ...]
    states: tuple[GaussianState, ...]
    node_tethers: tuple[NodeTether, ...]
    entered: GaussianState | None
    joint: GaussianState
    devices: int

    def state_of(self, device: int) -> GaussianState:
        """Return the state of a device after all these tethers."""
        return marginal_of(self.joint, device, self.devices)


@dataclass(frozen=True)
class FilteredWalk:
    """Filter results of all devices.

    Attributes
    ----------
    segments
        Segments of each device by its own measurements.
    posteriors
        Joint posteriors in order of time, one for each node whose device knows its heading there.
    """

    segments: list[list[FilteredSegment]]
    posteriors: list[JointPosterior]


def run_filter(timeline: Timeline, start: StartPose, sigma_length_scale: float) -> list[FilteredSegment]:
    """Filter the nodes of one device by its own measurements."""
    prior = start_prior(timeline, start, sigma_length_scale)
    nodes = _closed(timeline, prior)
    return _segments(nodes, list(filtered_states(nodes, prior)))


def filter_walk(
    timelines: Sequence[Timeline],
    node_tethers: Sequence[NodeTether],
    starts: Sequence[StartPose],
    sigma_length_scale: float,
) -> FilteredWalk:
    """Filter the nodes of all devices in order of time, then of device.

    While the heading of a device is unknown, its filter has several hypotheses and the device is left out of the
    joint state. A turn that leaves no knowledge of the heading begins a new segment, if later measurements can
    find the heading again. A loop closure concerns the device's own filter only.

    Parameters
    ----------
    timelines
        Measurements of each device.
    node_tethers
        Tethers in order of time. A tether applies after all nodes up to its time, as for a filter that runs during
        the walk.
    starts
        Start pose of each device.
    sigma_length_scale
        Standard deviation of the walker's length scale around 1.
    """
    priors = [start_prior(one, start, sigma_length_scale) for one, start in zip(timelines, starts, strict=True)]
    own_nodes = [_closed(timeline, prior) for timeline, prior in zip(timelines, priors, strict=True)]
    last_observing = [max((i for i, n in enumerate(nodes) if n.observes_heading), default=0) for nodes in own_nodes]
    fold = _Fold(WalkStepper(len(timelines)), node_tethers)
    order = [(node.time_s, device, i) for device, one in enumerate(timelines) for i, node in enumerate(one.nodes)]
    for time_s, device, i in sorted(order):
        fold.tether(time_s)
        fold.state, entered = fold.stepper.step(
            fold.state,
            device,
            i,
            timelines[device].nodes[i],
            heading_observed_later=i <= last_observing[device],
            prior=priors[device],
            own_node=own_nodes[device][i],
        )
        fold.record(device, i, entered)
    fold.tether(np.inf)
    segments = [_segments(nodes, states) for nodes, states in zip(own_nodes, fold.own_states, strict=True)]
    return FilteredWalk(segments, fold.posteriors)


class _Fold:
    """State of the fold over the nodes, with the results so far."""

    def __init__(self, stepper: WalkStepper, node_tethers: Sequence[NodeTether]) -> None:
        self.stepper = stepper
        self.state: WalkFilterState = stepper.initial(joint=True)
        self.own_states: list[list[DeviceFilterState]] = [[] for _ in self.state.devices]
        self.posteriors: list[JointPosterior] = []
        self._due = deque(node_tethers)

    def tether(self, before_s: float) -> None:
        """Apply the tethers before a time, and add them to the last posterior."""
        due = []
        while self._due and self._due[0].time_s + SAME_S < before_s:
            due.append(self._due.popleft())
        self.state, applied = self.stepper.apply_tethers(self.state, due)
        if not applied:
            return
        last, joint = self.posteriors[-1], self.state.joint_state()
        ends = {end for one in applied for end in ((one.device_a, one.node_a), (one.device_b, one.node_b))}
        states = dict(zip(last.touched, last.states, strict=True))
        states |= {end: marginal_of(joint, end[0], last.devices) for end in sorted(ends)}
        tethers = (*last.node_tethers, *applied)
        self.posteriors[-1] = JointPosterior(
            tuple(states), tuple(states.values()), tethers, last.entered, joint, last.devices
        )

    def record(self, device: int, number: int, entered: GaussianState | None) -> None:
        """Keep the results after a node."""
        own = self.state.devices[device]
        if own is None:
            return
        self.own_states[device].append(own)
        if self.state.joint is not None and own.heading_known:
            joint, devices = self.state.joint_state(), len(self.state.devices)
            state = marginal_of(joint, device, devices)
            self.posteriors.append(JointPosterior(((device, number),), (state,), (), entered, joint, devices))


def _closed(timeline: Timeline, prior: StartPrior) -> tuple[Node, ...]:
    """Return the nodes, the last one with a fix at the start if the walk is closed and its start is known."""
    if timeline.closure_sigma_m is None:
        return timeline.nodes
    *before, last = timeline.nodes
    fix = closing_fix(prior, last.time_s, timeline.closure_sigma_m)
    return timeline.nodes if fix is None else (*before, replace(last, fixes=(*last.fixes, fix)))


def _segments(nodes: Sequence[Node], states: Sequence[DeviceFilterState]) -> list[FilteredSegment]:
    """Divide the filter results of a device into segments."""
    begins = sorted({state.segment_begin for state in states})
    segments = []
    for begin, end in zip(begins, [*begins[1:], len(nodes)], strict=True):
        own = states[begin:end]
        aligned = next((k for k, state in enumerate(own) if state.heading_known), None)
        segments.append(
            FilteredSegment(
                tuple(nodes[begin:end]),
                aligned,
                np.array([state.pose for state in own]),
                np.array([state.covariance for state in own]),
                () if aligned is None else tuple(state.state for state in own[aligned:]),
                own[-1].state,
                own[-1].bank,
            )
        )
    return segments
