"""Batch smoothing of a whole walk in a GTSAM factor graph.

Poses are Pose2 variables; steps are BetweenFactorPose2, fixes PoseTranslationPrior2D, heading priors
PoseRotationPrior2D, or BetweenFactorPose2 from the direction that relative ones count from, as is the end of a closed
walk from its start; robust ones are under a Huber or Cauchy kernel. The walker's length scale would tie one variable
to every step and make the system dense, so it stays outside, one a device: the graph is solved at one scale, linear
systems at neighbouring scales tell where the best scale is, its sigma, and how each pose moves with it, and the
scale's share is added to the marginals. For a linear walk that is the same as a variable in the graph.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import combinations

import gtsam
import numpy as np

from pdr_est.errors import EstimationError
from pdr_est.estimators.ekf import run_filter, smooth, undecided_anchor
from pdr_est.estimators.gtsam_factors import Keys, add_motion, anchors, motion_noise, reference_guess
from pdr_est.estimators.gtsam_marginals import in_map, marginal_covariances, ordering_of, to_map
from pdr_est.estimators.large_stack import with_large_stack
from pdr_est.estimators.motion import Moments, reckon
from pdr_est.estimators.timeline import Timeline, track_from_nodes
from pdr_est.frames import Array
from pdr_est.records import StartPose
from pdr_est.track import Track

NAME = "factor-graph"
_LARGE_STACK_NODES = 5_000  # GTSAM's elimination recurses
_SCALE_PROBE = 0.05  # how far from the scale the neighbouring systems are; of no influence, they are linear
_SCALE_ROUNDS = 10
_SCALE_TOLERANCE = 1e-2  # of the scale's sigma; the rest is second order


@dataclass(frozen=True)
class _Scale:
    """The length scales (d,) of the devices at the optimum, their covariance (d, d), and the motion of the poses
    with them, (n, 3, d) in the map."""

    value: Array
    covariance: Array
    pose_per_scale: Array


def estimate(timeline: Timeline, start: StartPose, sigma_length_scale: float) -> Track:
    """Smoothed track with marginal covariances in the map frame.

    Raises EstimationError if GTSAM finds the graph indeterminate.
    """
    guess = initial_states(timeline, start, sigma_length_scale)

    def work() -> tuple[Array, Array, _Scale]:
        return _solve([timeline], start, [guess], sigma_length_scale)

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
        (float(scale.value[0]), float(np.sqrt(scale.covariance[0, 0]))),
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
    timelines: Sequence[Timeline], start: StartPose, guesses: Sequence[list[Moments]], sigma_length_scale: float
) -> tuple[Array, Array, _Scale]:
    """Poses (n, 3) at the optimum, their covariances (n, 3, 3) in the map frame, and the scales."""
    keys = Keys.of(timelines)
    tied = anchors(timelines, keys, start, guesses)
    noises = [motion_noise(timeline.nodes) for timeline in timelines]
    order = _from_the_end(timelines, keys)

    def graph_at(length_scale: Array) -> gtsam.NonlinearFactorGraph:
        graph = gtsam.NonlinearFactorGraph(tied)
        for timeline, first, noise, scale in zip(timelines, keys.first, noises, length_scale, strict=True):
            add_motion(graph, timeline.nodes, first, noise, float(scale))
        return graph

    values = _initial_values(guesses, keys)
    devices = len(timelines)
    scale = _Scale(
        np.array([guess[-1].mean[3] for guess in guesses]), np.zeros((devices, devices)), np.zeros((keys.poses, 3, 0))
    )
    for _ in range(_SCALE_ROUNDS):
        graph = graph_at(scale.value)
        values = _optimise(graph, values, order)
        if sigma_length_scale == 0.0:
            scale = _Scale(scale.value, scale.covariance, np.zeros((keys.poses, 3, devices)))
            break
        before = scale.value
        scale, values = _improve_scale(graph_at, values, before, sigma_length_scale, order, keys.poses)
        if (np.abs(scale.value - before) < _SCALE_TOLERANCE * np.sqrt(np.diag(scale.covariance))).all():
            break
    pose = _poses(values, keys.poses)
    rotation = to_map(pose[:, 2])
    marginals = rotation @ marginal_covariances(graph, values, order)[: keys.poses] @ rotation.transpose(0, 2, 1)
    share = scale.pose_per_scale @ scale.covariance @ scale.pose_per_scale.transpose(0, 2, 1)
    return pose, marginals + share, scale


def _from_the_end(timelines: Sequence[Timeline], keys: Keys) -> list[int]:
    """The variables in the order of elimination: poses from the last to the first, then the references."""
    times = np.concatenate([[node.time_s for node in timeline.nodes] for timeline in timelines])
    latest_first = np.lexsort((np.arange(len(times)), times))[::-1]
    return [*latest_first.tolist(), *keys.present_references]


def _initial_values(guesses: Sequence[list[Moments]], keys: Keys) -> gtsam.Values:
    values = gtsam.Values()
    for guess, first, reference in zip(guesses, keys.first, keys.references, strict=True):
        for i, state in enumerate(guess, first):
            values.insert(i, gtsam.Pose2(*state.mean[:3]))
        if reference is not None:
            values.insert(reference, reference_guess(guess))
    return values


def _poses(values: gtsam.Values, count: int) -> Array:
    """Poses (count, 3)."""
    return np.asarray(gtsam.utilities.extractPose2(values)[:count])


def _optimise(graph: gtsam.NonlinearFactorGraph, values: gtsam.Values, order: Sequence[int]) -> gtsam.Values:
    params = gtsam.LevenbergMarquardtParams()
    params.setLinearSolverType("MULTIFRONTAL_QR")
    params.setOrdering(ordering_of(order))
    params.setRelativeErrorTol(1e-6)
    params.setAbsoluteErrorTol(1e-6)
    return gtsam.LevenbergMarquardtOptimizer(graph, values, params).optimize()


def _improve_scale(
    graph_at: Callable[[Array], gtsam.NonlinearFactorGraph],
    values: gtsam.Values,
    scale: Array,
    sigma: float,
    order: Sequence[int],
    poses: int,
) -> tuple[_Scale, gtsam.Values]:
    """One Newton step on the length scales, and the poses moved along. values: optimum at `scale`; sigma: prior's.

    The least error over the poses is a paraboloid in the scales; a few linear systems give its slope and curvature.
    """
    axes = _SCALE_PROBE * np.eye(len(scale))

    def least_error(offset: Array) -> tuple[float, gtsam.VectorValues]:
        return _least_error(graph_at(scale + offset), values, order)

    here = least_error(np.zeros(len(scale)))
    above, below = [least_error(axis) for axis in axes], [least_error(-axis) for axis in axes]
    slope = np.array([(a[0] - b[0]) / (2.0 * _SCALE_PROBE) for a, b in zip(above, below, strict=True)])
    bend = np.diag([a[0] - 2.0 * here[0] + b[0] for a, b in zip(above, below, strict=True)])
    for i, j in combinations(range(len(scale)), 2):
        both = least_error(axes[i] + axes[j])
        bend[i, j] = bend[j, i] = both[0] - above[i][0] - above[j][0] + here[0]
    curvature = _not_concave(bend) / _SCALE_PROBE**2 + np.eye(len(scale)) / sigma**2
    slope += (scale - 1.0) / sigma**2
    step: Array = -np.linalg.solve(curvature, slope)
    per_scale = [a[1].subtract(b[1]).scale(0.5 / _SCALE_PROBE) for a, b in zip(above, below, strict=True)]
    change = here[1]
    for amount, direction in zip(step, per_scale, strict=True):
        change = change.add(direction.scale(float(amount)))
    heading = _poses(values, poses)[:, 2]
    moved = np.stack([in_map(direction, heading) for direction in per_scale], axis=2)
    improved = _Scale(np.asarray(scale + step), np.asarray(np.linalg.inv(curvature)), moved)
    return improved, values.retract(change)


def _not_concave(bend: Array) -> Array:
    """The symmetric matrix (d, d) without what rounding may have made negative."""
    variance, axes = np.linalg.eigh(bend)
    return np.asarray((axes * np.maximum(variance, 0.0)) @ axes.T)


def _least_error(
    graph: gtsam.NonlinearFactorGraph, values: gtsam.Values, order: Sequence[int]
) -> tuple[float, gtsam.VectorValues]:
    """Least error of the graph linearised at `values`, and the change of the variables that leads there."""
    linear = graph.linearize(values)
    change = linear.optimize(ordering_of(order), gtsam.EliminateQR)
    return linear.error(change), change
