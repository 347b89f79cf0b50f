"""Batch smoothing of a whole walk, of one device or several, in a GTSAM factor graph.

Poses are Pose2 variables; steps are BetweenFactorPose2, fixes PoseTranslationPrior2D, heading priors
PoseRotationPrior2D, or BetweenFactorPose2 from the direction that relative ones count from, as is the end of a closed
walk from its start; robust ones are under a Huber or Cauchy kernel. Two devices of one body have a RangeFactorPose2
between them whose kernel ignores all distances that a body allows.

The walker's length scale would tie one variable to every step and make the system dense, so it stays outside, one a
device: the graph is solved at one scale, linear systems at neighbouring scales tell where the best scale is, its
sigma, and how each pose moves with it, and the scale's share is added to the marginals. For a linear walk that is the
same as a variable in the graph.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import gtsam
import numpy as np

from pdr_est.errors import EstimationError
from pdr_est.estimators.ekf import alone_smoothed, run_filter
from pdr_est.estimators.gtsam_factors import (
    Keys,
    add_motion,
    add_tethers,
    add_tight,
    anchors,
    motion_noise,
    reference_guess,
)
from pdr_est.estimators.gtsam_marginals import in_map, marginal_covariances, ordering_of, to_map
from pdr_est.estimators.joint_ekf import smoothed_states
from pdr_est.estimators.large_stack import with_large_stack
from pdr_est.estimators.motion import Moments
from pdr_est.estimators.ties import Tie, starts_of, ties_between
from pdr_est.estimators.timeline import Timeline, track_from_nodes
from pdr_est.frames import Array
from pdr_est.records import DeviceTether, StartPose
from pdr_est.track import Track, concatenate

NAME = "factor-graph"
_LARGE_STACK_NODES = 5_000  # GTSAM's elimination recurses
_LEADING_ITERATIONS = 15
_SLACK_M = 1e-3
_SCALE_PROBE = 0.05  # how far from the scale the neighbouring systems are; of no influence, they are linear
_ROUNDS = 30
_SCALE_TOLERANCE = 1e-2  # of the scale's sigma; the rest is second order


@dataclass(frozen=True)
class _Scale:
    """The length scales (d,) of the devices at the optimum, their covariance (d, d), and the motion of the poses
    with them, (n, 3, d) in the map."""

    value: Array
    covariance: Array
    pose_per_scale: Array

    @classmethod
    def without_effect(cls, value: Array, poses: int) -> "_Scale":
        return cls(value, np.zeros((len(value), len(value))), np.zeros((poses, 3, len(value))))


def estimate(
    timelines: Sequence[Timeline], tethers: Sequence[DeviceTether], start: StartPose, sigma_length_scale: float
) -> Track:
    """Smoothed tracks of all devices with marginal covariances in the map frame.

    Raises EstimationError if GTSAM finds the graph indeterminate, or tethers do not fit the devices.
    """
    starts = starts_of(timelines, start)
    ties = ties_between(timelines, tethers)
    guesses = initial_states(timelines, ties, starts, sigma_length_scale)

    graph = _WalkGraph(timelines, ties, starts, guesses)

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


def initial_states(
    timelines: Sequence[Timeline], ties: Sequence[Tie], starts: Sequence[StartPose], sigma_length_scale: float
) -> list[list[Moments]]:
    """States at all nodes of each device to start from: those of the smoothed filter."""
    if ties:
        return smoothed_states(timelines, ties, starts, sigma_length_scale)
    return [
        alone_smoothed(run_filter(timeline, start, sigma_length_scale))
        for timeline, start in zip(timelines, starts, strict=True)
    ]


def _solve(graph: "_WalkGraph", guesses: Sequence[list[Moments]], sigma_length_scale: float) -> "_Solution":
    """The optimum over poses and length scales, and its covariances."""
    values = graph.initial_values(guesses)
    scale = _Scale.without_effect(np.array([guess[-1].mean[3] for guess in guesses]), graph.keys.poses)
    values = graph.led_together(values, scale.value)
    for _ in range(_ROUNDS):
        values = graph.optimised(values, scale.value)
        settled = not graph.retie(values)
        if settled and sigma_length_scale > 0.0:  # only then do linear systems tell about other scales
            before = scale.value
            scale, values = _improve_scale(graph, values, before, sigma_length_scale)
            steady = np.abs(scale.value - before) < _SCALE_TOLERANCE * np.sqrt(np.diag(scale.covariance))
            settled = bool(steady.all())
        if settled:
            break
    pose, covariance = graph.marginals(values, scale.value)
    share = scale.pose_per_scale @ scale.covariance @ scale.pose_per_scale.transpose(0, 2, 1)
    return _Solution(pose, covariance + share, scale)


@dataclass(frozen=True)
class _Solution:
    """Poses (n, 3) of all devices, their covariances (n, 3, 3) in the map frame, and the length scales."""

    pose: Array
    covariance: Array
    scale: _Scale


class _WalkGraph:
    """The graph of a walk at any length scales. Tethers that are tight are distances, the others are left out."""

    def __init__(
        self,
        timelines: Sequence[Timeline],
        ties: Sequence[Tie],
        starts: Sequence[StartPose],
        guesses: Sequence[list[Moments]],
    ) -> None:
        self.keys = Keys.of(timelines)
        self._timelines, self._ties = timelines, ties
        self._tight: frozenset[int] = frozenset()  # numbers of ties
        self._tied = anchors(timelines, self.keys, starts, guesses)
        self._noises = [motion_noise(timeline.nodes) for timeline in timelines]
        self.order = _from_the_end(timelines, self.keys)

    def at(self, length_scale: Array) -> gtsam.NonlinearFactorGraph:
        graph = gtsam.NonlinearFactorGraph(self._tied)
        add_tight(graph, [self._ties[i] for i in sorted(self._tight)], self.keys)
        for timeline, first, noise, scale in zip(
            self._timelines, self.keys.first, self._noises, length_scale, strict=True
        ):
            add_motion(graph, timeline.nodes, first, noise, float(scale))
        return graph

    def initial_values(self, guesses: Sequence[list[Moments]]) -> gtsam.Values:
        values = gtsam.Values()
        for guess, first, reference in zip(guesses, self.keys.first, self.keys.references, strict=True):
            for i, state in enumerate(guess, first):
                values.insert(i, gtsam.Pose2(*state.mean[:3]))
            if reference is not None:
                values.insert(reference, reference_guess(guess))
        return values

    def led_together(self, values: gtsam.Values, length_scale: Array) -> gtsam.Values:
        """Near the optimum with all tethers, by kernels with a dead zone: these tell well which of them are tight,
        but take many iterations to the end."""
        if not self._ties:
            return values
        graph = self.at(length_scale)
        add_tethers(graph, self._ties, self.keys)
        values = _optimise(graph, values, self.order, _LEADING_ITERATIONS)
        self.retie(values)
        return values

    def optimised(self, values: gtsam.Values, length_scale: Array) -> gtsam.Values:
        return _optimise(self.at(length_scale), values, self.order)

    def retie(self, values: gtsam.Values) -> bool:
        """Tighten the tethers that are exceeded and slacken those that push; return whether there were any."""
        position = self.poses(values)[:, :2]
        tight = set()
        for i, tie in enumerate(self._ties):
            a, b = self.keys.of_tie(tie)
            excess_m = float(np.hypot(*(position[a] - position[b]))) - tie.max_distance_m
            if excess_m > (0.0 if i in self._tight else _SLACK_M):
                tight.add(i)
        changed, self._tight = tight != self._tight, frozenset(tight)
        return changed

    def poses(self, values: gtsam.Values) -> Array:
        """Poses (n, 3)."""
        return np.asarray(gtsam.utilities.extractPose2(values)[: self.keys.poses])

    def marginals(self, values: gtsam.Values, length_scale: Array) -> tuple[Array, Array]:
        """Poses (n, 3) and their covariances (n, 3, 3) in the map frame."""
        pose = self.poses(values)
        rotation = to_map(pose[:, 2])
        own = marginal_covariances(self.at(length_scale), values, self.order)[: self.keys.poses]
        return pose, rotation @ own @ rotation.transpose(0, 2, 1)


def _from_the_end(timelines: Sequence[Timeline], keys: Keys) -> list[int]:
    """The variables in the order of elimination: poses from the last to the first, then the references."""
    times = np.concatenate([[node.time_s for node in timeline.nodes] for timeline in timelines])
    latest_first = np.lexsort((np.arange(len(times)), times))[::-1]
    return [*latest_first.tolist(), *keys.present_references]


def _optimise(
    graph: gtsam.NonlinearFactorGraph, values: gtsam.Values, order: Sequence[int], most_iterations: int = 100
) -> gtsam.Values:
    params = gtsam.LevenbergMarquardtParams()
    params.setMaxIterations(most_iterations)
    params.setLinearSolverType("MULTIFRONTAL_QR")
    params.setOrdering(ordering_of(order))
    params.setRelativeErrorTol(1e-6)
    params.setAbsoluteErrorTol(1e-6)
    return gtsam.LevenbergMarquardtOptimizer(graph, values, params).optimize()


def _improve_scale(
    graph: _WalkGraph, values: gtsam.Values, scale: Array, sigma: float
) -> tuple[_Scale, gtsam.Values]:
    """One Newton step on the length scales, and the poses moved along. values: optimum at `scale`; sigma: prior's.

    The least error over the poses is a paraboloid in the scales; a few linear systems give its slope and curvature.
    """
    axes = _SCALE_PROBE * np.eye(len(scale))

    def least_error(offset: Array) -> tuple[float, gtsam.VectorValues]:
        return _least_error(graph.at(scale + offset), values, graph.order)

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
    heading = graph.poses(values)[:, 2]
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
