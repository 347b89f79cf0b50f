"""Batch smoothing of a whole walk in a GTSAM factor graph.

Poses are Pose2 variables; steps are BetweenFactorPose2, fixes PoseTranslationPrior2D, heading priors
PoseRotationPrior2D, robust ones under a Huber or Cauchy kernel. The walker's length scale would tie one variable to
every step and make the system dense, so it stays outside: the smoothed filter, which starts the graph, tells scale,
sigma and how each pose moves with the scale; the graph is solved at that scale, and the scale's share is added to the
marginals.
"""

import threading
from collections.abc import Callable
from typing import TypeVar

import gtsam
import numpy as np

from pdr_est.errors import EstimationError
from pdr_est.estimators.ekf import find_start, run_filter, smooth
from pdr_est.estimators.motion import Moments, advance, rewind
from pdr_est.estimators.timeline import Node, Timeline, track_from_nodes
from pdr_est.frames import Array, rotation_matrix
from pdr_est.records import HeadingPrior, PositionFix, StartPose
from pdr_est.track import Track

NAME = "factor-graph"
_LEAST_SIGMA = 1e-3  # m or rad; smaller ones make the elimination fail
_UNKNOWN_SIGMA = (1e3, 1e3, np.pi / np.sqrt(3.0))  # keeps a graph with few fixes determinate
_HUBER = 1.345  # standard deviations; 95 % efficient for Gaussian errors
_CAUCHY = 1.0
_LARGE_STACK_NODES = 5_000
_STACK_BYTES = 512 * 1024 * 1024

T = TypeVar("T")


def estimate(timeline: Timeline, start: StartPose, sigma_length_scale: float) -> Track:
    """Smoothed track with marginal covariances in the map frame.

    Raises EstimationError if GTSAM finds the graph indeterminate.
    """
    guess = initial_states(timeline, start, sigma_length_scale)
    scale = float(guess[-1].mean[3])
    graph = build_graph(timeline, start, guess[0].mean, scale)
    values = gtsam.Values()
    for i, state in enumerate(guess):
        values.insert(i, gtsam.Pose2(*state.mean[:3]))
    poses, marginals = _with_large_stack(len(guess), lambda: _optimise(graph, values, len(guess)))
    covariance = marginals + _share_of_scale(guess)
    return track_from_nodes(
        timeline,
        poses[:, :2],
        poses[:, 2],
        covariance,
        "smoothed",
        NAME,
        (scale, float(np.sqrt(guess[-1].covariance[3, 3]))),
    )


def initial_states(timeline: Timeline, start: StartPose, sigma_length_scale: float) -> list[Moments]:
    """Smoothed filter states at all nodes, also before the direction was known."""
    filtered = run_filter(timeline, start, sigma_length_scale)
    if filtered.aligned_from is None:
        states = [find_start(timeline, start, sigma_length_scale)]
        for node in timeline.nodes[1:]:
            states.append(advance(states[-1], node))
        return states
    k = filtered.aligned_from
    tail = smooth(timeline.nodes[k:], filtered.moments)
    return rewind(tail[0], timeline.nodes[: k + 1])[:-1] + tail


def build_graph(timeline: Timeline, start: StartPose, first_pose: Array, scale: float) -> gtsam.NonlinearFactorGraph:
    """All factors of a walk; variable i is the pose at node i. first_pose: (x, y, heading), used where unknown."""
    graph = gtsam.NonlinearFactorGraph()
    _add_start(graph, start, first_pose, bool(timeline.fixes))
    for i, node in enumerate(timeline.nodes):
        if i:
            graph.add(_between(i, node, scale))
        for fix in node.fixes:
            graph.add(gtsam.PoseTranslationPrior2D(i, np.asarray(fix.position_m), _fix_noise(fix)))
        for prior in node.priors:
            graph.add(gtsam.PoseRotationPrior2D(i, gtsam.Rot2(prior.heading_rad), _prior_noise(prior)))
    return graph


def _add_start(graph: gtsam.NonlinearFactorGraph, start: StartPose, first_pose: Array, has_fixes: bool) -> None:
    """What is known of the start; without fixes the unknown parts define the frame."""
    sigmas = np.array(_UNKNOWN_SIGMA if has_fixes else (_LEAST_SIGMA,) * 3)
    pose = np.array(first_pose[:3])
    if start.position_m is not None:
        pose[:2] = start.position_m
        sigmas[:2] = max(start.sigma_position_m, _LEAST_SIGMA)
    if start.heading_rad is not None:
        pose[2] = start.heading_rad
        sigmas[2] = max(start.sigma_heading_rad, _LEAST_SIGMA)
    graph.add(gtsam.PriorFactorPose2(0, gtsam.Pose2(*pose), gtsam.noiseModel.Diagonal.Sigmas(sigmas)))


def _between(i: int, node: Node, scale: float) -> gtsam.BetweenFactorPose2:
    turn, length = node.heading_change_rad, scale * node.length_m
    motion = gtsam.Pose2(length * np.cos(turn), length * np.sin(turn), turn)
    return gtsam.BetweenFactorPose2(i - 1, i, motion, gtsam.noiseModel.Gaussian.Covariance(node.covariance))


def _fix_noise(fix: PositionFix) -> gtsam.noiseModel.Base:
    base = gtsam.noiseModel.Gaussian.Covariance(np.asarray(fix.covariance_m2, dtype=np.float64))
    if not fix.robust:
        return base
    return gtsam.noiseModel.Robust.Create(gtsam.noiseModel.mEstimator.Huber.Create(_HUBER), base)


def _prior_noise(prior: HeadingPrior) -> gtsam.noiseModel.Base:
    base = gtsam.noiseModel.Isotropic.Sigma(1, max(prior.sigma_rad, _LEAST_SIGMA))
    if not prior.robust:
        return base
    return gtsam.noiseModel.Robust.Create(gtsam.noiseModel.mEstimator.Cauchy.Create(_CAUCHY), base)


def _optimise(graph: gtsam.NonlinearFactorGraph, values: gtsam.Values, count: int) -> tuple[Array, Array]:
    """Poses (n, 3) at the optimum and their marginal covariances (n, 3, 3) in the map frame."""
    try:
        result = gtsam.LevenbergMarquardtOptimizer(graph, values).optimize()
        marginals = gtsam.Marginals(graph, result)
        poses, covariances = np.empty((count, 3)), np.empty((count, 3, 3))
        for i in range(count):
            pose = result.atPose2(i)
            poses[i] = pose.x(), pose.y(), pose.theta()
            to_map = np.eye(3)
            to_map[:2, :2] = rotation_matrix(pose.theta())
            covariances[i] = to_map @ marginals.marginalCovariance(i) @ to_map.T
    except RuntimeError as error:
        reason = str(error).strip().splitlines()[0] if str(error).strip() else "no reason given"
        raise EstimationError(
            f"the factor graph has no unique solution ({reason}): give a start pose, more fixes, or use the ekf"
        ) from error
    return poses, covariances


def _share_of_scale(states: list[Moments]) -> Array:
    """What the uncertain length scale adds to each pose's covariance: J J^T var(scale), (n, 3, 3)."""
    with_scale = np.array([state.covariance[:3, 3] for state in states])
    variance = np.array([state.covariance[3, 3] for state in states])
    share: Array = with_scale[:, :, None] * with_scale[:, None, :] / np.maximum(variance, 1e-12)[:, None, None]
    return share


def _with_large_stack(nodes: int, work: Callable[[], T]) -> T:
    """GTSAM's elimination recurses; very long walks overflow the usual stack, so they get a thread with more."""
    if nodes < _LARGE_STACK_NODES:
        return work()
    outcome: list[T] = []
    failure: list[BaseException] = []

    def run() -> None:
        try:
            outcome.append(work())
        except BaseException as error:
            failure.append(error)

    previous = threading.stack_size(_STACK_BYTES)
    try:
        thread = threading.Thread(target=run)
        thread.start()
    finally:
        threading.stack_size(previous)
    thread.join()
    if failure:
        raise failure[0]
    return outcome[0]
