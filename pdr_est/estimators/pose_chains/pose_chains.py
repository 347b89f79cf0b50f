"""Poses of all devices of a walk, with the residuals of everything that is measured but tethers."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from pdr_est.estimators.common.initial_state import VAGUE_SIGMA_RAD, start_prior
from pdr_est.estimators.common.motion_model import MIN_SIGMA, GaussianState, regular_covariances
from pdr_est.estimators.common.timeline import Timeline
from pdr_est.estimators.pose_chains.linear_rows import LinearRows
from pdr_est.estimators.pose_chains.residuals import (
    MapHeadings,
    MapPositions,
    PosePriors,
    RelativePoses,
    Residuals,
    motions,
)
from pdr_est.frames import Array
from pdr_est.types.measurements import HeadingPrior, StartPose

_FREE_POSITION_M = 1e6  # standard deviation of a position that a residual does not constrain


@dataclass(frozen=True)
class PoseChains:
    """Residuals of a walk.

    Attributes
    ----------
    timelines
        Measurements of each device.
    first
        Number of the first pose of each device.
    anchors
        Residuals of starts, references, heading priors and fixes.
    whitening
        For each device the matrices (n - 1, 3, 3) that turn errors of the motions into standard deviations.
    """

    timelines: tuple[Timeline, ...]
    first: tuple[int, ...]
    anchors: tuple[Residuals, ...]
    whitening: tuple[Array, ...] = field(repr=False)

    @classmethod
    def of_timelines(
        cls,
        timelines: Sequence[Timeline],
        first: Sequence[int],
        references: Sequence[int | None],
        starts: Sequence[StartPose],
        initial: Sequence[Sequence[GaussianState]],
    ) -> "PoseChains":
        """Make the residuals of walks that are not closed, and whose fixes have no wandering errors.

        Parameters
        ----------
        timelines, starts
            Measurements and start pose of each device.
        first, references
            Number of the first pose of each device, and of its reference, a pose behind all others.
        initial
            Initial states at the nodes of each device. The first heading of a device is used where its start heading
            is unknown, the last reference direction as the mean of its vague prior.
        """
        priors = [
            (pose, reference, prior)
            for timeline, begin, reference in zip(timelines, first, references, strict=True)
            for pose, node in enumerate(timeline.nodes, begin)
            for prior in node.priors
        ]
        in_map = [(pose, one) for pose, reference, one in priors if not one.relative or reference is None]
        relative = [
            (reference, pose, one) for pose, reference, one in priors if one.relative and reference is not None
        ]
        fixes = [
            (pose, fix)
            for timeline, begin in zip(timelines, first, strict=True)
            for pose, node in enumerate(timeline.nodes, begin)
            for fix in node.fixes
        ]
        known = _known_poses(timelines, first, references, starts, initial)
        anchors = known, MapHeadings.of_priors(in_map), _relative_headings(relative), MapPositions.of_fixes(fixes)
        whitening = tuple(_roots_of_information(regular_covariances(one.nodes)) for one in timelines)
        return cls(tuple(timelines), tuple(first), anchors, whitening)

    def at_scales(self, length_scale: Array) -> tuple[Residuals, ...]:
        """Return all residuals with the steps of the devices at length scales (d,)."""
        steps = [
            motions(timeline.nodes, begin, float(scale), whitening)
            for timeline, begin, scale, whitening in zip(
                self.timelines, self.first, length_scale, self.whitening, strict=True
            )
        ]
        return (*self.anchors, *steps)


def cost_of(residuals: Sequence[Residuals], pose: Array) -> float:
    """Return the sum of the costs of residuals at poses (n, 3)."""
    return sum(one.cost(pose) for one in residuals)


def linearised_rows(residuals: Sequence[Residuals], pose: Array) -> list[LinearRows]:
    """Linearise residuals at poses (n, 3)."""
    return [one.linearised(pose) for one in residuals]


def _known_poses(
    timelines: Sequence[Timeline],
    first: Sequence[int],
    references: Sequence[int | None],
    starts: Sequence[StartPose],
    initial: Sequence[Sequence[GaussianState]],
) -> PosePriors:
    """Return the priors of starts and references."""
    poses, expected, sigma = [], [], []
    for timeline, begin, reference, start, states in zip(timelines, first, references, starts, initial, strict=True):
        prior = start_prior(timeline, start, 0.0)
        mean = prior.state.mean[:3].copy()
        if prior.heading_open:
            mean[2] = states[0].mean[2]
        poses.append(begin)
        expected.append(mean)
        sigma.append(np.maximum(np.sqrt(np.diag(prior.state.covariance)[:3]), MIN_SIGMA))
        if reference is not None:
            poses.append(reference)
            expected.append(np.array([*states[0].mean[:2], states[-1].mean[4]]))
            sigma.append(np.array([1.0, 1.0, VAGUE_SIGMA_RAD]))
    return PosePriors(np.array(poses, dtype=np.int64)[:, None], np.array(expected), np.array(sigma))


def _relative_headings(priors: Sequence[tuple[int, int, HeadingPrior]]) -> RelativePoses:
    """Return the residuals of headings that count from references; each prior with reference and pose."""
    turned = np.zeros((len(priors), 3))
    turned[:, 2] = [prior.heading_rad for _, _, prior in priors]
    whitening = np.zeros((len(priors), 3, 3))
    whitening[:, 0, 0] = whitening[:, 1, 1] = 1.0 / _FREE_POSITION_M
    whitening[:, 2, 2] = [1.0 / max(prior.sigma_rad, MIN_SIGMA) for _, _, prior in priors]
    pose = np.array([(reference, pose) for reference, pose, _ in priors], dtype=np.int64).reshape(-1, 2)
    robust = np.array([prior.robust for _, _, prior in priors], dtype=np.bool_)
    return RelativePoses(pose, turned, whitening, robust)


def _roots_of_information(covariance: Array) -> Array:
    """Return matrices W (n, 3, 3) with the inverse Wᵀ W of covariances (n, 3, 3)."""
    variance, axes = np.linalg.eigh(covariance)
    return np.asarray(axes.transpose(0, 2, 1) / np.sqrt(variance)[:, :, None])
