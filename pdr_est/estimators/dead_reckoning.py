"""Dead reckoning: apply MMPDR eq. 1 step by step, with the covariance of the motion model."""

import numpy as np

from pdr_est.estimators.common.initial_state import start_prior
from pdr_est.estimators.common.motion_model import GaussianState, reckon
from pdr_est.estimators.common.timeline import Timeline, track_from_nodes
from pdr_est.estimators.kalman.offline_filter import FilteredSegment, run_filter
from pdr_est.estimators.kalman.rts_smoother import smooth
from pdr_est.types.measurements import StartPose
from pdr_est.types.track import Track

NAME = "dead-reckoning"


def estimate(timeline: Timeline, start: StartPose, sigma_length_scale: float) -> Track:
    """Estimate the track of a device from the start pose and the odometry alone.

    Fixes and heading priors are used for one thing only: where the start is not given, they determine position and
    heading of one pose, and the other poses are dead-reckoned from it, forwards and backwards.

    Parameters
    ----------
    timeline
        Measurements of the device.
    start
        Start pose as far as it is known.
    sigma_length_scale
        Standard deviation of the walker's length scale around 1.
    """
    states = _states(timeline, start, sigma_length_scale)
    mean = np.array([state.mean for state in states])
    covariance = np.array([state.covariance[:3, :3] for state in states])
    scale = states[-1].length_scale
    return track_from_nodes(timeline, mean[:, :2], mean[:, 2], covariance, "filtered", NAME, scale)


def _states(timeline: Timeline, start: StartPose, sigma_length_scale: float) -> list[GaussianState]:
    """Dead-reckon the states at all nodes."""
    prior = start_prior(timeline, start, sigma_length_scale)
    if not prior.heading_open and not prior.position_open:
        return reckon(timeline.nodes, 0, prior.state)
    segments = run_filter(timeline, start, sigma_length_scale)
    before = 0
    for segment in segments:
        anchor = _anchor(segment, prior.position_open)
        if anchor is not None and before == 0 and not prior.heading_open:
            # One fix can shift a walk but not bend it: the smoother gives the same poses as dead reckoning, and the
            # exact covariances of the poses before the fix.
            earlier = smooth(segment.nodes[: anchor + 1], segment.states[: anchor + 1])[:-1]
            return earlier + reckon(timeline.nodes[anchor:], 0, segment.states[anchor])
        if anchor is not None:
            return reckon(timeline.nodes, before + anchor, segment.states[anchor - (segment.aligned_from or 0)])
        before += len(segment.nodes)
    return reckon(timeline.nodes, *segments[0].open_anchor())


def _anchor(segment: FilteredSegment, position_open: bool) -> int | None:
    """Find the first node of a segment whose position and heading are known."""
    if segment.aligned_from is None:
        return None
    if not position_open:
        return segment.aligned_from
    fixed = next((i for i, node in enumerate(segment.nodes) if node.fixes), None)
    return None if fixed is None else max(segment.aligned_from, fixed)
