"""The filter of several devices on one body: their states side by side, kept within reach of each other."""

from collections import defaultdict
from collections.abc import Sequence

import numpy as np

from pdr_est.estimators.ekf import NAME, Stretch, run_filter
from pdr_est.estimators.motion import Moments
from pdr_est.estimators.pose_filter import PoseFilter
from pdr_est.estimators.ties import Tie, starts_of, ties_between
from pdr_est.estimators.timeline import Timeline, track_from_nodes
from pdr_est.records import DeviceTether, StartPose
from pdr_est.track import Track, concatenate


def estimate(
    timelines: Sequence[Timeline], tethers: Sequence[DeviceTether], start: StartPose, sigma_length_scale: float
) -> Track:
    """Filtered tracks of all devices: each pose from the past of all of them."""
    starts = starts_of(timelines, start)
    alone = [run_filter(timeline, one, sigma_length_scale) for timeline, one in zip(timelines, starts, strict=True)]
    walks = [_Followed(timeline, stretches) for timeline, stretches in zip(timelines, alone, strict=True)]
    ties: dict[tuple[int, int], list[Tie]] = defaultdict(list)
    for tie in ties_between(timelines, tethers):
        later = max((tie.device_a, tie.node_a), (tie.device_b, tie.node_b), key=lambda end: _when(timelines, end))
        ties[later].append(tie)
    joint = PoseFilter(len(timelines))
    ends = [(device, i) for device, timeline in enumerate(timelines) for i in range(len(timeline.nodes))]
    for end in sorted(ends, key=lambda end: _when(timelines, end)):
        walks[end[0]].follow(joint, *end)
        for tie in ties[end]:
            if walks[tie.device_a].in_filter(tie.node_a) and walks[tie.device_b].in_filter(tie.node_b):
                joint.keep_together(tie.device_a, tie.device_b, tie.max_distance_m, tie.sigma_m)
                walks[tie.device_a].record(joint, tie.device_a, tie.node_a)
                walks[tie.device_b].record(joint, tie.device_b, tie.node_b)
    return concatenate([walk.track() for walk in walks])


def _when(timelines: Sequence[Timeline], end: tuple[int, int]) -> tuple[float, int, int]:
    """Order of the nodes of all devices: by time, then as the devices are given."""
    device, node = end
    return timelines[device].nodes[node].time_s, device, node


class _Followed:
    """One device in the joint filter. While its direction is open, it is followed by itself (`alignment.py`)."""

    def __init__(self, timeline: Timeline, stretches: Sequence[Stretch]) -> None:
        self._timeline = timeline
        self._pose = np.concatenate([stretch.pose for stretch in stretches])
        self._covariance = np.concatenate([stretch.covariance for stretch in stretches])
        self._enters: dict[int, Moments] = {}
        self._in_filter = np.zeros(len(timeline.nodes), dtype=np.bool_)
        self._end = stretches[-1].end
        begin = 0
        for stretch in stretches:
            if stretch.aligned_from is not None:
                self._enters[begin + stretch.aligned_from] = stretch.moments[0]
                self._in_filter[begin + stretch.aligned_from : begin + len(stretch.nodes)] = True
            begin += len(stretch.nodes)

    def in_filter(self, node: int) -> bool:
        return bool(self._in_filter[node])

    def follow(self, joint: PoseFilter, device: int, node: int) -> None:
        """Move the device to a node, unless its direction is open there."""
        if not self._in_filter[node]:
            return
        if node in self._enters:
            joint.enter(self._enters[node], device)
        else:
            joint.advance(self._timeline.nodes[node], device)
            joint.measure(self._timeline.nodes[node], device)
        self.record(joint, device, node)

    def record(self, joint: PoseFilter, device: int, node: int) -> None:
        state = joint.moments(device)
        self._pose[node], self._covariance[node] = state.mean[:3], state.covariance[:3, :3]
        self._end = state

    def track(self) -> Track:
        scale = (float(self._end.mean[3]), float(np.sqrt(self._end.covariance[3, 3])))
        position_m, heading_rad = self._pose[:, :2], self._pose[:, 2]
        return track_from_nodes(self._timeline, position_m, heading_rad, self._covariance, "filtered", NAME, scale)
