"""Smooth with a fixed delay: each pose uses the measurements up to a lag after it.

The window (`pose_window`) has the factors of the batch graph. The walker's length scale would be connected to every
step; it is therefore taken from an EKF that runs in parallel. Steps are scaled by its estimate, and its
cross-covariance of pose and scale gives the part of the covariance that the scale adds. When the EKF estimate changes
noticeably, the window is built anew at the new scale, from the EKF state at its beginning.
"""

from collections.abc import Iterator, Sequence

import numpy as np

from pdr_est.estimators.common.initial_state import starts_of
from pdr_est.estimators.common.motion_model import GaussianState
from pdr_est.estimators.common.tethers import node_tethers_between
from pdr_est.estimators.common.timeline import Timeline, track_from_nodes
from pdr_est.estimators.fixed_lag.params import FixedLagParams
from pdr_est.estimators.fixed_lag.window import LagWindow
from pdr_est.estimators.fixed_lag.window_entries import FilteredNode, LaggedPose
from pdr_est.estimators.kalman.known_heading import KnownHeadings, known_headings
from pdr_est.estimators.kalman.offline_filter import FilteredSegment, FilteredWalk, filter_walk
from pdr_est.estimators.reckoned_poses import reckon
from pdr_est.frames import Array
from pdr_est.types.measurements import DeviceTether, StartPose
from pdr_est.types.track import Track, concatenate

NAME = "fixed-lag"


def estimate(
    timelines: Sequence[Timeline],
    tethers: Sequence[DeviceTether],
    start: StartPose,
    sigma_length_scale: float,
    parameters: FixedLagParams,
) -> Track:
    """Estimate the tracks of all devices, each pose from the measurements up to `lag_s` after it.

    Poses of a device whose heading is unknown for longer than the lag are those of the EKF.

    Parameters
    ----------
    timelines
        Nodes of each device.
    tethers
        Largest distances between pairs of devices.
    start
        Start pose; unknown parts are found from measurements.
    sigma_length_scale
        Standard deviation of the walker's length scale.
    parameters
        Settings of the smoother.

    Returns
    -------
    Track
        Delayed poses of all devices.

    Raises
    ------
    EstimationError
        If a window has no unique solution, or a tether names a device that is not there.
    """
    node_tethers, starts = node_tethers_between(timelines, tethers), starts_of(timelines, start)
    known = known_headings(timelines, node_tethers, starts, sigma_length_scale) if len(timelines) > 1 else None
    if known is not None:
        tracks, items = [_Delayed.of_known(*one) for one in known.filtered(timelines)], _known_nodes(timelines, known)
    else:
        walk = filter_walk(timelines, node_tethers, starts, sigma_length_scale)
        tracks = [_Delayed.of_segments(segments, parameters.lag_s) for segments in walk.segments]
        items = _filtered_nodes(timelines, walk)
    window, numbers = LagWindow(parameters), [iter(track.smoothed_nodes) for track in tracks]
    for item in items:
        for ready in window.push(item):
            tracks[ready.device].record(next(numbers[ready.device]), ready)
    for ready in window.flush():
        tracks[ready.device].record(next(numbers[ready.device]), ready)
    return concatenate([track.track(timeline) for track, timeline in zip(tracks, timelines, strict=True)])


def _filtered_nodes(timelines: Sequence[Timeline], walk: FilteredWalk) -> Iterator[FilteredNode]:
    """Yield the results of the joint EKF in order of time."""
    present: frozenset[int] = frozenset()
    for posterior in walk.posteriors:
        device, node = posterior.touched[0]
        present |= {device}
        yield FilteredNode.of_state(
            posterior.joint,
            device,
            timelines[device].nodes[node],
            posterior.entered,
            posterior.node_tethers,
            present,
            len(timelines),
        )


def _known_nodes(timelines: Sequence[Timeline], known: KnownHeadings) -> Iterator[FilteredNode]:
    """Yield the results of the joint EKF of devices whose headings are known throughout, likewise."""
    present: frozenset[int] = frozenset()
    covariance = 0.5 * (known.covariance + known.covariance.transpose(0, 2, 1))
    for row, (device, node) in enumerate(zip(known.device.tolist(), known.node.tolist(), strict=True)):
        present |= {device}
        tethers = tuple(known.tethers.get(row, ()))
        mean, entered = known.mean[row], known.entered.get(row)
        yield FilteredNode(device, timelines[device].nodes[node], entered, tethers, mean, covariance[row], present)


class _Delayed:
    """Poses of one device: those of its own EKF until the smoother replaces them.

    Parameters
    ----------
    pose, covariance
        Poses (n, 3) and covariances (n, 3, 3) of the EKF.
    scale
        Length scale at the end of the walk, and its standard deviation.
    smoothed_nodes
        Indices of the nodes that the smoother estimates.
    """

    def __init__(
        self, pose: Array, covariance: Array, scale: tuple[float, float], smoothed_nodes: Sequence[int]
    ) -> None:
        self._pose, self._covariance, self._scale = pose, covariance, scale
        self.smoothed_nodes = smoothed_nodes

    @classmethod
    def of_known(cls, mean: Array, covariance: Array) -> "_Delayed":
        """Begin with the states of a device whose heading is known throughout: (n, 5) and (n, 5, 5)."""
        scale = GaussianState(mean[-1], covariance[-1]).length_scale
        return cls(mean[:, :3].copy(), covariance[:, :3, :3].copy(), scale, range(len(mean)))

    @classmethod
    def of_segments(cls, segments: Sequence[FilteredSegment], lag_s: float) -> "_Delayed":
        """Begin with the results of the device's own EKF."""
        found = [_with_late_heading(segment, lag_s) for segment in segments]
        smoothed: list[int] = []
        begin = 0
        for segment in segments:
            first = len(segment.nodes) if segment.aligned_from is None else segment.aligned_from
            smoothed += range(begin + first, begin + len(segment.nodes))
            begin += len(segment.nodes)
        pose, covariance = (np.concatenate(parts) for parts in zip(*found, strict=True))
        return cls(pose, covariance, segments[-1].end.length_scale, smoothed)

    def record(self, node: int, found: LaggedPose) -> None:
        """Replace the pose of a node by the smoothed one."""
        self._pose[node], self._covariance[node], self._scale = found.pose, found.covariance, found.scale

    def track(self, timeline: Timeline) -> Track:
        """Return the track of the device."""
        pose = self._pose
        return track_from_nodes(timeline, pose[:, :2], pose[:, 2], self._covariance, "delayed", NAME, self._scale)


def _with_late_heading(segment: FilteredSegment, lag_s: float) -> tuple[Array, Array]:
    """Return filtered poses (n, 3) and covariances (n, 3, 3), reckoned back where the heading is found late."""
    pose, covariance, aligned = segment.pose.copy(), segment.covariance.copy(), segment.aligned_from
    if aligned is None:
        return pose, covariance
    back = reckon(segment.nodes[: aligned + 1], aligned, segment.states[0])
    for i, state in enumerate(back[:-1]):
        if segment.nodes[i].time_s >= segment.nodes[aligned].time_s - lag_s:
            pose[i], covariance[i] = state.mean[:3], state.covariance[:3, :3]
    return pose, covariance
