"""Dead reckoning: MMPDR eq. 1 step by step, with a covariance that grows as the motion model says."""

import numpy as np

from pdr_est.estimators.ekf import run_filter, smooth, undecided_anchor
from pdr_est.estimators.motion import Moments, reckon
from pdr_est.estimators.start import start_prior
from pdr_est.estimators.timeline import Timeline, track_from_nodes
from pdr_est.records import StartPose
from pdr_est.track import Track

NAME = "dead-reckoning"


def estimate(timeline: Timeline, start: StartPose, sigma_length_scale: float) -> Track:
    """Track from the start pose and the odometry alone.

    Fixes and heading priors serve for one thing: where the start is not given, they find position and direction of
    one pose, and the others are reckoned from it, forwards and backwards. After that they are ignored.
    """
    states = _states(timeline, start, sigma_length_scale)
    mean = np.array([state.mean for state in states])
    covariance = np.array([state.covariance[:3, :3] for state in states])
    scale = (float(mean[-1, 3]), float(np.sqrt(states[-1].covariance[3, 3])))
    return track_from_nodes(timeline, mean[:, :2], mean[:, 2], covariance, "filtered", NAME, scale)


def _states(timeline: Timeline, start: StartPose, sigma_length_scale: float) -> list[Moments]:
    nodes, prior = timeline.nodes, start_prior(timeline, start)
    if not prior.heading_open and not prior.position_open:
        return reckon(nodes, 0, prior.moments(sigma_length_scale))
    filtered = run_filter(timeline, start, sigma_length_scale)
    if filtered.aligned_from is None:
        return reckon(nodes, *undecided_anchor(timeline, filtered, sigma_length_scale))
    first_fix = next((i for i, node in enumerate(nodes) if node.fixes), 0)
    anchor = max(filtered.aligned_from, first_fix if prior.position_open else 0)
    onwards = reckon(nodes[anchor:], 0, filtered.moments[anchor - filtered.aligned_from])
    if prior.heading_open:
        return reckon(nodes[: anchor + 1], anchor, onwards[0])[:-1] + onwards
    # One fix can correct the position of a walk but not bend it: the smoother gives the same poses, and exactly what
    # is known of those before the fix.
    return smooth(nodes[: anchor + 1], filtered.moments[: anchor + 1])[:-1] + onwards
