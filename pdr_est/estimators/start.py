"""What is known of the pose at the start, the same for every estimator."""

from dataclasses import dataclass

import numpy as np

from pdr_est.estimators.motion import Moments
from pdr_est.estimators.timeline import Timeline
from pdr_est.frames import Array
from pdr_est.records import StartPose

UNKNOWN_SIGMA_M = 1e3  # of an unknown position around the first fix
UNKNOWN_SIGMA_RAD = float(np.pi / np.sqrt(3.0))  # standard deviation of a uniform direction


@dataclass(frozen=True)
class StartPrior:
    """Prior of the pose at the start. mean, sigma: (3,) of east m, north m, heading rad.

    position_open, heading_open: to be found from the measurements. The mean of an open position is the first fix,
    that of an open heading is without meaning.
    """

    mean: Array
    sigma: Array
    position_open: bool
    heading_open: bool

    def moments(self, sigma_length_scale: float) -> Moments:
        """The prior of the whole state."""
        sigma = np.array([*self.sigma, sigma_length_scale])
        return Moments(np.array([*self.mean, 1.0]), np.diag(sigma**2))


def start_prior(timeline: Timeline, start: StartPose) -> StartPrior:
    """The given start; unknown parts are open if measurements can tell them, else they define the frame as zero."""
    fixes = timeline.fixes
    position_open = start.position_m is None and bool(fixes)
    heading_open = start.heading_rad is None and bool(fixes or timeline.priors)
    mean, sigma = np.zeros(3), np.zeros(3)
    if start.position_m is not None:
        mean[:2], sigma[:2] = start.position_m, start.sigma_position_m
    elif position_open:
        mean[:2], sigma[:2] = fixes[0].position_m, UNKNOWN_SIGMA_M
    if start.heading_rad is not None:
        mean[2], sigma[2] = start.heading_rad, start.sigma_heading_rad
    elif heading_open:
        sigma[2] = UNKNOWN_SIGMA_RAD
    return StartPrior(mean, sigma, position_open, heading_open)
