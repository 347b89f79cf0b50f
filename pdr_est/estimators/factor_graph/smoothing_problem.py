"""The optimisation problem of a walk: its factor graph at any length scales, with its tethers."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import gtsam
import numpy as np

from pdr_est.estimators.common.motion_model import GaussianState
from pdr_est.estimators.common.tethers import NodeTether
from pdr_est.estimators.common.timeline import Timeline
from pdr_est.estimators.factor_graph.cutting_planes import BetweenStepConstraints
from pdr_est.estimators.factor_graph.factors import (
    MotionNoise,
    add_anchors,
    add_motion,
    initial_reference,
    motion_noise,
)
from pdr_est.estimators.factor_graph.keys import GraphKeys, is_auxiliary, pose_array, values_of_poses
from pdr_est.estimators.factor_graph.newton import LinearSystem, Variables, linear_system, minimised
from pdr_est.estimators.factor_graph.tether_factors import tether_factors
from pdr_est.estimators.factor_graph.wandering_errors import WalkFactors, WanderingFixes, zero_errors
from pdr_est.estimators.pose_chains.newton_on_arrays import ChainProblem, minimised_poses
from pdr_est.estimators.pose_chains.normal_equations import Elimination, NotBandedError
from pdr_est.estimators.pose_chains.pose_chains import PoseChains, linearised_rows
from pdr_est.estimators.pose_chains.tether_constraints import TetherConstraints
from pdr_est.frames import Array, wrap_angle
from pdr_est.types.measurements import PositionFix, StartPose

_MOST_ABSOLUTE = 10_000  # poses of a walk with reference directions up to which absolute positions are cheaper; ours

Point = gtsam.Values | Array
"""Values of all variables, or poses and references (n, 3) of a walk that has no other ones."""


def as_values(at: Point) -> gtsam.Values:
    """Return the values of a point."""
    return values_of_poses(at) if isinstance(at, np.ndarray) else at


@dataclass(frozen=True)
class LengthScales:
    """Length scales of d devices, true over modelled step length.

    Attributes
    ----------
    value : (d,) array
        The scales.
    log_covariance : (d, d) array
        Covariance of their logarithms.
    pose_per_log : (n, 3, d) array
        Derivative of the optimal poses with respect to the logarithms, in the map frame.
    fix_error_per_log : (v, 2, d) array
        Derivative of the optimal wandering errors of fixes.
    """

    value: Array
    log_covariance: Array
    pose_per_log: Array
    fix_error_per_log: Array

    @classmethod
    def known(cls, value: Array, keys: GraphKeys) -> "LengthScales":
        """Return scales without uncertainty."""
        d = len(value)
        return cls(value, np.zeros((d, d)), np.zeros((keys.poses, 3, d)), np.zeros((len(keys.fix_errors), 2, d)))

    @property
    def pose_covariance(self) -> Array:
        """Share (n, 3, 3) of the scales in the covariance of the poses, in the map frame."""
        share: Array = self.pose_per_log @ self.log_covariance @ self.pose_per_log.transpose(0, 2, 1)
        return share

    def of_device(self, number: int) -> tuple[float, float]:
        """Return the scale of a device and its standard deviation, to first order."""
        value = float(self.value[number])
        return value, value * float(np.sqrt(self.log_covariance[number, number]))


class SmoothingProblem:
    """Factor graph of a walk at any length scales, with tethers that are added and stiffened on the way."""

    def __init__(
        self,
        timelines: Sequence[Timeline],
        node_tethers: Sequence[NodeTether],
        starts: Sequence[StartPose],
        initial: Sequence[Sequence[GaussianState]],
    ) -> None:
        self.timelines = tuple(timelines)
        self.keys = GraphKeys.of_timelines(timelines)
        self._starts, self._initial = starts, initial
        self.wandering = WanderingFixes.of_timelines(timelines, self.keys)
        self._at: tuple[Array, WalkFactors] | None = None
        self.tethers, self.softening = TetherConstraints.between_nodes(node_tethers, self.keys.first), 1.0
        self._candidates = BetweenStepConstraints.of_timelines(timelines, node_tethers, self.keys)
        self.variables = Variables.of_timelines(timelines, self.keys, self.wandering)
        self._chains = _Chains.of_walk(self.timelines, self.keys, self.variables, starts, initial)
        # Tethers alone would only shrink the walk: tracks that disagree are closer to each other when all is smaller.
        self.scale_is_observable = any(one.fixes or one.closure_sigma_m is not None for one in timelines)

    @cached_property
    def _anchors(self) -> gtsam.NonlinearFactorGraph:
        """Factors of everything but motions, fixes with wandering errors and tethers."""
        graph = gtsam.NonlinearFactorGraph()
        add_anchors(graph, self.timelines, self.keys, self._starts, self._initial)
        graph.push_back(self.wandering.chains())
        return graph

    @cached_property
    def _noises(self) -> list[MotionNoise]:
        return [motion_noise(timeline.nodes) for timeline in self.timelines]

    def without_tethers(self, length_scale: Array) -> WalkFactors:
        """Return all factors but the tethers, at length scales (d,)."""
        if self._at is None or not np.array_equal(self._at[0], length_scale):
            graph = gtsam.NonlinearFactorGraph(self._anchors)
            for timeline, first, noise, scale in zip(
                self.timelines, self.keys.first, self._noises, length_scale, strict=True
            ):
                add_motion(graph, timeline.nodes, first, noise.models, float(scale))
            self._at = length_scale, WalkFactors(graph, self.wandering)
        return self._at[1]

    def complete(self, values: gtsam.Values, length_scale: Array) -> tuple[gtsam.NonlinearFactorGraph, gtsam.Values]:
        """Return the graph with the factors of the tethers that are active at some values, and its values.

        Parameters
        ----------
        values : gtsam.Values
            Values of all variables but those of tethers.
        length_scale : (d,) array
            Length scales of the devices.

        Returns
        -------
        graph : gtsam.NonlinearFactorGraph
            A graph of its own, with every measurement.
        complete_values : gtsam.Values
            The values, and those of the auxiliary variables of tethers.
        """
        graph, pose = gtsam.NonlinearFactorGraph(self.without_tethers(length_scale).graph), self.poses(values)
        graph.push_back(self.wandering.factors())
        tethers = self.tethers.softened(self.softening)
        made = tether_factors(tethers, tethers.linearised(pose).violation_m > 0.0, pose)
        graph.push_back(made.graph)
        complete_values = gtsam.Values(values)
        complete_values.insert(made.auxiliary)
        return graph, complete_values

    def motion_information(self) -> Array:
        """Return the information (d,) on each length scale if the poses were known: sum of (length / sigma)²."""
        lengths_m = [np.array([node.length_m for node in timeline.nodes[1:]]) for timeline in self.timelines]
        return np.array(
            [np.sum(own_m**2 * noise.information_ahead) for own_m, noise in zip(lengths_m, self._noises, strict=True)]
        )

    def initial_values(self, initial: Sequence[Sequence[GaussianState]]) -> gtsam.Values:
        """Return values of poses and references from the initial states of each device, and errors of zero."""
        first_error = self.keys.first_fix_error
        values = zero_errors(range(first_error, first_error + len(self.keys.fix_errors)))
        for states, first, reference in zip(initial, self.keys.first, self.keys.references, strict=True):
            for i, state in enumerate(states, first):
                values.insert(i, gtsam.Pose2(*state.mean[:3]))
            if reference is not None:
                values.insert(reference, initial_reference(states))
        return values

    def initial_point(self, initial: Sequence[Sequence[GaussianState]]) -> Point:
        """Return `initial_values`, as an array where the optimum is found on arrays at known length scales."""
        if self._chains is None or self.scale_is_observable:
            return self.initial_values(initial)
        poses = [np.array([state.mean[:3] for state in states]) for states in initial]
        pairs = zip(initial, self.keys.references, strict=True)
        references = [initial_reference(states) for states, key in pairs if key is not None]
        return np.concatenate([*poses, *([[one.x(), one.y(), one.theta()]] for one in references)])

    def optimised(self, at: Point, length_scale: Array, tolerance: float) -> Point:
        """Return the optimum at given length scales (`newton.minimised`), as an array if it begins with one.

        Where all measurements connect neighbours in time, the same steps are made without GTSAM.
        """
        tethers = self.tethers.softened(self.softening)
        if self._chains is not None:
            try:
                pose = self._chains.optimised(self._all_poses(at), tethers, length_scale, tolerance)
                return pose if isinstance(at, np.ndarray) else values_of_poses(pose)
            except NotBandedError:
                self._chains = None
        return minimised(self.without_tethers(length_scale), tethers, as_values(at), self.variables, tolerance)

    def banded_marginals(self, at: Point, length_scale: Array) -> tuple[Array, Array] | None:
        """Return the poses (n, 3) and their covariances (n, 3, 3) without GTSAM; None if positions are measured."""
        if self._chains is None:
            return None
        tethers = self.tethers.softened(self.softening)
        try:
            covariance = self._chains.covariances(self._all_poses(at), tethers, length_scale)
        except NotBandedError:
            return None
        found = self.poses(at).copy()
        found[:, 2] = wrap_angle(found[:, 2])
        return found, covariance

    def linear(self, values: gtsam.Values, length_scale: Array, with_stiffness: bool = True) -> LinearSystem:
        """Return the linear system of Newton's method at some values (`newton.linear_system`)."""
        tethers = self.tethers.softened(self.softening)
        return linear_system(self.without_tethers(length_scale), tethers, values, self.variables, with_stiffness)

    def add_violated_tethers(self, at: Point) -> bool:
        """Add tethers where tracks are too far apart between the given ones; return whether any were added."""
        more, self._candidates = self._candidates.most_violated(self.poses(at))
        self.tethers = self.tethers + more
        return len(more) > 0

    def fixes(self) -> list[tuple[int, PositionFix]]:
        """List the fixes of all devices, each with the key of the pose that it is a measurement of."""
        return [
            (key, fix)
            for timeline, first in zip(self.timelines, self.keys.first, strict=True)
            for key, node in enumerate(timeline.nodes, first)
            for fix in node.fixes
        ]

    def further_variables(self, variables: gtsam.NonlinearFactorGraph | gtsam.Values) -> tuple[list[int], list[int]]:
        """Return the keys that are not in `variables`: auxiliary ones of tethers, and all others."""
        keys = variables.keyVector() if isinstance(variables, gtsam.NonlinearFactorGraph) else variables.keys()
        further = [key for key in keys if key >= len(self.variables.order)]
        auxiliary = [key for key in further if is_auxiliary(key)]
        return auxiliary, sorted(set(further) - set(auxiliary))

    def poses(self, at: Point) -> Array:
        """Return the poses (n, 3)."""
        return at[: self.keys.poses] if isinstance(at, np.ndarray) else self.variables.pose(at)

    def _all_poses(self, at: Point) -> Array:
        """Return poses and references."""
        return at if isinstance(at, np.ndarray) else pose_array(at, len(self.variables.order))

    def prior_scales(self, at: Point, length_scale: Array, sigma: float) -> LengthScales:
        """Return the scales of a walk without position measurements: sigma is that of the logarithm in the prior."""
        heading = self.poses(at)[:, 2]
        moved = np.zeros((self.keys.poses, 3, len(length_scale)))
        for d, (timeline, first) in enumerate(zip(self.timelines, self.keys.first, strict=True)):
            length_m, turn_rad = np.array([[node.length_m, node.heading_change_rad] for node in timeline.nodes]).T
            ahead = heading[first : first + len(length_m) - 1] + turn_rad[1:]
            steps = length_m[1:, None] * np.stack([np.cos(ahead), np.sin(ahead)], axis=1)
            moved[first + 1 : first + len(length_m), :2, d] = length_scale[d] * np.cumsum(steps, axis=0)
        known = LengthScales.known(length_scale, self.keys)
        return replace(known, log_covariance=sigma**2 * np.eye(len(length_scale)), pose_per_log=moved)


@dataclass(frozen=True)
class _Chains:
    """Arrays of a walk without closures and wandering errors; with fixes there is no `relative` elimination."""

    chains: PoseChains
    elimination: Elimination
    relative: Elimination | None
    variables: Variables

    @classmethod
    def of_walk(
        cls,
        timelines: Sequence[Timeline],
        keys: GraphKeys,
        variables: Variables,
        starts: Sequence[StartPose],
        initial: Sequence[Sequence[GaussianState]],
    ) -> "_Chains | None":
        """Make the arrays of a walk; None if it does not fit."""
        if keys.fix_errors or any(one.closure_sigma_m is not None for one in timelines):
            return None
        chains = PoseChains.of_timelines(timelines, keys.first, keys.references, starts, initial)
        border = len(keys.present_references)
        relative = None if any(one.fixes for one in timelines) else Elimination(variables.order, border, True)
        short = border > 0 and keys.poses <= _MOST_ABSOLUTE
        absolute = Elimination(variables.order, border) if relative is None or short else relative
        return cls(chains, absolute, relative, variables)

    def optimised(self, pose: Array, tethers: TetherConstraints, length_scale: Array, tolerance: float) -> Array:
        """Return the optimal poses and references (n, 3), beginning with some."""
        residuals = self.chains.at_scales(length_scale)
        problem = ChainProblem(residuals, tethers, self.elimination, self.variables.retraction)
        return minimised_poses(problem, pose, tolerance)

    def covariances(self, pose: Array, tethers: TetherConstraints, length_scale: Array) -> Array:
        """Return the covariances (n, 3, 3) of the poses, linearised at some (n, 3)."""
        if self.relative is None:
            raise NotBandedError("positions are measured")
        rows = linearised_rows(self.chains.at_scales(length_scale), pose)
        if len(tethers):
            near = tethers.linearised(pose)
            rows += near.rows(near.violation_m > 0.0, 0.0 * near.violation_m)
        return self.relative.covariances(self.relative.equations(rows, pose[:, 2]))
