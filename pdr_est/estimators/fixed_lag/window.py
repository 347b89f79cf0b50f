"""Keep the window of the fixed-lag smoother: the poses of the last seconds in IncrementalFixedLagSmoother."""

from collections import deque
from collections.abc import Sequence
from typing import Any

import gtsam
import numpy as np

from pdr_est.errors import EstimationError
from pdr_est.estimators.common.motion_model import LOG_SCALE, MIN_SIGMA, STATES
from pdr_est.estimators.common.tethers import NodeTether, PairTether
from pdr_est.estimators.factor_graph.factors import add_measurements, displacement, motion_noise
from pdr_est.estimators.fixed_lag.params import FixedLagParams
from pdr_est.estimators.fixed_lag.window_entries import FilteredNode, LaggedPose
from pdr_est.estimators.fixed_lag.window_errors import WindowErrors
from pdr_est.estimators.fixed_lag.window_prior import (
    ConditionalPrior,
    device_state,
    log_scales,
    of_entering,
    pose_per_scale,
    prior_factors,
)
from pdr_est.estimators.pose_chains.linear_rows import to_map

_SCALE_TOLERANCE = 0.1  # in units of the scale's sigma; a larger change of the scale needs a new window
_RELINEARISE = 1e-3  # m and rad
_ITERATIONS = 3  # additional ones after adding a tether, and at the end


class LagWindow:
    """Fixed-lag window that takes EKF results in order of time and returns each pose a lag later.

    A pickled window keeps its input; the smoother is rebuilt from it, which changes results slightly by other
    linearisation points.

    Methods raise EstimationError if a window has no unique solution.
    """

    def __init__(self, parameters: FixedLagParams) -> None:
        self._lag_s = parameters.lag_s
        self._waiting: deque[FilteredNode] = deque()  # items whose poses were not returned yet
        self._relative: set[int] = set()  # devices with headings relative to a reference
        self._graph: _Graph | None = None

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_graph": None}

    def push(self, item: FilteredNode) -> list[LaggedPose]:
        """Add an item and return the poses that are more than the lag before it."""
        ready = self.until(item.node.time_s - self._lag_s)
        new_reference = item.device not in self._relative and any(prior.relative for prior in item.node.priors)
        if new_reference:
            self._relative.add(item.device)
        self._waiting.append(item)
        if self._graph is None or new_reference or self._graph.outdated_by(item):
            self._graph = self._rebuilt()
            return ready
        try:
            self._graph.add(item)
        except (RuntimeError, ValueError):
            # GTSAM's incremental smoother occasionally loses track of its variables; a new one has not.
            self._graph = self._rebuilt()
        return ready

    def _rebuilt(self) -> "_Graph":
        try:
            return _Graph(self._lag_s, self._waiting, self._relative)
        except (RuntimeError, ValueError) as error:
            raise _no_solution(error) from error

    def undo(self, count: int) -> None:
        """Remove the last `count` items, which will come again in another form; returned poses stay as they are."""
        for _ in range(min(count, len(self._waiting))):
            self._waiting.pop()
        self._graph = None

    def until(self, time_s: float) -> list[LaggedPose]:
        """Return the poses before a time that were not returned yet, from the measurements so far."""
        ready = []
        while self._waiting and self._waiting[0].node.time_s < time_s:
            graph = self._built()
            ready.append(graph.pose_of(self._waiting[0], len(self._waiting)))
            self._waiting.popleft()
        return ready

    def flush(self) -> list[LaggedPose]:
        """Return all remaining poses at the end of a walk."""
        if self._waiting:
            self._built().iterate()
        return self.until(np.inf)

    def _built(self) -> "_Graph":
        if self._graph is None:  # after a pickle
            self._graph = self._rebuilt()
        return self._graph


class _Graph:
    """Smoother of a window at fixed length scales: it begins with a prior from the EKF and grows node by node."""

    def __init__(self, lag_s: float, items: Sequence[FilteredNode], relative: set[int]) -> None:
        parameters = gtsam.ISAM2Params()
        parameters.findUnusedFactorSlots = True
        parameters.setFactorization("QR")
        parameters.setRelinearizeThreshold(_RELINEARISE)
        parameters.relinearizeSkip = 1
        self._smoother = gtsam.IncrementalFixedLagSmoother(lag_s, parameters)
        last = items[-1]
        self._scale, self._relative = np.exp(log_scales(last.mean, last.covariance, len(last.sources))[0]), relative
        self._next_key = 0
        self._keys: deque[int] = deque()  # poses that were not returned yet, the last ones of `items`
        self._poses: dict[int, int] = {}  # device -> its last pose
        self._references: dict[int, int] = {}
        self._errors = WindowErrors(self._smoother, lag_s)
        self._now_s = items[0].node.time_s
        self._last = items[0]
        self._begin(items[0])
        for item in list(items)[1:]:
            self.add(item)

    def outdated_by(self, item: FilteredNode) -> bool:
        """Return True if the length scales of the EKF differ noticeably from those of this window."""
        mean, sigma = log_scales(item.mean, item.covariance, len(item.sources))
        moved = np.abs(mean - np.log(self._scale)) > _SCALE_TOLERANCE * sigma + 1e-9
        return bool(moved[sorted(item.present)].any())

    def add(self, item: FilteredNode) -> None:
        """Add the pose, the motion, the measurements and the tethers of an item."""
        graph, values = gtsam.NonlinearFactorGraph(), gtsam.Values()
        self._now_s, self._last = max(self._now_s, item.node.time_s), item
        scale, before = float(self._scale[item.device]), self._poses.get(item.device)
        if item.entered is None and before is not None:
            key = self._new_key()
            moved = displacement(item.node, scale)
            values.insert(key, self._smoother.calculateEstimatePose2(before).compose(moved))
            graph.add(gtsam.BetweenFactorPose2(before, key, moved, motion_noise((item.node, item.node)).models[0]))
            add_measurements(graph, item.node, key, self._references.get(item.device))
            self._errors.add_fixes(graph, values, item.node, key, self._new_key)
            self._poses[item.device] = key
        else:
            entered = (
                item.entered if item.entered is not None else device_state(item.mean, item.covariance, item.device)
            )
            self._enter(graph, values, [item.device], of_entering(entered, scale))
            key = self._poses[item.device]
        self._keys.append(key)
        self._update(graph, values)
        self._add_active_tethers(item.tethers)

    def pose_of(self, item: FilteredNode, waiting: int) -> LaggedPose:
        """Return the pose of an item, the first of `waiting` ones, with the part of the covariance from the scale."""
        while len(self._keys) > waiting:
            self._keys.popleft()
        key = self._keys[0]
        pose = self._smoother.calculateEstimatePose2(key)
        mean = np.array([pose.x(), pose.y(), pose.theta()])
        place = STATES * item.device + LOG_SCALE
        variance = max(float(self._last.covariance[place, place]), 0.0)
        value = float(np.exp(self._last.mean[place]))
        scale = (value, value * float(np.sqrt(variance)))
        if not item.node.is_step:
            return LaggedPose(item.device, item.node, mean, np.full((3, 3), np.nan), scale)
        turn, per_scale = to_map(mean[2:])[0], pose_per_scale(item.covariance, item.device)
        covariance = turn @ self._smoother.marginalCovariance(key) @ turn.T
        covariance = covariance + variance * np.outer(per_scale, per_scale)
        return LaggedPose(item.device, item.node, mean, 0.5 * (covariance + covariance.T), scale)

    def iterate(self) -> None:
        """Run Gauss-Newton iterations without new factors."""
        for _ in range(_ITERATIONS):
            self._smoother.update()

    def _begin(self, item: FilteredNode) -> None:
        graph, values = gtsam.NonlinearFactorGraph(), gtsam.Values()
        devices = sorted(item.present)
        errors = [self._new_key() for _ in item.sources]
        known = ConditionalPrior.of_filter(item.mean, item.covariance, self._scale, devices)
        for source, key, rows in zip(item.sources, errors, known.of_sources, strict=True):
            self._errors.begin(source, key, values, known.mean[rows])
        self._enter(graph, values, devices, known, errors)
        self._keys.append(self._poses[item.device])
        self._update(graph, values)

    def _enter(
        self,
        graph: gtsam.NonlinearFactorGraph,
        values: gtsam.Values,
        devices: list[int],
        known: ConditionalPrior,
        errors: Sequence[int] = (),
    ) -> None:
        """Add the first poses of devices with their priors, and those of wandering errors, by key."""
        keys, references = [], []
        for number, device in enumerate(devices):
            self._poses[device] = self._new_key()
            keys.append(self._poses[device])
            values.insert(self._poses[device], gtsam.Pose2(*known.mean[4 * number : 4 * number + 3]))
            fresh = device in self._relative and device not in self._references
            if fresh:
                self._references[device] = self._new_key()
                reference_rad = known.mean[4 * number + 3]
                values.insert(self._references[device], gtsam.Pose2(0.0, 0.0, reference_rad))
            references.append(self._references[device] if fresh else None)
        for factor in prior_factors(known, keys, references, errors):
            graph.add(factor)

    def _add_active_tethers(self, tethers: Sequence[NodeTether | PairTether]) -> None:
        for tether in tethers:
            a, b = self._poses.get(tether.device_a), self._poses.get(tether.device_b)
            if a is None or b is None:
                continue
            between = self._smoother.calculateEstimatePose2(a).between(self._smoother.calculateEstimatePose2(b))
            if np.hypot(between.x(), between.y()) > tether.max_distance_m:
                noise = gtsam.noiseModel.Isotropic.Sigma(1, max(tether.sigma_m, MIN_SIGMA))
                graph = gtsam.NonlinearFactorGraph()
                graph.add(gtsam.RangeFactorPose2(a, b, tether.max_distance_m, noise))
                self._update(graph, gtsam.Values())
                self.iterate()

    def _update(self, graph: gtsam.NonlinearFactorGraph, values: gtsam.Values) -> None:
        """Update the smoother; last poses, references and last errors stay, because later factors refer to them."""
        alive = (*self._poses.values(), *self._references.values(), *self._errors.kept(self._now_s))
        self._smoother.update(graph, values, dict.fromkeys((*alive, *values.keys()), self._now_s))

    def _new_key(self) -> int:
        self._next_key += 1
        return self._next_key - 1


def _no_solution(error: RuntimeError | ValueError) -> EstimationError:
    reason = str(error).strip().splitlines()[0] if str(error).strip() else "no reason given"
    return EstimationError(
        f"the window of fixed-lag has no unique solution ({reason}): give a start pose, more fixes, or use the ekf"
    )
