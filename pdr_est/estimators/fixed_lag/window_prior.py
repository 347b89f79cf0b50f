"""Turn the EKF state at the beginning of a fixed-lag window into prior factors at given length scales."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import gtsam
import numpy as np

from pdr_est.estimators.common.motion_model import LOG_SCALE, STATES, GaussianState
from pdr_est.estimators.factor_graph.factors import MIN_SIGMA
from pdr_est.estimators.factor_graph.marginals import to_map
from pdr_est.frames import Array

_PARTS = 4  # states of a device without the length scale: east, north, heading, reference heading
_ANYWHERE_M = 1.0  # sigma of the position of a reference, which has no meaning


@dataclass(frozen=True)
class ConditionalPrior:
    """Gaussian of east, north, heading and reference heading of d devices, given their length scales.

    Attributes
    ----------
    mean : Array
        Mean, (4 d,), m and rad.
    covariance : Array
        Covariance, (4 d, 4 d).
    """

    mean: Array
    covariance: Array

    @classmethod
    def of_filter(cls, mean: Array, covariance: Array, scale: Array, devices: Sequence[int]) -> "ConditionalPrior":
        """Condition the EKF state (5 n,) of some devices on given length scales (n,)."""
        others = [STATES * d + i for d in devices for i in range(STATES) if i != LOG_SCALE]
        of_scales = [STATES * d + LOG_SCALE for d in devices]
        across = covariance[np.ix_(others, of_scales)]
        gain = across @ np.linalg.pinv(covariance[np.ix_(of_scales, of_scales)], hermitian=True)
        moved = gain @ (np.log(scale[list(devices)]) - mean[of_scales])
        return cls(mean[others] + moved, covariance[np.ix_(others, others)] - gain @ across.T)


def of_entering(state: GaussianState, scale: float) -> ConditionalPrior:
    """Condition the EKF state of one device on its length scale."""
    return ConditionalPrior.of_filter(state.mean, state.covariance, np.array([scale]), [0])


def device_state(mean: Array, covariance: Array, device: int) -> GaussianState:
    """Return the marginal state of one device from the joint EKF state."""
    own = slice(STATES * device, STATES * (device + 1))
    return GaussianState(mean[own], covariance[own, own])


def scales(mean: Array) -> Array:
    """Return the length scales (n,) in the mean (5 n,) of the EKF."""
    return np.exp(mean[LOG_SCALE::STATES])


def pose_per_scale(covariance: Array, device: int) -> Array:
    """Return the regression (3,) of the pose of a device on its length scale; zero for a known scale."""
    first = STATES * device
    variance = covariance[first + LOG_SCALE, first + LOG_SCALE]
    if variance <= 0.0:
        return np.zeros(3)
    return np.asarray(covariance[first : first + 3, first + LOG_SCALE] / variance)


def prior_factors(
    known: ConditionalPrior, poses: Sequence[int], references: Sequence[int | None]
) -> Iterator[gtsam.NonlinearFactor]:
    """Yield one conditional factor for each variable, by the chain rule.

    A pose is conditioned on the first device's pose and the one before it, a reference on the pose of its device. For
    two devices without references this is exact.

    Parameters
    ----------
    known
        Gaussian of all devices.
    poses, references
        Keys of each device, whose values must be inserted at the mean; a reference may be None.
    """
    at, covariance = gtsam.Values(), _in_own_frames(known)
    for number, (pose, reference) in enumerate(zip(poses, references, strict=True)):
        at.insert(pose, gtsam.Pose2(*known.mean[_PARTS * number : _PARTS * number + 3]))
        if reference is not None:
            at.insert(reference, gtsam.Pose2(0.0, 0.0, known.mean[_PARTS * number + 3]))
    for number, (pose, reference) in enumerate(zip(poses, references, strict=True)):
        given = sorted({0, number - 1} - {number, -1})
        rows = [_PARTS * number + np.arange(3), *(_PARTS * other + np.arange(3) for other in given)]
        keys = [pose, *(poses[other] for other in given)]
        yield gtsam.LinearContainerFactor(_conditional(covariance, keys, rows), at)
        if reference is not None:
            place = np.array([_ANYWHERE_M, _ANYWHERE_M, 1e3])
            pose_at = gtsam.Pose2(0.0, 0.0, known.mean[_PARTS * number + 3])
            yield gtsam.PriorFactorPose2(reference, pose_at, gtsam.noiseModel.Diagonal.Sigmas(place))
            rows = [np.array([_PARTS * number + 3]), _PARTS * number + np.arange(3)]
            yield gtsam.LinearContainerFactor(_conditional(covariance, [reference, pose], rows), at)


def _in_own_frames(known: ConditionalPrior) -> Array:
    """Rotate the covariance so that positions are in the frames of the poses, as GTSAM expects."""
    covariance = known.covariance + MIN_SIGMA**2 * np.eye(len(known.mean))
    turn = np.eye(len(known.mean))
    for first in range(0, len(known.mean), _PARTS):
        turn[first : first + 3, first : first + 3] = to_map(known.mean[first + 2 : first + 3])[0].T
    return np.asarray(turn @ covariance @ turn.T)


def _conditional(covariance: Array, keys: Sequence[int], rows: Sequence[Any]) -> gtsam.JacobianFactor:
    """Condition the first variable on the others; rows index each in the covariance, a single row is a rotation."""
    own, others = rows[0], np.concatenate([*rows[1:], np.zeros(0, dtype=np.intp)]).astype(np.intp)
    gain = np.linalg.solve(covariance[np.ix_(others, others)], covariance[np.ix_(others, own)]).T
    spread = covariance[np.ix_(own, own)] - gain @ covariance[np.ix_(others, own)]
    variance, axes = np.linalg.eigh(0.5 * (spread + spread.T))
    whiten = (axes / np.sqrt(np.maximum(variance, MIN_SIGMA**2))).T
    blocks = [whiten, *np.split(-whiten @ gain, len(rows) - 1, axis=1)] if len(rows) > 1 else [whiten]
    if len(own) == 1:
        blocks[0] = np.concatenate([np.zeros((1, 2)), blocks[0]], axis=1)
    pairs = [part for key, block in zip(keys, blocks, strict=True) for part in (key, block)]
    arguments: list[Any] = [*pairs, np.zeros(len(own)), gtsam.noiseModel.Unit.Create(len(own))]
    factor: gtsam.JacobianFactor = gtsam.JacobianFactor(*arguments)
    return factor
