"""The factors of a walk: what ties poses to each other and to the map, with its noise.

Poses are Pose2 variables, all nodes of one device after those of the other; the reference directions of relative
heading priors, one a device that has some, come last. Every factor is one of GTSAM's own.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, sin

import gtsam
import numpy as np

from pdr_est.estimators.common.huber import HUBER
from pdr_est.estimators.common.initial_state import VAGUE_SIGMA_RAD, start_prior
from pdr_est.estimators.common.motion_model import GaussianState
from pdr_est.estimators.common.tethers import NodeTether
from pdr_est.estimators.common.timeline import Node, Timeline
from pdr_est.frames import Array
from pdr_est.types.measurements import HeadingPrior, PositionFix, StartPose

LEAST_SIGMA = 1e-4  # m or rad; smaller ones make the elimination fail
_ANYWHERE_M = 1e6  # sigma of a translation that a factor says nothing of
_ANY_TURN_RAD = 1e3  # likewise of a rotation
_CAUCHY = 1.0


@dataclass(frozen=True)
class Keys:
    """The variables of a graph by number. first: of each device; references: of the devices, None without one."""

    first: tuple[int, ...]
    references: tuple[int | None, ...]
    poses: int

    @classmethod
    def of(cls, timelines: Sequence[Timeline]) -> "Keys":
        counts = [len(timeline.nodes) for timeline in timelines]
        first = tuple(int(n) for n in np.cumsum([0, *counts[:-1]]))
        references: list[int | None] = []
        next_key = sum(counts)
        for timeline in timelines:
            relative = any(prior.relative for prior in timeline.priors)
            references.append(next_key if relative else None)
            next_key += relative
        return cls(first, tuple(references), sum(counts))

    def of_node_tether(self, node_tether: NodeTether) -> tuple[int, int]:
        """The two poses that a tie is between."""
        return self.first[node_tether.device_a] + node_tether.node_a, self.first[
            node_tether.device_b
        ] + node_tether.node_b

    @property
    def present_references(self) -> list[int]:
        return [key for key in self.references if key is not None]


def anchors(
    timelines: Sequence[Timeline],
    keys: Keys,
    starts: Sequence[StartPose],
    guesses: Sequence[Sequence[GaussianState]],
) -> gtsam.NonlinearFactorGraph:
    """What ties the walk to the map: start, fixes and heading priors, and the end of a closed walk to its start.

    starts, guesses: start of each device, and states at its nodes; the first one's heading is used where that of the
    start is open.
    """
    graph = gtsam.NonlinearFactorGraph()
    for timeline, first, reference, start, guess in zip(
        timelines, keys.first, keys.references, starts, guesses, strict=True
    ):
        prior = start_prior(timeline, start, 0.0)
        mean = prior.state.mean[:3].copy()
        if prior.heading_open:
            mean[2] = guess[0].mean[2]
        sigmas = np.maximum(np.sqrt(np.diag(prior.state.covariance)[:3]), LEAST_SIGMA)
        graph.add(gtsam.PriorFactorPose2(first, gtsam.Pose2(*mean), gtsam.noiseModel.Diagonal.Sigmas(sigmas)))
        if reference is not None:
            vague = gtsam.noiseModel.Diagonal.Sigmas(np.array([1.0, 1.0, VAGUE_SIGMA_RAD]))
            graph.add(gtsam.PriorFactorPose2(reference, reference_guess(guess), vague))
        for i, node in enumerate(timeline.nodes, first):
            add_measurements(graph, node, i, reference)
        if timeline.closure_sigma_m is not None:
            last = first + len(timeline.nodes) - 1
            graph.add(_closure_factor(first, last, timeline.closure_sigma_m, guess))
    return graph


def reference_guess(guess: Sequence[GaussianState]) -> gtsam.Pose2:
    """The reference of a walk's relative priors to start from. It lies where the walk begins: from far away, nothing
    that factors say of its position would be weak enough."""
    east_m, north_m = guess[0].mean[:2]
    pose: gtsam.Pose2 = gtsam.Pose2(east_m, north_m, guess[-1].mean[4])
    return pose


def add_measurements(graph: gtsam.NonlinearFactorGraph, node: Node, key: int, reference: int | None) -> None:
    """Add the fixes and heading priors of a node. reference: variable that relative priors count from."""
    for fix in node.fixes:
        graph.add(gtsam.PoseTranslationPrior2D(key, np.asarray(fix.position_m), _fix_noise(fix)))
    for heading in node.priors:
        graph.add(_heading_factor(key, reference, heading))


@dataclass(frozen=True)
class MotionNoise:
    """Of the motion to every node but the first, in no direction below the least sigma. information_ahead: (n,) about
    the length of each step if it turned and moved aside as measured, 1/m^2."""

    models: list[gtsam.noiseModel.Base]
    information_ahead: Array


def motion_noise(nodes: Sequence[Node]) -> MotionNoise:
    """From the covariances of the nodes."""
    covariance = np.array([node.covariance for node in nodes[1:]]).reshape(-1, 3, 3)
    variance, axes = np.linalg.eigh(covariance)
    variance = np.maximum(variance, LEAST_SIGMA**2)
    regular = (axes * variance[:, None, :]) @ axes.transpose(0, 2, 1)
    ahead = np.sum(axes[:, 0, :] ** 2 / variance, axis=1)
    return MotionNoise([gtsam.noiseModel.Gaussian.Covariance(one) for one in regular], ahead)


def add_motion(
    graph: gtsam.NonlinearFactorGraph,
    nodes: Sequence[Node],
    first: int,
    noise: Sequence[gtsam.noiseModel.Base],
    length_scale: float,
) -> None:
    """Add the steps of one device, whose first node has the key `first`, at a length scale."""
    for i, node in enumerate(nodes[1:]):
        graph.add(gtsam.BetweenFactorPose2(first + i, first + i + 1, displacement(node, length_scale), noise[i]))


def displacement(node: Node, length_scale: float) -> gtsam.Pose2:
    turn, length = node.heading_change_rad, length_scale * node.length_m
    return gtsam.Pose2(length * cos(turn), length * sin(turn), turn)


def _closure_factor(first: int, last: int, sigma_m: float, guess: Sequence[GaussianState]) -> gtsam.NonlinearFactor:
    """The last pose is where the first one is, turned by anything. The turn is expected where it is guessed, for
    GTSAM's error of a pose, its logarithm, is that of the position only if the turn is about right."""
    sigma = max(sigma_m, LEAST_SIGMA)
    noise = gtsam.noiseModel.Diagonal.Sigmas(np.array([sigma, sigma, _ANY_TURN_RAD]))
    turned = gtsam.Pose2(0.0, 0.0, guess[-1].mean[2] - guess[0].mean[2])
    return gtsam.BetweenFactorPose2(first, last, turned, noise)


def _heading_factor(key: int, reference: int | None, prior: HeadingPrior) -> gtsam.NonlinearFactor:
    """A heading in the map, or relative to the reference, whose pose is of no meaning but for its rotation."""
    sigma = max(prior.sigma_rad, LEAST_SIGMA)
    if not prior.relative or reference is None:
        of_heading = _robust(gtsam.noiseModel.Isotropic.Sigma(1, sigma), prior.robust)
        return gtsam.PoseRotationPrior2D(key, gtsam.Rot2(prior.heading_rad), of_heading)
    only_turned = gtsam.noiseModel.Diagonal.Sigmas(np.array([_ANYWHERE_M, _ANYWHERE_M, sigma]))
    pose = gtsam.Pose2(0.0, 0.0, prior.heading_rad)
    return gtsam.BetweenFactorPose2(reference, key, pose, _robust(only_turned, prior.robust))


def _robust(noise: gtsam.noiseModel.Base, robust: bool) -> gtsam.noiseModel.Base:
    if not robust:
        return noise
    return gtsam.noiseModel.Robust.Create(gtsam.noiseModel.mEstimator.Cauchy.Create(_CAUCHY), noise)


def _fix_noise(fix: PositionFix) -> gtsam.noiseModel.Base:
    base = gtsam.noiseModel.Gaussian.Covariance(np.asarray(fix.covariance_m2, dtype=np.float64))
    if not fix.robust:
        return base
    return gtsam.noiseModel.Robust.Create(gtsam.noiseModel.mEstimator.Huber.Create(HUBER), base)
