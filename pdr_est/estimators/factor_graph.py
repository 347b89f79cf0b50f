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

import gtsam
import numpy as np

from pdr_est.errors import EstimationError
from pdr_est.estimators.graph_start import initial_states
from pdr_est.estimators.gtsam_factors import Keys, add_motion, anchors, motion_noise, reference_guess
from pdr_est.estimators.gtsam_marginals import in_map, marginal_covariances, to_map
from pdr_est.estimators.gtsam_newton import (
    EXACTLY,
    EXACTLY_TETHERED,
    ROUGHLY,
    SOFTENINGS,
    SOFTLY,
    Variables,
    linearised,
    minimised,
)
from pdr_est.estimators.gtsam_tethers import Tethers
from pdr_est.estimators.holding import Holding
from pdr_est.estimators.large_stack import with_large_stack
from pdr_est.estimators.motion import Moments
from pdr_est.estimators.ties import Tie, starts_of, ties_between
from pdr_est.estimators.timeline import Timeline, track_from_nodes
from pdr_est.frames import Array
from pdr_est.records import DeviceTether, StartPose
from pdr_est.track import Track, concatenate

NAME = "factor-graph"
_LARGE_STACK_NODES = 5_000  # GTSAM's elimination recurses
_SCALE_PROBE = 0.05  # how far from the scale the neighbouring systems are; of no influence, they are linear
_ROUNDS, _SOFT_ROUNDS = 30, 2  # of finding the scales, with tethers as they are and while they are soft
_HOLD_ROUNDS = 6  # of adding tethers where tracks part in between
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


def _solve(graph: "_WalkGraph", guesses: Sequence[list[Moments]], sigma_length_scale: float) -> "_Solution":
    """The optimum over poses and length scales, and its covariances."""
    expected = [guess[-1].mean[3] if graph.tells_scale else 1.0 for guess in guesses]
    scale = _Scale.without_effect(np.array(expected), graph.keys.poses)
    values = graph.initial_values(guesses)
    for softening in SOFTENINGS[:-1] if len(graph.tethers) else ():
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


def _at_scale(
    graph: "_WalkGraph", values: gtsam.Values, scale: _Scale, sigma: float, least_promise: float, rounds: int
) -> tuple[_Scale, gtsam.Values]:
    """The poses near the optimum, and the length scales if anything tells them."""
    values = graph.optimised(values, scale.value, least_promise)
    return _with_scale(graph, values, scale, sigma, rounds) if sigma > 0.0 and graph.tells_scale else (scale, values)


def _with_scale(
    graph: "_WalkGraph", values: gtsam.Values, scale: _Scale, sigma: float, rounds: int
) -> tuple[_Scale, gtsam.Values]:
    """The length scales and the poses near the optimum of both, after so many rounds at most."""
    for _ in range(rounds):
        before = scale.value
        scale, values = _improve_scale(graph, values, before, sigma)
        if np.all(np.abs(scale.value - before) < _SCALE_TOLERANCE * np.sqrt(np.diag(scale.covariance))):
            break
        values = graph.optimised(values, scale.value, ROUGHLY)
    return scale, values


@dataclass(frozen=True)
class _Solution:
    """Poses (n, 3) of all devices, their covariances (n, 3, 3) in the map frame, and the length scales."""

    pose: Array
    covariance: Array
    scale: _Scale


class _WalkGraph:
    """The graph of a walk at any length scales."""

    def __init__(
        self,
        timelines: Sequence[Timeline],
        ties: Sequence[Tie],
        starts: Sequence[StartPose],
        guesses: Sequence[list[Moments]],
    ) -> None:
        self.keys = Keys.of(timelines)
        self._timelines = timelines
        self._tied = anchors(timelines, self.keys, starts, guesses)
        self._noises = [motion_noise(timeline.nodes) for timeline in timelines]
        self._at: tuple[Array, gtsam.NonlinearFactorGraph] | None = None
        self.tethers, self.softening = Tethers.of(ties, self.keys), 1.0
        self._holding = Holding.of(timelines, ties, self.keys)
        self.variables = Variables.of(timelines, self.keys)
        # Tethers alone would only shrink the walk: tracks that disagree are nearer to each other when all is smaller.
        self.tells_scale = any(one.fixes or one.closure_sigma_m is not None for one in timelines)

    def at(self, length_scale: Array) -> gtsam.NonlinearFactorGraph:
        """All factors but the tethers."""
        if self._at is None or not np.array_equal(self._at[0], length_scale):
            graph = gtsam.NonlinearFactorGraph(self._tied)
            for timeline, first, noise, scale in zip(
                self._timelines, self.keys.first, self._noises, length_scale, strict=True
            ):
                add_motion(graph, timeline.nodes, first, noise.models, float(scale))
            self._at = length_scale, graph
        return self._at[1]

    def motion_per_scale(self) -> Array:
        """Sum of the squares (d,) of what the lengths of each device's steps are in sigmas."""
        lengths_m = [np.array([node.length_m for node in timeline.nodes[1:]]) for timeline in self._timelines]
        return np.array(
            [np.sum(own_m**2 * noise.information_ahead) for own_m, noise in zip(lengths_m, self._noises, strict=True)]
        )

    def initial_values(self, guesses: Sequence[list[Moments]]) -> gtsam.Values:
        values = gtsam.Values()
        for guess, first, reference in zip(guesses, self.keys.first, self.keys.references, strict=True):
            for i, state in enumerate(guess, first):
                values.insert(i, gtsam.Pose2(*state.mean[:3]))
            if reference is not None:
                values.insert(reference, reference_guess(guess))
        return values

    def optimised(self, values: gtsam.Values, length_scale: Array, least_promise: float) -> gtsam.Values:
        return minimised(
            self.at(length_scale), self.tethers.softened(self.softening), values, self.variables, least_promise
        )

    def linear(self, values: gtsam.Values, length_scale: Array, resisting: bool) -> gtsam.GaussianFactorGraph:
        tethers = self.tethers.softened(self.softening)
        return linearised(self.at(length_scale), tethers, values, self.variables, resisting)

    def held(self, values: gtsam.Values) -> bool:
        """Whether tethers were added where the tracks part in between."""
        more, self._holding = self._holding.exceeded(self.poses(values))
        self.tethers = self.tethers + more
        return len(more) > 0

    def poses(self, values: gtsam.Values) -> Array:
        """Poses (n, 3)."""
        return self.variables.pose(values)

    def untold_scale(self, values: gtsam.Values, length_scale: Array, sigma: float) -> _Scale:
        """Of a walk in which no position is measured: sigma is the prior's, and each pose moves with the steps up to
        it."""
        heading = self.poses(values)[:, 2]
        moved = np.zeros((self.keys.poses, 3, len(length_scale)))
        for d, (timeline, first) in enumerate(zip(self._timelines, self.keys.first, strict=True)):
            length_m, turn_rad = np.array([[node.length_m, node.heading_change_rad] for node in timeline.nodes]).T
            ahead = heading[first : first + len(length_m) - 1] + turn_rad[1:]
            steps = length_m[1:, None] * np.stack([np.cos(ahead), np.sin(ahead)], axis=1)
            moved[first + 1 : first + len(length_m), :2, d] = np.cumsum(steps, axis=0)
        return _Scale(length_scale, sigma**2 * np.eye(len(length_scale)), moved)

    def marginals(self, values: gtsam.Values, length_scale: Array) -> tuple[Array, Array]:
        """Poses (n, 3) and their covariances (n, 3, 3) in the map frame."""
        pose = self.poses(values)
        rotation = to_map(pose[:, 2])
        linear = self.linear(values, length_scale, resisting=False)
        own = marginal_covariances(linear, self.variables.order)[: self.keys.poses]
        return pose, rotation @ own @ rotation.transpose(0, 2, 1)


def _improve_scale(
    graph: _WalkGraph, values: gtsam.Values, scale: Array, sigma: float
) -> tuple[_Scale, gtsam.Values]:
    """One Newton step on the length scales, and the poses moved along. values: optimum at `scale`; sigma: prior's.

    The error of a linear system with the lengths of a device scaled is quadratic in their scale, with a known bend
    (`motion_per_scale`), so that its values at two scales give the slope. The least error over the poses has the same
    slope as that of the optimum's poses, and bends by how the slope changes as the poses follow.
    """
    here, change = _solved(graph, values, scale)
    others = [_solved(graph, values, scale + axis) for axis in _SCALE_PROBE * np.eye(len(scale))]
    direct = graph.motion_per_scale()

    def slopes(at: gtsam.VectorValues) -> Array:
        differences = [(there.error(at) - here.error(at)) / _SCALE_PROBE for there, _ in others]
        return np.array(differences) - 0.5 * _SCALE_PROBE * direct

    slope: Array = slopes(change)
    bend = np.array([(slopes(followed) - slope) / _SCALE_PROBE for _, followed in others]) + np.diag(direct)
    curvature = _not_concave(0.5 * (bend + bend.T)) + np.eye(len(scale)) / sigma**2
    step: Array = np.asarray(-np.linalg.solve(curvature, slope + (scale - 1.0) / sigma**2))
    per_scale = [followed.subtract(change).scale(1.0 / _SCALE_PROBE) for _, followed in others]
    for amount, direction in zip(step, per_scale, strict=True):
        change = change.add(direction.scale(float(amount)))
    heading = graph.poses(values)[:, 2]
    moved: Array = np.stack([in_map(direction, heading) for direction in per_scale], axis=2)
    improved = _Scale(np.asarray(scale + step), np.asarray(np.linalg.inv(curvature)), moved)
    return improved, values.retract(change)


def _not_concave(bend: Array) -> Array:
    """The symmetric matrix (d, d) without what rounding may have made negative."""
    variance, axes = np.linalg.eigh(bend)
    return np.asarray((axes * np.maximum(variance, 0.0)) @ axes.T)


def _solved(
    graph: _WalkGraph, values: gtsam.Values, scale: Array
) -> tuple[gtsam.GaussianFactorGraph, gtsam.VectorValues]:
    """The graph at some length scales, linear about `values`, and the change of the variables of least error."""
    linear = graph.linear(values, scale, resisting=True)
    return linear, linear.eliminateSequential(graph.variables.ordering, gtsam.EliminateQR).optimize()
