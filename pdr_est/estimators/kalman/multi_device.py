"""The filter of several devices on one body, their states side by side and kept within reach of each other, and its
Rauch-Tung-Striebel smoother."""

from bisect import bisect_right
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from pdr_est.estimators.common.motion_model import STATES, GaussianState
from pdr_est.estimators.common.tethers import NodeTether, donor_of, node_tethers_between, starts_of
from pdr_est.estimators.common.timeline import SAME_S, Timeline, track_from_nodes
from pdr_est.estimators.kalman.multi_device_ekf import PoseFilter
from pdr_est.estimators.kalman.single_device import NAME, FilteredSegment, run_filter
from pdr_est.frames import Array
from pdr_est.types.measurements import DeviceTether, StartPose
from pdr_est.types.track import Track, concatenate

End = tuple[int, int]  # a pose: number of the device, number of its node


def estimate(
    timelines: Sequence[Timeline], tethers: Sequence[DeviceTether], start: StartPose, sigma_length_scale: float
) -> Track:
    """Filtered tracks of all devices: each pose from the past of all of them."""
    node_tethers, starts = node_tethers_between(timelines, tethers), starts_of(timelines, start)
    alone = [run_filter(timeline, one, sigma_length_scale) for timeline, one in zip(timelines, starts, strict=True)]
    filtered = [_Filtered(timeline, stretches) for timeline, stretches in zip(timelines, alone, strict=True)]
    for moment in follow(timelines, alone, node_tethers):
        for device, node in moment.touched:
            filtered[device].record(node, _of_device(moment.mean, moment.covariance, device))
    return concatenate([one.track() for one in filtered])


@dataclass(frozen=True)
class JointPosterior:
    """The joint filter after one node. touched: the node, and others that a tie changed. ties: those that were
    applied then. entered: the state that the device entered the filter with, if it did."""

    touched: tuple[End, ...]
    node_tethers: tuple[NodeTether, ...]
    entered: GaussianState | None
    mean: Array
    covariance: Array


def follow(
    timelines: Sequence[Timeline], alone: Sequence[Sequence[FilteredSegment]], node_tethers: Sequence[NodeTether]
) -> Iterator[JointPosterior]:
    """The nodes of all devices in order of time, but for those at which the direction of their device is open."""
    enters = [_enters(stretches) for stretches in alone]
    ends = [
        (device, i)
        for device, timeline in enumerate(timelines)
        for i in range(len(timeline.nodes))
        if _takes_part(alone[device], i)
    ]
    ends.sort(key=lambda end: _when(timelines, end))
    tied = _last_ends(node_tethers, ends, timelines, alone)
    joint, present = PoseFilter(len(timelines)), set[int]()
    begun_s = min(timeline.nodes[0].time_s for timeline in timelines)
    for device, i in ends:
        node, entered = timelines[device].nodes[i], enters[device].get(i)
        if entered is not None:
            entered = joint.join(entered, node, device, donor_of(i, node.time_s, begun_s, present))
            present.add(device)
        else:
            joint.advance(node, device)
            joint.measure(node, device)
        touched = [(device, i)]
        for node_tether in tied[device, i]:
            joint.keep_together(
                node_tether.device_a, node_tether.device_b, node_tether.max_distance_m, node_tether.sigma_m
            )
            touched += [
                end
                for end in ((node_tether.device_a, node_tether.node_a), (node_tether.device_b, node_tether.node_b))
                if end not in touched
            ]
        yield JointPosterior(
            tuple(touched), tuple(tied[device, i]), entered, joint.x.copy(), 0.5 * (joint.P + joint.P.T)
        )


def _last_ends(
    node_tethers: Sequence[NodeTether],
    ends: Sequence[End],
    timelines: Sequence[Timeline],
    alone: Sequence[Sequence[FilteredSegment]],
) -> dict[End, list[NodeTether]]:
    """The ties of devices that take part, each at the last of all ends up to its time: a filter that runs along with
    the walk knows no better."""
    times = [timelines[device].nodes[node].time_s for device, node in ends]
    tied: dict[End, list[NodeTether]] = defaultdict(list)
    for node_tether in node_tethers:
        if all(
            _takes_part(alone[d], node)
            for d, node in ((node_tether.device_a, node_tether.node_a), (node_tether.device_b, node_tether.node_b))
        ):
            tied[ends[bisect_right(times, node_tether.time_s + SAME_S) - 1]].append(node_tether)
    return tied


def _when(timelines: Sequence[Timeline], end: End) -> tuple[float, int, int]:
    """Order of the nodes of all devices: by time, then as the devices are given."""
    device, node = end
    return timelines[device].nodes[node].time_s, device, node


def _enters(stretches: Sequence[FilteredSegment]) -> dict[int, GaussianState]:
    """State of a device at each node where its direction became known."""
    begins = np.cumsum([0, *(len(stretch.nodes) for stretch in stretches)])
    return {
        int(begin) + stretch.aligned_from: stretch.moments[0]
        for begin, stretch in zip(begins, stretches, strict=False)
        if stretch.aligned_from is not None
    }


def _takes_part(stretches: Sequence[FilteredSegment], node: int) -> bool:
    """Whether the direction of a device is known at a node."""
    for stretch in stretches:
        if node < len(stretch.nodes):
            return stretch.aligned_from is not None and node >= stretch.aligned_from
        node -= len(stretch.nodes)
    return False


def _of_device(mean: Array, covariance: Array, device: int) -> GaussianState:
    own = slice(STATES * device, STATES * (device + 1))
    return GaussianState(mean[own].copy(), covariance[own, own].copy())


class _Filtered:
    """The filtered poses of one device; those where its direction is open are what it tells itself."""

    def __init__(self, timeline: Timeline, stretches: Sequence[FilteredSegment]) -> None:
        self._timeline = timeline
        self._pose = np.concatenate([stretch.pose for stretch in stretches])
        self._covariance = np.concatenate([stretch.covariance for stretch in stretches])
        self._end = stretches[-1].end

    def record(self, node: int, state: GaussianState) -> None:
        self._pose[node], self._covariance[node] = state.mean[:3], state.covariance[:3, :3]
        self._end = state

    def track(self) -> Track:
        position_m, heading_rad = self._pose[:, :2], self._pose[:, 2]
        return track_from_nodes(
            self._timeline, position_m, heading_rad, self._covariance, "filtered", NAME, self._end.length_scale
        )
