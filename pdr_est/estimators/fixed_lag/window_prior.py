"""Turn the EKF state at the beginning of a fixed-lag window into prior factors at given length scales."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import gtsam
import numpy as np
from numpy.typing import NDArray

from pdr_est.estimators.common.motion_model import LOG_SCALE, MIN_SIGMA, STATES, GaussianState
from pdr_est.estimators.pose_chains.linear_rows import to_map
from pdr_est.frames import Array

_SOURCE_STATES = 2  # wandering error of a source of fixes, east and north, in standard deviations; no clock here
_PARTS = 4  # states of a device without the length scale: east, north, heading, reference heading
_ANYWHERE_M = 1.0  # sigma of the position of a reference, which has no meaning


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
        firsts = range(_PARTS * self.devices, len(self.mean), _SOURCE_STATES)
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


def prior_factors(
    known: ConditionalPrior, poses: Sequence[int], references: Sequence[int | None], errors: Sequence[int] = ()
) -> Iterator[gtsam.NonlinearFactor]:
    """Yield one conditional factor for each variable, by the chain rule.

    A pose is conditioned on the first device's pose and the one before it, a reference on the pose of its device, a
    wandering error on two of the first two poses and the error before it. Without references this is exact for one
    device with two sources, and for two devices with one.

    Parameters
    ----------
    known
        Gaussian of all devices and sources.
    poses, references
        Keys of each device, whose values must be inserted at the mean; a reference may be None.
    errors
        Keys of the wandering error of each source, likewise.
    """
    at, covariance = gtsam.Values(), _in_own_frames(known)
    for number, (pose, reference) in enumerate(zip(poses, references, strict=True)):
        at.insert(pose, gtsam.Pose2(*known.mean[_PARTS * number : _PARTS * number + 3]))
        if reference is not None:
            at.insert(reference, gtsam.Pose2(0.0, 0.0, known.mean[_PARTS * number + 3]))
    for error, rows in zip(errors, known.of_sources, strict=True):
        at.insert(error, known.mean[rows])
    of_poses = [_PARTS * number + np.arange(3) for number in range(len(poses))]
    for number, (pose, reference) in enumerate(zip(poses, references, strict=True)):
        given = sorted({0, number - 1} - {number, -1})
        rows_then = [of_poses[number], *(of_poses[other] for other in given)]
        keys = [pose, *(poses[other] for other in given)]
        yield gtsam.LinearContainerFactor(_conditional(covariance, keys, rows_then), at)
        if reference is not None:
            place = np.array([_ANYWHERE_M, _ANYWHERE_M, 1e3])
            pose_at = gtsam.Pose2(0.0, 0.0, known.mean[_PARTS * number + 3])
            yield gtsam.PriorFactorPose2(reference, pose_at, gtsam.noiseModel.Diagonal.Sigmas(place))
            rows_then = [np.array([_PARTS * number + 3]), of_poses[number]]
            yield gtsam.LinearContainerFactor(_conditional(covariance, [reference, pose], rows_then), at)
    before = list(zip(poses, of_poses, strict=True))[:2]
    for error, rows in zip(errors, known.of_sources, strict=True):
        keys, rows_then = [error, *(key for key, _ in before)], [rows, *(of_key for _, of_key in before)]
        yield gtsam.LinearContainerFactor(_conditional(covariance, keys, rows_then), at)
        before = [before[0], (error, rows)]


def _in_own_frames(known: ConditionalPrior) -> Array:
    """Rotate the covariance so that positions are in the frames of the poses, as GTSAM expects."""
    covariance = known.covariance + MIN_SIGMA**2 * np.eye(len(known.mean))
    turn = np.eye(len(known.mean))
    for first in range(0, _PARTS * known.devices, _PARTS):
        turn[first : first + 3, first : first + 3] = to_map(known.mean[first + 2 : first + 3])[0].T
    return np.asarray(turn @ covariance @ turn.T)


def _conditional(covariance: Array, keys: Sequence[int], rows: Sequence[Any]) -> gtsam.JacobianFactor:
    """Condition the first variable on the others; rows index each in the covariance, a single row is a rotation."""
    own, others = rows[0], np.concatenate([*rows[1:], np.zeros(0, dtype=np.intp)]).astype(np.intp)
    gain = np.linalg.solve(covariance[np.ix_(others, others)], covariance[np.ix_(others, own)]).T
    spread = covariance[np.ix_(own, own)] - gain @ covariance[np.ix_(others, own)]
    variance, axes = np.linalg.eigh(0.5 * (spread + spread.T))
    whiten = (axes / np.sqrt(np.maximum(variance, MIN_SIGMA**2))).T
    ends = np.cumsum([len(one) for one in rows[1:-1]])
    blocks = [whiten, *np.split(-whiten @ gain, ends, axis=1)] if len(rows) > 1 else [whiten]
    if len(own) == 1:
        blocks[0] = np.concatenate([np.zeros((1, 2)), blocks[0]], axis=1)
    pairs = [part for key, block in zip(keys, blocks, strict=True) for part in (key, block)]
    arguments: list[Any] = [*pairs, np.zeros(len(own)), gtsam.noiseModel.Unit.Create(len(own))]
    factor: gtsam.JacobianFactor = gtsam.JacobianFactor(*arguments)
    return factor
