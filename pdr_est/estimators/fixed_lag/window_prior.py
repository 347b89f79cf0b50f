"""What the filter knows where a window of the fixed-lag smoother begins, as factors at given length scales."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import gtsam
import numpy as np

from pdr_est.estimators.common.motion_model import LENGTH_SCALE, STATES, GaussianState
from pdr_est.estimators.factor_graph.factors import MIN_SIGMA
from pdr_est.estimators.factor_graph.marginals import to_map
from pdr_est.frames import Array

_PARTS = 4  # of a device's state without it: east, north, heading, reference direction
_ANYWHERE_M = 1.0  # sigma of where a reference is, which is of no meaning


@dataclass(frozen=True)
class ConditionalPrior:
    """Mean (4 d,) and covariance (4 d, 4 d) of east, north, heading and reference of some devices, given the length
    scales."""

    mean: Array
    covariance: Array

    @classmethod
    def of_filter(cls, mean: Array, covariance: Array, scale: Array, devices: Sequence[int]) -> "ConditionalPrior":
        """From a filter's state (5 n,): what it says of some devices if the scales (n,) are these."""
        others = [STATES * d + i for d in devices for i in range(STATES) if i != LENGTH_SCALE]
        of_scales = [STATES * d + LENGTH_SCALE for d in devices]
        across = covariance[np.ix_(others, of_scales)]
        gain = across @ np.linalg.pinv(covariance[np.ix_(of_scales, of_scales)], hermitian=True)
        moved = gain @ (scale[list(devices)] - mean[of_scales])
        return cls(mean[others] + moved, covariance[np.ix_(others, others)] - gain @ across.T)


def of_entering(moments: GaussianState, scale: float) -> ConditionalPrior:
    """From the state of one device."""
    return ConditionalPrior.of_filter(moments.mean, moments.covariance, np.array([scale]), [0])


def scales(mean: Array) -> Array:
    """The length scales (n,) in a filter's state (5 n,)."""
    return mean[LENGTH_SCALE::STATES].copy()


def pose_per_scale(covariance: Array, device: int) -> Array:
    """How the pose (3,) of a device moves with its length scale, by a filter's covariance; zero for a known scale."""
    first = STATES * device
    variance = covariance[first + LENGTH_SCALE, first + LENGTH_SCALE]
    if variance <= 0.0:
        return np.zeros(3)
    return np.asarray(covariance[first : first + 3, first + LENGTH_SCALE] / variance)


def prior_factors(
    known: ConditionalPrior, poses: Sequence[int], references: Sequence[int | None]
) -> Iterator[gtsam.NonlinearFactor]:
    """One factor a variable, by the chain rule: a pose given the first device's and the one's before it, a reference
    given its device's pose. For two devices without references that is all that is known.

    poses, references: keys, for which values are to be set at the mean.
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
    """The covariance with positions in the poses' own frames, in which GTSAM counts."""
    covariance = known.covariance + MIN_SIGMA**2 * np.eye(len(known.mean))
    turn = np.eye(len(known.mean))
    for first in range(0, len(known.mean), _PARTS):
        turn[first : first + 3, first : first + 3] = to_map(known.mean[first + 2 : first + 3])[0].T
    return np.asarray(turn @ covariance @ turn.T)


def _conditional(covariance: Array, keys: Sequence[int], rows: Sequence[Any]) -> gtsam.JacobianFactor:
    """The first variable given the others. rows: of each in the covariance; a single one is a rotation."""
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
