"""Batch smoothing of a whole walk in a GTSAM factor graph.

Poses are Pose2 variables; steps are BetweenFactorPose2, fixes PoseTranslationPrior2D, heading priors
PoseRotationPrior2D, robust ones under a Huber or Cauchy kernel. The walker's length scale would tie one variable to
every step and make the system dense, so it stays outside: the graph is solved at one scale, two linear systems at
neighbouring scales tell where the best scale is, its sigma, and how each pose moves with it, and the scale's share is
added to the marginals. For a linear walk that is the same as a variable in the graph.

Sigmas reach from the least one to the reach of a gap of hours. Their squares are further apart than a number has
digits, so systems are eliminated by QR and not by Cholesky, and from the end of the walk to its start, where there
always is a prior: no elimination then depends on what rounding left of nothing.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import cos, sin

import gtsam
import numpy as np

from pdr_est.errors import EstimationError
from pdr_est.estimators.ekf import run_filter, smooth, undecided_anchor
from pdr_est.estimators.large_stack import with_large_stack
from pdr_est.estimators.motion import Moments, reckon
from pdr_est.estimators.robust import HUBER
from pdr_est.estimators.start import start_prior
from pdr_est.estimators.timeline import Node, Timeline, track_from_nodes
from pdr_est.frames import Array
from pdr_est.records import HeadingPrior, PositionFix, StartPose
from pdr_est.track import Track

NAME = "factor-graph"
_LEAST_SIGMA = 1e-4  # m or rad; smaller ones make the elimination fail
_CAUCHY = 1.0
_LARGE_STACK_NODES = 5_000  # GTSAM's elimination recurses
_SCALE_PROBE = 0.05  # how far from the scale the neighbouring systems are; of no influence, they are linear
_SCALE_ROUNDS = 10
_SCALE_TOLERANCE = 1e-2  # of the scale's sigma; the rest is second order


@dataclass(frozen=True)
class _Scale:
    """The length scale at the optimum, its variance, and the motion of the poses with it, (n, 3) in the map."""

    value: float
    variance: float
    pose_per_scale: Array


def estimate(timeline: Timeline, start: StartPose, sigma_length_scale: float) -> Track:
    """Smoothed track with marginal covariances in the map frame.

    Raises EstimationError if GTSAM finds the graph indeterminate.
    """
    guess = initial_states(timeline, start, sigma_length_scale)

    def work() -> tuple[Array, Array, _Scale]:
        return _solve(timeline, start, guess, sigma_length_scale)

    try:
        pose, covariance, scale = with_large_stack(work) if len(guess) > _LARGE_STACK_NODES else work()
    except RuntimeError as error:
        reason = str(error).strip().splitlines()[0] if str(error).strip() else "no reason given"
        raise EstimationError(
            f"the factor graph has no unique solution ({reason}): give a start pose, more fixes, or use the ekf"
        ) from error
    return track_from_nodes(
        timeline,
        pose[:, :2],
        pose[:, 2],
        covariance,
        "smoothed",
        NAME,
        (scale.value, float(np.sqrt(scale.variance))),
    )


def initial_states(timeline: Timeline, start: StartPose, sigma_length_scale: float) -> list[Moments]:
    """States at all nodes to start from: the smoothed filter, and before the direction was known back from there."""
    states: list[Moments] = []
    for stretch in run_filter(timeline, start, sigma_length_scale):
        k = stretch.aligned_from
        if k is None:
            states += reckon(stretch.nodes, *undecided_anchor(stretch))
        else:
            tail = smooth(stretch.nodes[k:], stretch.moments)
            states += reckon(stretch.nodes[: k + 1], k, tail[0])[:-1] + tail
    return states


def _solve(
    timeline: Timeline, start: StartPose, guess: list[Moments], sigma_length_scale: float
) -> tuple[Array, Array, _Scale]:
    """Poses (n, 3) at the optimum, their covariances (n, 3, 3) in the map frame, and the scale."""
    anchors = _anchors(timeline, start, guess[0].mean[:3])
    noise = _motion_noise(timeline)

    def graph_at(length_scale: float) -> gtsam.NonlinearFactorGraph:
        return _with_motion(anchors, timeline, noise, length_scale)

    values = gtsam.Values()
    for i, state in enumerate(guess):
        values.insert(i, gtsam.Pose2(*state.mean[:3]))
    scale = _Scale(float(guess[-1].mean[3]), 0.0, np.zeros((len(guess), 3)))
    for _ in range(_SCALE_ROUNDS):
        graph = graph_at(scale.value)
        values = _optimise(graph, values)
        if sigma_length_scale == 0.0:
            break
        before = scale.value
        scale, values = _improve_scale(graph_at, values, before, sigma_length_scale)
        if abs(scale.value - before) < _SCALE_TOLERANCE * np.sqrt(scale.variance):
            break
    pose, marginals = _marginals(graph, values)
    share = scale.pose_per_scale[:, :, None] * scale.pose_per_scale[:, None, :] * scale.variance
    return pose, marginals + share, scale


def _anchors(timeline: Timeline, start: StartPose, guess: Array) -> gtsam.NonlinearFactorGraph:
    """What ties the walk to the map: start, fixes and heading priors. guess: start pose, used where it is open."""
    prior = start_prior(timeline, start, 0.0)
    mean = np.array([*prior.moments.mean[:2], guess[2] if prior.heading_open else prior.moments.mean[2]])
    sigmas = np.maximum(np.sqrt(np.diag(prior.moments.covariance)[:3]), _LEAST_SIGMA)
    graph = gtsam.NonlinearFactorGraph()
    graph.add(gtsam.PriorFactorPose2(0, gtsam.Pose2(*mean), gtsam.noiseModel.Diagonal.Sigmas(sigmas)))
    for i, node in enumerate(timeline.nodes):
        for fix in node.fixes:
            graph.add(gtsam.PoseTranslationPrior2D(i, np.asarray(fix.position_m), _fix_noise(fix)))
        for heading in node.priors:
            graph.add(gtsam.PoseRotationPrior2D(i, gtsam.Rot2(heading.heading_rad), _prior_noise(heading)))
    return graph


def _motion_noise(timeline: Timeline) -> list[gtsam.noiseModel.Base]:
    """Of the motion to every node but the first, in no direction below the least sigma."""
    covariance = np.array([node.covariance for node in timeline.nodes[1:]]).reshape(-1, 3, 3)
    variance, axes = np.linalg.eigh(covariance)
    regular = (axes * np.maximum(variance, _LEAST_SIGMA**2)[:, None, :]) @ axes.transpose(0, 2, 1)
    return [gtsam.noiseModel.Gaussian.Covariance(one) for one in regular]


def _with_motion(
    anchors: gtsam.NonlinearFactorGraph, timeline: Timeline, noise: list[gtsam.noiseModel.Base], length_scale: float
) -> gtsam.NonlinearFactorGraph:
    """All factors of a walk at one length scale; variable i is the pose at node i."""
    graph = gtsam.NonlinearFactorGraph(anchors)
    for i, node in enumerate(timeline.nodes[1:]):
        graph.add(gtsam.BetweenFactorPose2(i, i + 1, _displacement(node, length_scale), noise[i]))
    return graph


def _displacement(node: Node, length_scale: float) -> gtsam.Pose2:
    turn, length = node.heading_change_rad, length_scale * node.length_m
    return gtsam.Pose2(length * cos(turn), length * sin(turn), turn)


def _fix_noise(fix: PositionFix) -> gtsam.noiseModel.Base:
    base = gtsam.noiseModel.Gaussian.Covariance(np.asarray(fix.covariance_m2, dtype=np.float64))
    if not fix.robust:
        return base
    return gtsam.noiseModel.Robust.Create(gtsam.noiseModel.mEstimator.Huber.Create(HUBER), base)


def _prior_noise(prior: HeadingPrior) -> gtsam.noiseModel.Base:
    base = gtsam.noiseModel.Isotropic.Sigma(1, max(prior.sigma_rad, _LEAST_SIGMA))
    if not prior.robust:
        return base
    return gtsam.noiseModel.Robust.Create(gtsam.noiseModel.mEstimator.Cauchy.Create(_CAUCHY), base)


def _end_to_start(values: gtsam.Values) -> gtsam.Ordering:
    """The order in which poses are eliminated."""
    ordering = gtsam.Ordering()
    for i in reversed(range(values.size())):
        ordering.push_back(i)
    return ordering


def _optimise(graph: gtsam.NonlinearFactorGraph, values: gtsam.Values) -> gtsam.Values:
    params = gtsam.LevenbergMarquardtParams()
    params.setLinearSolverType("MULTIFRONTAL_QR")
    params.setOrdering(_end_to_start(values))
    params.setRelativeErrorTol(1e-6)
    params.setAbsoluteErrorTol(1e-6)
    return gtsam.LevenbergMarquardtOptimizer(graph, values, params).optimize()


def _improve_scale(
    graph_at: Callable[[float], gtsam.NonlinearFactorGraph], values: gtsam.Values, scale: float, sigma: float
) -> tuple[_Scale, gtsam.Values]:
    """One Newton step on the length scale, and the poses moved along. values: optimum at `scale`; sigma: prior's.

    The least error over the poses is a parabola in the scale; three linear systems give its slope and curvature.
    """
    here, below, above = (
        _least_error(graph_at(scale + offset), values) for offset in (0.0, -_SCALE_PROBE, _SCALE_PROBE)
    )
    slope = (above[0] - below[0]) / (2.0 * _SCALE_PROBE) + (scale - 1.0) / sigma**2
    curvature = max((above[0] - 2.0 * here[0] + below[0]) / _SCALE_PROBE**2, 0.0) + 1.0 / sigma**2
    per_scale = above[1].subtract(below[1]).scale(0.5 / _SCALE_PROBE)
    step = -slope / curvature
    improved = _Scale(scale + step, 1.0 / curvature, _in_map(per_scale, values))
    return improved, values.retract(here[1].add(per_scale.scale(step)))


def _least_error(graph: gtsam.NonlinearFactorGraph, values: gtsam.Values) -> tuple[float, gtsam.VectorValues]:
    """Least error of the graph linearised at `values`, and the change of the poses that leads there."""
    linear = graph.linearize(values)
    change = linear.optimize(_end_to_start(values), gtsam.EliminateQR)
    return linear.error(change), change


def _in_map(change: gtsam.VectorValues, values: gtsam.Values) -> Array:
    """Changes of the poses, (n, 3), turned from their own frames into the map frame."""
    body = change.vector().reshape(-1, 3)
    heading = gtsam.utilities.extractPose2(values)[:, 2]
    in_map: Array = np.einsum("nij,nj->ni", _to_map(heading), body)
    return in_map


def _to_map(heading_rad: Array) -> Array:
    """Rotations (n, 3, 3) of (forward, left, heading) into (east, north, heading)."""
    c, s = np.cos(heading_rad), np.sin(heading_rad)
    rotation = np.zeros((len(heading_rad), 3, 3))
    rotation[:, 0, 0], rotation[:, 0, 1], rotation[:, 1, 0], rotation[:, 1, 1] = c, -s, s, c
    rotation[:, 2, 2] = 1.0
    return rotation


def _marginals(graph: gtsam.NonlinearFactorGraph, values: gtsam.Values) -> tuple[Array, Array]:
    """Poses (n, 3) and their marginal covariances (n, 3, 3) in the map frame.

    Eliminated from the end, a pose is R^-1 (white noise - S (pose before)): the covariances follow one another from
    the start on, by sums alone.
    """
    pose: Array = gtsam.utilities.extractPose2(values)
    eliminated = graph.linearize(values).eliminateSequential(_end_to_start(values), gtsam.EliminateQR)
    body = np.empty((len(pose), 3, 3))
    for i in range(len(pose)):
        conditional = eliminated.at(len(pose) - 1 - i)
        inverse = np.linalg.inv(conditional.R())
        body[i] = inverse @ inverse.T
        if i:
            carried = inverse @ conditional.S()
            body[i] += carried @ body[i - 1] @ carried.T
    rotation = _to_map(pose[:, 2])
    return pose, rotation @ body @ rotation.transpose(0, 2, 1)
