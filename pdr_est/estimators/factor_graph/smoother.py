"""Batch smoothing of a whole walk, of one device or several, in a GTSAM factor graph.

Poses are Pose2 variables; steps are BetweenFactorPose2, fixes PoseTranslationPrior2D, heading priors
PoseRotationPrior2D, or BetweenFactorPose2 from the direction that relative ones count from, as is the end of a closed
walk from its start; robust ones are under a Huber or Cauchy kernel. Two devices of one body are tied by factors that
cost nothing within the distances that a body allows (`gtsam_tethers`).

The walker's length scale would tie one variable to every step and make the system dense, so it stays outside, one a
device: the graph is solved at one scale, linear systems at neighbouring scales tell where the best scale is, its
sigma, and how each pose moves with it, and the scale's share is added to the marginals. For a linear walk that is the
same as a variable in the graph.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pdr_est.errors import EstimationError
from pdr_est.estimators.common.initial_state import starts_of
from pdr_est.estimators.common.motion_model import GaussianState
from pdr_est.estimators.common.tethers import node_tethers_between
from pdr_est.estimators.common.timeline import Timeline, track_from_nodes
from pdr_est.estimators.factor_graph.deep_stack import with_large_stack
from pdr_est.estimators.factor_graph.initial_values import initial_states
from pdr_est.estimators.factor_graph.length_scale import _at_scale
from pdr_est.estimators.factor_graph.newton import CONTINUATION_FACTORS, EXACTLY, EXACTLY_TETHERED, ROUGHLY, SOFTLY
from pdr_est.estimators.factor_graph.walk_graph import _Scale, _WalkGraph
from pdr_est.frames import Array
from pdr_est.types.measurements import DeviceTether, StartPose
from pdr_est.types.track import Track, concatenate

NAME = "factor-graph"
_LARGE_STACK_NODES = 5_000  # GTSAM's elimination recurses
_ROUNDS, _SOFT_ROUNDS = 30, 2  # of finding the scales, with tethers as they are and while they are soft
_HOLD_ROUNDS = 6  # of adding tethers where tracks part in between


def estimate(
    timelines: Sequence[Timeline], tethers: Sequence[DeviceTether], start: StartPose, sigma_length_scale: float
) -> Track:
    """Smoothed tracks of all devices with marginal covariances in the map frame.

    Raises EstimationError if GTSAM finds the graph indeterminate, or tethers do not fit the devices.
    """
    starts = starts_of(timelines, start)
    node_tethers = node_tethers_between(timelines, tethers)
    guesses = initial_states(timelines, node_tethers, starts, sigma_length_scale)

    graph = _WalkGraph(timelines, node_tethers, starts, guesses)

    def work() -> _Solution:
        return _solve(graph, guesses, sigma_length_scale)

    try:
        found = with_large_stack(work) if graph.keys.poses > _LARGE_STACK_NODES else work()
    except RuntimeError as error:
        reason = str(error).strip().splitlines()[0] if str(error).strip() else "no reason given"
        raise EstimationError(
            f"the factor graph has no unique solution ({reason}): give a start pose, more fixes, or use the ekf"
        ) from error
    tracks = []
    for d, (timeline, first) in enumerate(zip(timelines, graph.keys.first, strict=True)):
        own = slice(first, first + len(timeline.nodes))
        pose, covariance = found.pose[own], found.covariance[own]
        scale = (float(found.scale.value[d]), float(np.sqrt(found.scale.covariance[d, d])))
        tracks.append(track_from_nodes(timeline, pose[:, :2], pose[:, 2], covariance, "smoothed", NAME, scale))
    return concatenate(tracks)


def _solve(graph: "_WalkGraph", guesses: Sequence[list[GaussianState]], sigma_length_scale: float) -> "_Solution":
    """The optimum over poses and length scales, and its covariances."""
    expected = [guess[-1].mean[3] if graph.tells_scale else 1.0 for guess in guesses]
    scale = _Scale.without_effect(np.array(expected), graph.keys.poses)
    values = graph.initial_values(guesses)
    for softening in CONTINUATION_FACTORS[:-1] if len(graph.tethers) else ():
        graph.softening = softening
        scale, values = _at_scale(graph, values, scale, sigma_length_scale, SOFTLY, _SOFT_ROUNDS)
        graph.held(values)
    graph.softening = 1.0
    for _ in range(_HOLD_ROUNDS if len(graph.tethers) or graph.tells_scale else 0):
        scale, values = _at_scale(graph, values, scale, sigma_length_scale, ROUGHLY, _ROUNDS)
        if not graph.held(values):
            break
    values = graph.optimised(values, scale.value, EXACTLY_TETHERED if len(graph.tethers) else EXACTLY)
    if sigma_length_scale > 0.0 and not graph.tells_scale:
        scale = graph.untold_scale(values, scale.value, sigma_length_scale)
    pose, covariance = graph.marginals(values, scale.value)
    share = scale.pose_per_scale @ scale.covariance @ scale.pose_per_scale.transpose(0, 2, 1)
    return _Solution(pose, covariance + share, scale)


@dataclass(frozen=True)
class _Solution:
    """Poses (n, 3) of all devices, their covariances (n, 3, 3) in the map frame, and the length scales."""

    pose: Array
    covariance: Array
    scale: _Scale
