"""Walk graph."""

from collections.abc import Sequence
from dataclasses import dataclass

import gtsam
import numpy as np

from pdr_est.estimators.common.motion_model import GaussianState
from pdr_est.estimators.common.tethers import NodeTether
from pdr_est.estimators.common.timeline import Timeline
from pdr_est.estimators.factor_graph.cutting_planes import BetweenStepConstraints
from pdr_est.estimators.factor_graph.factors import Keys, add_motion, anchors, motion_noise, reference_guess
from pdr_est.estimators.factor_graph.marginals import marginal_covariances, to_map
from pdr_est.estimators.factor_graph.newton import Variables, linearised, minimised
from pdr_est.estimators.factor_graph.tether_constraints import TetherConstraints
from pdr_est.frames import Array
from pdr_est.types.measurements import StartPose


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


class _WalkGraph:
    """The graph of a walk at any length scales."""

    def __init__(
        self,
        timelines: Sequence[Timeline],
        node_tethers: Sequence[NodeTether],
        starts: Sequence[StartPose],
        guesses: Sequence[list[GaussianState]],
    ) -> None:
        self.keys = Keys.of(timelines)
        self._timelines = timelines
        self._tied = anchors(timelines, self.keys, starts, guesses)
        self._noises = [motion_noise(timeline.nodes) for timeline in timelines]
        self._at: tuple[Array, gtsam.NonlinearFactorGraph] | None = None
        self.tethers, self.softening = TetherConstraints.of(node_tethers, self.keys), 1.0
        self._holding = BetweenStepConstraints.of(timelines, node_tethers, self.keys)
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

    def initial_values(self, guesses: Sequence[list[GaussianState]]) -> gtsam.Values:
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
