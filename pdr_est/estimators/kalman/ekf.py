"""Estimator `ekf`: filtered tracks of all devices on one body."""

from collections.abc import Sequence

import numpy as np

from pdr_est.estimators.common.initial_state import starts_of
from pdr_est.estimators.common.motion_model import GaussianState
from pdr_est.estimators.common.tethers import node_tethers_between
from pdr_est.estimators.common.timeline import Timeline, track_from_nodes
from pdr_est.estimators.kalman.known_heading import KnownHeadings, known_headings
from pdr_est.estimators.kalman.offline_filter import FilteredSegment, JointPosterior, filter_walk, run_filter
from pdr_est.types.measurements import DeviceTether, StartPose
from pdr_est.types.track import Track, concatenate

NAME = "ekf"


def estimate(
    timelines: Sequence[Timeline], tethers: Sequence[DeviceTether], start: StartPose, sigma_length_scale: float
) -> Track:
    """Estimate the filtered tracks of all devices: each pose from the measurements of all devices up to its time.

    Parameters
    ----------
    timelines
        Measurements of each device.
    tethers
        Tethers between the devices; a single device has none.
    start
        Start pose of the walk as far as it is known.
    sigma_length_scale
        Standard deviation of the walker's length scale around 1.

    Raises
    ------
    EstimationError
        For devices of the same name, and for a tether to a device without timeline.
    """
    starts = starts_of(timelines, start)
    if len(timelines) == 1:
        segments = [run_filter(timelines[0], starts[0], sigma_length_scale)]
        return _track_of_segments(timelines, segments, ())
    node_tethers = node_tethers_between(timelines, tethers)
    # With three devices, a pose may be older than the tethers between the two others at its time.
    known = known_headings(timelines, node_tethers, starts, sigma_length_scale) if len(timelines) == 2 else None
    if known is not None:
        return _track_of_known(known, timelines)
    walk = filter_walk(timelines, node_tethers, starts, sigma_length_scale)
    return _track_of_segments(timelines, walk.segments, walk.posteriors)


def _track_of_segments(
    timelines: Sequence[Timeline], filtered: Sequence[Sequence[FilteredSegment]], posteriors: Sequence[JointPosterior]
) -> Track:
    """Make the filtered track from the segments of each device, and the joint posteriors where there are any."""
    poses = [np.concatenate([segment.pose for segment in segments]) for segments in filtered]
    covariances = [np.concatenate([segment.covariance for segment in segments]) for segments in filtered]
    scales = [segments[-1].end.length_scale for segments in filtered]
    for posterior in posteriors:
        for (device, node), state in zip(posterior.touched, posterior.states, strict=True):
            poses[device][node], covariances[device][node] = state.mean[:3], state.covariance[:3, :3]
            scales[device] = state.length_scale
    tracks = [
        track_from_nodes(timeline, pose[:, :2], pose[:, 2], covariance, "filtered", NAME, scale)
        for timeline, pose, covariance, scale in zip(timelines, poses, covariances, scales, strict=True)
    ]
    return concatenate(tracks)


def _track_of_known(known: KnownHeadings, timelines: Sequence[Timeline]) -> Track:
    """Make the filtered track from joint states."""
    tracks = []
    for timeline, (mean, covariance) in zip(timelines, known.filtered(timelines), strict=True):
        scale = GaussianState(mean[-1], covariance[-1]).length_scale
        pose, spread = mean[:, :3], covariance[:, :3, :3]
        tracks.append(track_from_nodes(timeline, pose[:, :2], pose[:, 2], spread, "filtered", NAME, scale))
    return concatenate(tracks)
