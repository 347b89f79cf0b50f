"""What is known of the pose at the start, the same for every estimator."""

from dataclasses import dataclass

import numpy as np

from pdr_est.estimators.common.motion_model import GaussianState
from pdr_est.estimators.common.timeline import Node, Timeline
from pdr_est.types.measurements import StartPose

UNKNOWN_SIGMA_M = 1e3  # of an unknown position around the first fix
VAGUE_SIGMA_RAD = 30.0  # so wide that its centre does not matter
UNKNOWN_SIGMA_RAD = float(np.pi / np.sqrt(3.0))  # standard deviation of a uniform direction


@dataclass(frozen=True)
class StartPrior:
    """Prior of the state at the start of a walk, or of the rest of a walk after its direction was lost.

    position_open, heading_open: to be found from the measurements. The mean of an open position is the first fix,
    that of an open heading is without meaning.
    """

    moments: GaussianState
    position_open: bool
    heading_open: bool


def start_prior(timeline: Timeline, start: StartPose, sigma_length_scale: float) -> StartPrior:
    """The given start; unknown parts are open if measurements can tell them, else they define the frame as zero."""
    fixes = timeline.fixes
    position_open = start.position_m is None and bool(fixes)
    heading_open = start.heading_rad is None and any(node.tells_direction for node in timeline.nodes)
    mean = np.array([0.0, 0.0, 0.0, 1.0, 0.0])
    sigma = np.array([0.0, 0.0, 0.0, sigma_length_scale, VAGUE_SIGMA_RAD])
    if start.position_m is not None:
        mean[:2], sigma[:2] = start.position_m, start.sigma_position_m
    elif position_open:
        mean[:2], sigma[:2] = fixes[0].position_m, UNKNOWN_SIGMA_M
    if start.heading_rad is not None:
        mean[2], sigma[2] = start.heading_rad, start.sigma_heading_rad
    elif heading_open:
        sigma[2] = UNKNOWN_SIGMA_RAD
    return StartPrior(GaussianState(mean, np.diag(sigma**2)), position_open, heading_open)


def prior_after_lost_turn(before: GaussianState, node: Node) -> StartPrior:
    """The state at `node` after a motion in any direction, whose turn leaves nothing of the heading."""
    reach = 0.5 * (node.length_m**2 + node.covariance[0, 0] + node.covariance[1, 1])
    covariance = np.diag([reach, reach, UNKNOWN_SIGMA_RAD**2, *np.diag(before.covariance)[3:]])
    covariance[:2, :2] += before.covariance[:2, :2]
    return StartPrior(GaussianState(before.mean, covariance), position_open=False, heading_open=True)
