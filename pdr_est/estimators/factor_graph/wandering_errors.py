"""Position fixes with a wandering error: its variables, their factors, and the linear system of the fixes.

The wandering error of a source, divided by its standard deviation, is a Gauss-Markov process e in each coordinate. It
has one variable for each time at which the source gave a fix, a Point2 that all devices share. The variables of a
source form a chain: the first one has the variance 1, and each later one is a times the one before plus white noise
of the variance 1 - a², with the correlation a of `wander_to`. A fix is then a measurement of the position of a pose
plus σ e with white noise.

GTSAM has no factor of a position and a point that a robust kernel in the map frame could be put on.
`wandering_fix_factor` is therefore a CustomFactor. It calls Python at each evaluation, which would make the estimator
slow: the estimator linearises all fixes of a walk together (`WanderingFixes`), with the same cost.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import partial
from math import sqrt

import gtsam
import numpy as np
from numpy.typing import NDArray

from pdr_est.estimators.common.huber import HUBER
from pdr_est.estimators.common.motion_model import MIN_SIGMA
from pdr_est.estimators.common.timeline import Timeline
from pdr_est.estimators.common.wandering_error import wander_chain
from pdr_est.estimators.factor_graph.factors import fix_noise
from pdr_est.estimators.factor_graph.keys import GraphKeys, pose_array
from pdr_est.estimators.pose_chains.linear_rows import to_map
from pdr_est.frames import Array
from pdr_est.types.measurements import PositionFix

_SMALL = 1e-12  # standard deviations
_UNIT = gtsam.noiseModel.Unit.Create(2)


@dataclass(frozen=True)
class WanderingFixes:
    """The m fixes with a wandering error, at the poses that they are measurements of, with v variables in all.

    Attributes
    ----------
    keys : GraphKeys
        Keys of the walk's variables.
    fixes : tuple of PositionFix
        The fixes; one that n devices have appears n times.
    pose : (m,) array of int
        Key of the pose of each.
    error : (m,) array of int
        Number of its wandering error, 0 … v - 1.
    position_m : (m, 2) array
        Measured positions.
    sigma_m : (m,) array
        Standard deviation of the wandering errors, m.
    whitening : (m, 2, 2) array
        Matrices that turn white errors in metres into standard deviations.
    threshold : (m,) array
        Length of the white error in standard deviations from which on Huber's kernel is linear.
    """

    keys: GraphKeys = field(repr=False)
    fixes: tuple[PositionFix, ...] = field(repr=False)
    pose: NDArray[np.int64]
    error: NDArray[np.int64]
    position_m: Array
    sigma_m: Array
    whitening: Array
    threshold: Array

    @classmethod
    def of_timelines(cls, timelines: Sequence[Timeline], keys: GraphKeys) -> "WanderingFixes":
        """List the fixes of all devices that have a wandering error."""
        number = {known: i for i, known in enumerate(keys.fix_errors)}
        uses = [
            (key, number[fix.source, fix.time_s], fix)
            for timeline, first in zip(timelines, keys.first, strict=True)
            for key, node in enumerate(timeline.nodes, first)
            for fix in node.fixes
            if fix.sigma_wander_m > 0.0
        ]
        fixes = tuple(fix for _, _, fix in uses)
        covariance = np.array([fix.covariance_m2 for fix in fixes], dtype=np.float64).reshape(-1, 2, 2)
        error = np.array([error for _, error, _ in uses], dtype=np.int64)
        return cls(
            keys,
            fixes,
            np.array([key for key, _, _ in uses], dtype=np.int64),
            error,
            np.array([fix.position_m for fix in fixes], dtype=np.float64).reshape(-1, 2),
            _chain(keys, fixes, error)[1][error],
            np.linalg.inv(np.linalg.cholesky(covariance)),
            np.array([HUBER if fix.robust else np.inf for fix in fixes]),
        )

    def __len__(self) -> int:
        """Return the number m of fixes, as often as devices have them."""
        return len(self.fixes)

    def earliest_pose_s(self, pose_time_s: Array) -> Array:
        """Return the time (v,) of the earliest pose that each wandering error belongs to, from those of all poses."""
        earliest_s = np.full(len(self.keys.fix_errors), np.inf)
        np.minimum.at(earliest_s, self.error, pose_time_s[self.pose])
        return earliest_s

    def chains(self) -> gtsam.NonlinearFactorGraph:
        """Return the factors of the Gauss-Markov processes of all sources."""
        graph, correlation = gtsam.NonlinearFactorGraph(), _chain(self.keys, self.fixes, self.error)[0]
        first = self.keys.first_fix_error
        origin = zero_errors(range(first, first + len(correlation)))
        for i, (one, (source, _)) in enumerate(zip(correlation.tolist(), self.keys.fix_errors, strict=True)):
            if i and self.keys.fix_errors[i - 1][0] == source:
                graph.add(gauss_markov_factor(first + i - 1, first + i, one, origin))
            else:
                graph.add(stationary_error(first + i))
        return graph

    def factors(self) -> gtsam.NonlinearFactorGraph:
        """Return one factor for each fix, for solving with GTSAM."""
        graph, first = gtsam.NonlinearFactorGraph(), self.keys.first_fix_error
        uses = zip(self.pose.tolist(), self.error.tolist(), self.sigma_m.tolist(), self.fixes, strict=True)
        for pose, error, sigma_m, fix in uses:
            graph.add(wandering_fix_factor(pose, first + error, fix, sigma_m))
        return graph

    def changes(self, change: gtsam.VectorValues) -> Array:
        """Return the changes (v, 2) of the wandering errors."""
        before = 3 * self.keys.first_fix_error
        return np.asarray(change.vector()[before : before + 2 * len(self.keys.fix_errors)].reshape(-1, 2))

    def cost(self, values: gtsam.Values) -> float:
        """Return the error of all fixes, half their chi square where no kernel applies."""
        distance = np.linalg.norm(self._white(values, pose_array(values, self.keys.poses)), axis=1)
        beyond = np.minimum(distance, self.threshold)
        return float(np.sum(beyond * (distance - 0.5 * beyond)))

    def linear_factors(self, values: gtsam.Values) -> gtsam.GaussianFactorGraph:
        """Linearise all fixes, with the weights of Huber's kernel at some values."""
        pose = pose_array(values, self.keys.poses)
        white = self._white(values, pose)
        distance = np.linalg.norm(white, axis=1)
        root_weight = np.sqrt(np.minimum(self.threshold / np.maximum(distance, _SMALL), 1.0))
        by_error = (root_weight * self.sigma_m)[:, None, None] * self.whitening
        by_pose = root_weight[:, None, None] * self.whitening @ to_map(pose[self.pose, 2])[:, :2, :]
        keys = zip(self.pose.tolist(), (self.keys.first_fix_error + self.error).tolist(), strict=True)
        graph = gtsam.GaussianFactorGraph()
        for (key, error), own, wander, left in zip(
            keys, by_pose, by_error, -root_weight[:, None] * white, strict=True
        ):
            graph.add(gtsam.JacobianFactor(key, own, error, wander, left, _UNIT))
        return graph

    def _white(self, values: gtsam.Values, pose: Array) -> Array:
        """Return the white errors (m, 2) in standard deviations."""
        errors = np.asarray(gtsam.utilities.extractPoint2(values)).reshape(-1, 2)
        apart = pose[self.pose, :2] + self.sigma_m[:, None] * errors[self.error] - self.position_m
        return np.asarray(np.einsum("mij,mj->mi", self.whitening, apart))


@dataclass(frozen=True)
class WalkFactors:
    """Factor graph whose fixes with a wandering error are linearised together.

    Attributes
    ----------
    graph : gtsam.NonlinearFactorGraph
        All other factors.
    fixes : WanderingFixes
        The fixes.
    """

    graph: gtsam.NonlinearFactorGraph = field(repr=False)
    fixes: WanderingFixes

    def error(self, values: gtsam.Values) -> float:
        """Return the error at some values."""
        return float(self.graph.error(values)) + (self.fixes.cost(values) if len(self.fixes) else 0.0)

    def linearize(self, values: gtsam.Values) -> gtsam.GaussianFactorGraph:
        """Return the linear system at some values."""
        linear = self.graph.linearize(values)
        if len(self.fixes):
            linear.push_back(self.fixes.linear_factors(values))
        return linear


def zero_errors(keys: Iterable[int]) -> gtsam.Values:
    """Return wandering errors of zero, the expected ones."""
    values = gtsam.Values()
    for key in keys:
        values.insert(key, np.zeros(2))
    return values


def stationary_error(key: int) -> gtsam.PriorFactorPoint2:
    """Make the factor of the first error of a source."""
    return gtsam.PriorFactorPoint2(key, np.zeros(2), _UNIT)


def gauss_markov_factor(
    before: int, key: int, correlation: float, origin: gtsam.Values
) -> gtsam.LinearContainerFactor:
    """Make the factor of the transition from one error of a source to the next one.

    Parameters
    ----------
    before, key : int
        Keys of the earlier and the later error.
    correlation : float
        Correlation of the two, 0 to 1.
    origin : gtsam.Values
        Values in which both errors are zero.
    """
    sigma = max(sqrt(1.0 - correlation**2), MIN_SIGMA)
    transition = (key, np.eye(2) / sigma, before, -correlation / sigma * np.eye(2))
    return gtsam.LinearContainerFactor(gtsam.JacobianFactor(*transition, np.zeros(2), _UNIT), origin)


def wandering_fix_factor(pose: int, error: int, fix: PositionFix, sigma_m: float) -> gtsam.CustomFactor:
    """Make the factor of a fix: position of the pose + sigma_m · error = measured position + white noise."""
    return gtsam.CustomFactor(fix_noise(fix), [pose, error], partial(_off_fix, fix.position_m, sigma_m))


def _off_fix(
    position_m: Array,
    sigma_m: float,
    factor: gtsam.CustomFactor,
    values: gtsam.Values,
    jacobians: list[Array] | None,
) -> Array:
    """Return the white error (2,) of a fix at some values, m, and set its Jacobians if they are wanted."""
    key, error_key = factor.keys()
    pose, error = values.atPose2(key), values.atPoint2(error_key)
    if jacobians is not None:
        jacobians[0] = to_map(np.array([pose.theta()]))[0, :2]
        jacobians[1] = sigma_m * np.eye(2)
    return np.asarray(pose.translation() + sigma_m * error - position_m)


def _chain(keys: GraphKeys, fixes: Sequence[PositionFix], error: NDArray[np.int64]) -> tuple[Array, Array]:
    """Return the correlation (v,) of each wandering error with the one before, and its standard deviation (v,), m."""
    of_error = dict(zip(error.tolist(), fixes, strict=True))
    correlation, sigma_m = np.zeros(len(keys.fix_errors)), np.zeros(len(keys.fix_errors))
    for source in dict.fromkeys(name for name, _ in keys.fix_errors):
        own = [i for i, (name, _) in enumerate(keys.fix_errors) if name == source]
        correlation[own], sigma_m[own] = wander_chain([of_error[i] for i in own])
    return correlation, sigma_m
