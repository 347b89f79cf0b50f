"""Cutting the motion of a step in two or more, so that fixes within it meet the walker on the way."""

from collections.abc import Sequence

import numpy as np

from pdr_est.frames import Array


def split_covariance(covariance: Array, length_m: float, shares: Sequence[float]) -> list[Array]:
    """Covariances of the parts of a step, each (3, 3) of (forward, left, heading) at the end of its part.

    covariance: of the whole step, likewise; shares: of the length, they add up to 1. One after the other, the parts
    give exactly the mean and the covariance of the whole. The walker turns at the beginning, so the heading error
    arises in the first part and carries the displacement along; what remains of the noise is spread evenly. Later
    parts are therefore without heading noise, and singular.
    """
    if len(shares) == 1:
        return [covariance]
    heading = covariance[2, 2]
    with_heading = covariance[:2, 2] / heading if heading > 0.0 else np.zeros(2)
    of_displacement = covariance[:2, :2] - heading * np.outer(with_heading, with_heading)
    parts = []
    for share in shares:
        part = np.zeros((3, 3))
        part[:2, :2] = share * of_displacement
        parts.append(part)
    still_to_come = (1.0 - shares[0]) * length_m  # will swing to the left by this much per radian
    error = np.array([with_heading[0], with_heading[1] - still_to_come, 1.0])
    parts[0] += heading * np.outer(error, error)
    return parts
