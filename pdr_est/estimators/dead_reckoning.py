"""Dead reckoning: MMPDR eq. 1 step by step, with a covariance that grows as the motion model says."""

import numpy as np

from pdr_est.estimators.ekf import find_start
from pdr_est.estimators.motion import advance
from pdr_est.estimators.timeline import Timeline, track_from_nodes
from pdr_est.records import StartPose
from pdr_est.track import Track

NAME = "dead-reckoning"


def estimate(timeline: Timeline, start: StartPose, sigma_length_scale: float) -> Track:
    """Track from the start pose and the odometry alone.

    Fixes serve for one thing: to find the start where it is not given. After that they are ignored.
    """
    states = [find_start(timeline, start, sigma_length_scale)]
    for node in timeline.nodes[1:]:
        states.append(advance(states[-1], node))
    mean = np.array([state.mean for state in states])
    covariance = np.array([state.covariance[:3, :3] for state in states])
    scale = (float(mean[-1, 3]), float(np.sqrt(states[-1].covariance[3, 3])))
    return track_from_nodes(timeline, mean[:, :2], mean[:, 2], covariance, "filtered", NAME, scale)
