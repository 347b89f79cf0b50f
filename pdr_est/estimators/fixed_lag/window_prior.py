"""Turn the EKF state at the beginning of a fixed-lag window into a prior at given length scales."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pdr_est.estimators.common.motion_model import LOG_SCALE, MIN_SIGMA, STATES, GaussianState
from pdr_est.frames import Array

_SOURCE_STATES = 2  # wandering error of a source of fixes, east and north, in standard deviations; no clock here

PARTS = 4
"""States of a device without the length scale: east, north, heading, reference heading."""


@dataclass(frozen=True)
class ConditionalPrior:
    """Gaussian of east, north, heading and reference heading of d devices, given their length scales.

    The wandering errors of s sources of fixes follow, east and north.

    Attributes
    ----------
    mean : Array
        Mean, (4 d + 2 s,), m and rad.
    covariance : Array
        Covariance, (4 d + 2 s, 4 d + 2 s).
    devices : int
        Number of devices.
    """

    mean: Array
    covariance: Array
    devices: int

    @classmethod
    def of_filter(cls, mean: Array, covariance: Array, scale: Array, devices: Sequence[int]) -> "ConditionalPrior":
        """Condition the EKF state of some of n devices and of all sources on given length scales (n,)."""
        others = [STATES * d + i for d in devices for i in range(STATES) if i != LOG_SCALE]
        others += range(STATES * len(scale), len(mean))
        of_scales = [STATES * d + LOG_SCALE for d in devices]
        across = covariance[np.ix_(others, of_scales)]
        gain = across @ np.linalg.pinv(covariance[np.ix_(of_scales, of_scales)], hermitian=True)
        moved = gain @ (np.log(scale[list(devices)]) - mean[of_scales])
        return cls(mean[others] + moved, covariance[np.ix_(others, others)] - gain @ across.T, len(devices))

    @property
    def of_sources(self) -> list[NDArray[np.intp]]:
        """Rows (2,) of the wandering error of each source."""
        firsts = range(PARTS * self.devices, len(self.mean), _SOURCE_STATES)
        return [first + np.arange(_SOURCE_STATES) for first in firsts]


def of_entering(state: GaussianState, scale: float) -> ConditionalPrior:
    """Condition the EKF state of one device on its length scale."""
    own = device_state(state.mean, state.covariance, 0)
    return ConditionalPrior.of_filter(own.mean, own.covariance, np.array([scale]), [0])


def device_state(mean: Array, covariance: Array, device: int) -> GaussianState:
    """Return the marginal state of one device from the joint EKF state."""
    own = slice(STATES * device, STATES * (device + 1))
    return GaussianState(mean[own], covariance[own, own])


def log_scales(mean: Array, covariance: Array, sources: int) -> tuple[Array, Array]:
    """Return the logarithms (d,) of the length scales in the EKF state, and their standard deviations."""
    own = slice(LOG_SCALE, len(mean) - _SOURCE_STATES * sources, STATES)
    return mean[own], np.sqrt(np.maximum(np.diag(covariance)[own], 0.0))


def pose_per_scale(covariance: Array, device: int) -> Array:
    """Return the regression (3,) of the pose of a device on the log of its length scale, zero for a known scale."""
    first = STATES * device
    variance = covariance[first + LOG_SCALE, first + LOG_SCALE]
    if variance <= 0.0:
        return np.zeros(3)
    return np.asarray(covariance[first : first + 3, first + LOG_SCALE] / variance)


def whitening_of(known: ConditionalPrior, kept: Sequence[int]) -> Array:
    """Return the matrix (k, k) that turns changes of some of the variables of a prior into standard deviations.

    The variables that are not kept are marginalised.
    """
    covariance = known.covariance[np.ix_(kept, kept)] + MIN_SIGMA**2 * np.eye(len(kept))
    return np.asarray(np.linalg.inv(np.linalg.cholesky(covariance)))
