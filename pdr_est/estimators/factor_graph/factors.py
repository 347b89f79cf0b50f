"""The measurements of one device as factors of GTSAM.

Poses are Pose2 variables (`keys`). All factors made here are built into GTSAM: PriorFactorPose2 (start),
BetweenFactorPose2 (steps, closed walks, relative heading priors), PoseTranslationPrior2D (fixes without a wandering
error) and PoseRotationPrior2D (heading priors). `wandering_errors` makes those of the other fixes, `tether_factors`
those between devices.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, sin

import gtsam
import numpy as np

from pdr_est.estimators.common.huber import CAUCHY, HUBER
from pdr_est.estimators.common.initial_state import VAGUE_SIGMA_RAD, start_prior
from pdr_est.estimators.common.motion_model import MIN_SIGMA, GaussianState, regular_covariances
from pdr_est.estimators.common.timeline import Node, Timeline
from pdr_est.estimators.factor_graph.keys import GraphKeys
from pdr_est.frames import Array
from pdr_est.types.measurements import HeadingPrior, PositionFix, StartPose

_FREE_HEADING_RAD = 1e3  # standard deviation of a heading that a factor does not constrain
_FREE_POSITION_M = 1e6  # likewise of a position


def add_anchors(
    graph: gtsam.NonlinearFactorGraph,
    timelines: Sequence[Timeline],
    keys: GraphKeys,
    starts: Sequence[StartPose],
    initial: Sequence[Sequence[GaussianState]],
) -> None:
    """Add start poses, position fixes, heading priors and loop closures, which tie the walk to the map.

    Fixes with a wandering error are left out.

    Parameters
    ----------
    graph : gtsam.NonlinearFactorGraph
        Graph to add to.
    timelines, starts : sequences
        Measurements and start pose of each device.
    keys : GraphKeys
        Keys of the poses.
    initial : sequence of sequences of GaussianState
        Initial states at the nodes of each device. The first heading of a device is used where its start heading is
        unknown, the last one for the turn between start and end of a closed walk.
    """
    for timeline, first, reference, start, states in zip(
        timelines, keys.first, keys.references, starts, initial, strict=True
    ):
        prior = start_prior(timeline, start, 0.0)
        mean = prior.state.mean[:3].copy()
        if prior.heading_open:
            mean[2] = states[0].mean[2]
        sigmas = np.maximum(np.sqrt(np.diag(prior.state.covariance)[:3]), MIN_SIGMA)
        graph.add(gtsam.PriorFactorPose2(first, gtsam.Pose2(*mean), gtsam.noiseModel.Diagonal.Sigmas(sigmas)))
        if reference is not None:
            vague = gtsam.noiseModel.Diagonal.Sigmas(np.array([1.0, 1.0, VAGUE_SIGMA_RAD]))
            graph.add(gtsam.PriorFactorPose2(reference, initial_reference(states), vague))
        for i, node in enumerate(timeline.nodes, first):
            add_measurements(graph, node, i, reference)
        if timeline.closure_sigma_m is not None:
            last = first + len(timeline.nodes) - 1
            graph.add(_closure_factor(first, last, timeline.closure_sigma_m, states))


def initial_reference(states: Sequence[GaussianState]) -> gtsam.Pose2:
    """Return the initial reference of relative heading priors, a pose at the start of the walk.

    Its position has no meaning, but must not be far away: the weak information that factors have on it would then
    count.
    """
    east_m, north_m = states[0].mean[:2]
    pose: gtsam.Pose2 = gtsam.Pose2(east_m, north_m, states[-1].mean[4])
    return pose


def add_measurements(graph: gtsam.NonlinearFactorGraph, node: Node, key: int, reference: int | None) -> None:
    """Add the heading priors of a node, and the position fixes that have no wandering error.

    `reference` is the key that relative heading priors count from.
    """
    for fix in node.fixes:
        if fix.sigma_wander_m <= 0.0:
            graph.add(gtsam.PoseTranslationPrior2D(key, np.asarray(fix.position_m), fix_noise(fix)))
    for heading in node.priors:
        graph.add(_heading_factor(key, reference, heading))


@dataclass(frozen=True)
class MotionNoise:
    """Noise of the motion to every node of a device but the first, n in number.

    Attributes
    ----------
    models : list of gtsam.noiseModel.Base
        One for each motion, with no standard deviation below `MIN_SIGMA`.
    information_ahead : (n,) array
        Information on the length of each step for given turn and lateral motion, 1/m².
    """

    models: list[gtsam.noiseModel.Base]
    information_ahead: Array


def motion_noise(nodes: Sequence[Node]) -> MotionNoise:
    """Make the noise models of the motions from the covariances of the nodes."""
    regular = regular_covariances(nodes)
    ahead: Array = np.linalg.inv(regular)[:, 0, 0].astype(np.float64)
    return MotionNoise([gtsam.noiseModel.Gaussian.Covariance(one) for one in regular], ahead)


def add_motion(
    graph: gtsam.NonlinearFactorGraph,
    nodes: Sequence[Node],
    first: int,
    noise: Sequence[gtsam.noiseModel.Base],
    length_scale: float,
) -> None:
    """Add the steps of one device, whose first node has the key `first`, with lengths times `length_scale`."""
    for i, node in enumerate(nodes[1:]):
        graph.add(gtsam.BetweenFactorPose2(first + i, first + i + 1, displacement(node, length_scale), noise[i]))


def displacement(node: Node, length_scale: float) -> gtsam.Pose2:
    """Return the motion that leads to a node, seen from the pose before it."""
    turn, length = node.heading_change_rad, length_scale * node.length_m
    return gtsam.Pose2(length * cos(turn), length * sin(turn), turn)


def _closure_factor(first: int, last: int, sigma_m: float, states: Sequence[GaussianState]) -> gtsam.NonlinearFactor:
    """Make the factor of a closed walk: the last position is the first one, at any heading.

    GTSAM's error of a pose is its logarithm, whose first two components are the position error only if the turn is
    about right. The expected turn is therefore that of the initial states.
    """
    sigma = max(sigma_m, MIN_SIGMA)
    noise = gtsam.noiseModel.Diagonal.Sigmas(np.array([sigma, sigma, _FREE_HEADING_RAD]))
    turned = gtsam.Pose2(0.0, 0.0, states[-1].mean[2] - states[0].mean[2])
    return gtsam.BetweenFactorPose2(first, last, turned, noise)


def _heading_factor(key: int, reference: int | None, prior: HeadingPrior) -> gtsam.NonlinearFactor:
    """Make the factor of a heading in the map, or relative to the heading of the reference."""
    sigma = max(prior.sigma_rad, MIN_SIGMA)
    if not prior.relative or reference is None:
        of_heading = _robust(gtsam.noiseModel.Isotropic.Sigma(1, sigma), prior.robust)
        return gtsam.PoseRotationPrior2D(key, gtsam.Rot2(prior.heading_rad), of_heading)
    only_turned = gtsam.noiseModel.Diagonal.Sigmas(np.array([_FREE_POSITION_M, _FREE_POSITION_M, sigma]))
    pose = gtsam.Pose2(0.0, 0.0, prior.heading_rad)
    return gtsam.BetweenFactorPose2(reference, key, pose, _robust(only_turned, prior.robust))


def _robust(noise: gtsam.noiseModel.Base, robust: bool) -> gtsam.noiseModel.Base:
    if not robust:
        return noise
    return gtsam.noiseModel.Robust.Create(gtsam.noiseModel.mEstimator.Cauchy.Create(CAUCHY), noise)


def fix_noise(fix: PositionFix) -> gtsam.noiseModel.Base:
    """Make the noise model of the independent error of a fix, with Huber's kernel if it is robust."""
    base = gtsam.noiseModel.Gaussian.Covariance(np.asarray(fix.covariance_m2, dtype=np.float64))
    if not fix.robust:
        return base
    return gtsam.noiseModel.Robust.Create(gtsam.noiseModel.mEstimator.Huber.Create(HUBER), base)
