"""Heading of a step: the mean yaw of the device over the step.

The averaging over two steps in POCKET and the offset compensation of Table V are in `mmpdr_aoc`.

References
----------
MMPDR: Tian et al., IEEE Sensors Journal 2016, section III-E, Table IV.
"""

from dataclasses import replace

import numpy as np

from pdr_est.frames import Array
from pdr_est.types.steps import Step


class StepYaw:
    """Stage Step -> Step that fills in the heading: the device's mean yaw, with an arbitrary zero."""

    latency_s = 0.0

    def push(self, item: Step, /) -> list[Step]:
        """Give a step its heading."""
        return [replace(item, heading_rad=calibrated_mean_yaw(item.samples.yaw_rad))]

    def flush(self) -> list[Step]:
        """Return nothing: no step is held back."""
        return []


def calibrated_mean_yaw(yaw_rad: Array) -> float:
    """Compute the mean of yaw angles without the 180 degree ambiguity.

    The table shifts negative angles by 2 pi before averaging, which moves the cut from +-pi to 0 and fails for a walk
    along yaw 0. Deviation: the shift is used only where the angles straddle +-pi.

    Parameters
    ----------
    yaw_rad : ndarray, shape (n,)
        Angles in (-pi, pi].

    References
    ----------
    MMPDR, Table IV.
    """
    if np.ptp(yaw_rad) <= np.pi:
        return float(np.mean(yaw_rad))
    mean = float(np.mean(np.where(yaw_rad < 0.0, yaw_rad + 2.0 * np.pi, yaw_rad)))
    return mean - 2.0 * np.pi if mean > np.pi else mean
