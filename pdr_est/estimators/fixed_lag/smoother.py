"""Smoothing with a fixed delay in GTSAM's IncrementalFixedLagSmoother: each pose from what came up to a lag after.

The factors are those of the batch graph. The walker's length scale would tie one variable to every step, so it comes
from the filter that runs beside the smoother: steps have the scale that the filter believes in, and what the filter
knows of pose and scale together gives the share of the covariance that the scale adds. When the filter changes its
mind, the window is built anew at the new scale, from the filter's state where the window begins.

The smoother makes one Gauss-Newton step an update and would ignore a kernel with a dead zone; a tether is therefore a
plain distance, added only where the poses are predicted to be further apart than it allows.
"""

from collections.abc import Iterator, Sequence

import numpy as np

from pdr_est.estimators.common.initial_state import starts_of
from pdr_est.estimators.common.motion_model import reckon
from pdr_est.estimators.common.tethers import node_tethers_between
from pdr_est.estimators.common.timeline import Timeline, track_from_nodes
from pdr_est.estimators.fixed_lag.params import FixedLagParams
from pdr_est.estimators.fixed_lag.window import FilteredNode, LaggedPose, LagWindow, Limit
from pdr_est.estimators.kalman.walk_filter import FilteredSegment, FilteredWalk, filter_walk
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
    """Delayed tracks of all devices: each pose from the measurements up to lag_s after it.

    Where the direction of a device is open for longer than the lag, its poses are those of the filter. Raises
    EstimationError if GTSAM finds a window indeterminate, or tethers do not fit the devices.
    """
    node_tethers, starts = node_tethers_between(timelines, tethers), starts_of(timelines, start)
    walk = filter_walk(timelines, node_tethers, starts, sigma_length_scale)
    tracks = [_Delayed(stretches, parameters.lag_s) for stretches in walk.segments]
    window, numbers = LagWindow(parameters), [iter(track.followed) for track in tracks]
    for item in _followed(timelines, walk):
        for ready in window.push(item):
            tracks[ready.device].record(next(numbers[ready.device]), ready)
    for ready in window.flush():
        tracks[ready.device].record(next(numbers[ready.device]), ready)
    return concatenate([track.track(timeline) for track, timeline in zip(tracks, timelines, strict=True)])


def _followed(timelines: Sequence[Timeline], walk: FilteredWalk) -> Iterator[FilteredNode]:
    present: frozenset[int] = frozenset()
    for moment in walk.posteriors:
        device, node = moment.touched[0]
        present |= {device}
        limits = tuple(
            Limit(node_tether.device_a, node_tether.device_b, node_tether.max_distance_m, node_tether.sigma_m)
            for node_tether in moment.node_tethers
        )
        yield FilteredNode(
            device, timelines[device].nodes[node], moment.entered, limits, moment.mean, moment.covariance, present
        )


class _Delayed:
    """The poses of one device: those of its own filter until the smoother gives them. followed: numbers of the nodes
    that the smoother gives."""

    def __init__(self, stretches: Sequence[FilteredSegment], lag_s: float) -> None:
        self._pose = np.concatenate([_known_later(stretch, lag_s)[0] for stretch in stretches])
        self._covariance = np.concatenate([_known_later(stretch, lag_s)[1] for stretch in stretches])
        self._scale = stretches[-1].end.length_scale
        self.followed: list[int] = []
        begin = 0
        for stretch in stretches:
            first = len(stretch.nodes) if stretch.aligned_from is None else stretch.aligned_from
            self.followed += range(begin + first, begin + len(stretch.nodes))
            begin += len(stretch.nodes)

    def record(self, node: int, found: LaggedPose) -> None:
        self._pose[node], self._covariance[node], self._scale = found.pose, found.covariance, found.scale

    def track(self, timeline: Timeline) -> Track:
        pose = self._pose
        return track_from_nodes(timeline, pose[:, :2], pose[:, 2], self._covariance, "delayed", NAME, self._scale)


def _known_later(stretch: FilteredSegment, lag_s: float) -> tuple[Array, Array]:
    """Filtered poses (n, 3) and covariances (n, 3, 3); where the direction became known within the lag, those that
    lead there."""
    pose, covariance, aligned = stretch.pose.copy(), stretch.covariance.copy(), stretch.aligned_from
    if aligned is None:
        return pose, covariance
    back = reckon(stretch.nodes[: aligned + 1], aligned, stretch.states[0])
    for i, state in enumerate(back[:-1]):
        if stretch.nodes[i].time_s >= stretch.nodes[aligned].time_s - lag_s:
            pose[i], covariance[i] = state.mean[:3], state.covariance[:3, :3]
    return pose, covariance
