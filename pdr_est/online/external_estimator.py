"""An estimator from outside the package, fed by the tracker with the measurements of all devices in order of time."""

import heapq
from collections.abc import Sequence
from math import inf
from typing import cast

import numpy as np

from pdr_est.config import Config
from pdr_est.errors import ConfigError
from pdr_est.estimators import BuiltInEstimator, OnlineEstimator, OnlineFilter, OnlinePose
from pdr_est.estimators.common.nodes import Node
from pdr_est.online.heights.floors_with_plans import FloorsWithPlans
from pdr_est.online.params import OnlineParams
from pdr_est.online.update import PoseEstimate
from pdr_est.online.walk_estimator import FilteredPose, WalkEstimator
from pdr_est.parts import Parts
from pdr_est.pipeline.estimation import chosen_estimator
from pdr_est.types.measurements import HeadingPrior, LoopClosure, PositionFix, PresentFloor, StepOdometry
from pdr_est.types.steps import CarryingMode

_Measurement = StepOdometry | HeadingPrior | PositionFix | PresentFloor
_RANK = {PresentFloor: -1, StepOdometry: 0, HeadingPrior: 1, PositionFix: 2}  # of measurements of one time


class ExternalWalkEstimator:
    """Feeds a filter from outside the package with measurements that are settled.

    A measurement is settled when no earlier one can come any more: when the data have gone on for the latency of the
    front end and `OnlineParams.wait_s`, but at least for `OnlineParams.settle_s`, so that fixes may be late. Settled
    measurements are pushed in order of time, whatever the order in which they came, so that the result does not
    depend on how the recording was cut. One that comes later still is pushed as soon as it comes.

    Parameters
    ----------
    estimator
        The estimator.
    config
        Start pose and uncertainty of the length scale.
    online
        Waiting.
    floors
        Floors with their plans, of which the filter gets each change.
    """

    def __init__(
        self, estimator: OnlineEstimator, config: Config, online: OnlineParams, floors: FloorsWithPlans
    ) -> None:
        self._estimator, self._config, self._online, self._floors = estimator, config, online, floors
        self._names: list[str] = []
        self._filter: OnlineFilter | None = None
        self._pending: list[tuple[float, int, int, int, _Measurement]] = []  # a heap, in order of time
        self._count = 0
        self._steps: dict[tuple[str, float], Node] = {}
        self._end_s: dict[str, float] = {}  # of the last step of each device
        self._found: list[OnlinePose] = []
        self._latency_s = 0.0
        self.now_s = -inf
        self.late_steps = self.missed_fixes = 0  # a filter takes all measurements, in the order in which they come
        self.delayed = False

    @property
    def undoable(self) -> int:
        """Number of measurements that wait for their place in the order of time."""
        return len(self._pending)

    def add_device(self, name: str) -> None:
        """Add a device that has not sent anything yet."""
        self._names.append(name)

    def extend(
        self,
        device: int,
        span_s: tuple[float, float],
        measurements: Sequence[StepOdometry | HeadingPrior],
        latency_s: float,
    ) -> None:
        """Add measurements of a device, and push what is settled by now.

        Parameters
        ----------
        device
            Number of the device.
        span_s
            Time of the first sample of the device, and time up to which its samples have been processed.
        measurements
            Steps and heading priors since the last call.
        latency_s
            Latency of the front end of the device.
        """
        for floor in self._floors.take():
            self._wait(floor, -1)
        for measurement in measurements:
            self._wait(measurement, device)
            if isinstance(measurement, StepOdometry):
                self._remember(measurement, span_s[0])
        self.now_s = max(self.now_s, span_s[1])
        self._latency_s = max(self._latency_s, latency_s)
        self._push_until(self.now_s - max(self._online.settle_s, self._online.wait_s + self._latency_s))

    def add_fix(self, fix: PositionFix) -> None:
        """Add a position fix, which waits for its place in the order of time."""
        self._wait(fix, len(self._names))

    def finish(self, closing_sigma_m: float | None) -> None:
        """Push all that waits, a loop closure if the walk is closed, and end the filter.

        Parameters
        ----------
        closing_sigma_m
            Standard deviation of the distance between start and end; None for a walk that is not closed.
        """
        self._push_until(inf)
        own = self._begun()
        if closing_sigma_m is not None:
            for name in self._names:
                self._found += own.push(LoopClosure(name, closing_sigma_m))
        self._found += own.flush()

    def take_filtered(self) -> Sequence[PoseEstimate]:
        """Return the poses that are new or have changed; each of them only once."""
        found, self._found = [self._pose_of(pose) for pose in self._found], []
        return found

    @property
    def delayed_pending(self) -> bool:
        """Tell whether `take_delayed` has something to do: an external filter has no delayed estimates."""
        return False

    def take_delayed(self) -> Sequence[PoseEstimate]:
        """Return no poses."""
        return []

    def last_delayed(self) -> None:
        """Return None: there are no delayed estimates."""

    def forget(self, before_s: float) -> None:
        """Forget the steps before a time, whose poses will not change any more."""
        for key in [key for key in self._steps if key[1] < before_s]:
            del self._steps[key]

    def _wait(self, measurement: _Measurement, device: int) -> None:
        entry = (measurement.time_s, _RANK[type(measurement)], device, self._count, measurement)
        heapq.heappush(self._pending, entry)
        self._count += 1

    def _push_until(self, settled_s: float) -> None:
        while self._pending and self._pending[0][0] <= settled_s:
            self._found += self._begun().push(heapq.heappop(self._pending)[-1])

    def _begun(self) -> OnlineFilter:
        if self._filter is None:
            start, sigma_scale = self._config.start.pose(), self._config.odometry.sigma_length_scale
            self._filter = self._estimator.begin(list(self._names), start, sigma_scale)
            for plan in self._floors.at_start():
                self._filter.push(plan)
        return self._filter

    def _remember(self, step: StepOdometry, start_s: float) -> None:
        """Keep what an update tells of a step besides its pose."""
        moving_from_s = max(step.start_s, self._end_s.get(step.device, start_s))
        self._end_s[step.device] = step.time_s
        self._steps[step.device, step.time_s] = Node(
            time_s=step.time_s,
            moving_from_s=moving_from_s,
            length_m=step.length_m,
            heading_change_rad=step.heading_change_rad,
            covariance=step.covariance,
            is_step=True,
            step_length_m=step.length_m,
            mode=step.mode,
        )

    def _pose_of(self, pose: OnlinePose) -> FilteredPose:
        node = self._steps.get((pose.device, pose.time_s))
        if node is None:  # the start, or a time of the filter's own
            zero = np.zeros((3, 3))
            node = Node(pose.time_s, pose.time_s, 0.0, 0.0, zero, True, 0.0, CarryingMode.UNKNOWN)
        position = np.asarray(pose.position_m, dtype=np.float64)
        return FilteredPose(
            device=self._names.index(pose.device),
            node=node,
            pose=np.array([position[0], position[1], pose.heading_rad]),
            covariance=np.asarray(pose.covariance, dtype=np.float64),
            scale=(1.0, 0.0),  # the lengths of an external filter are not scaled
        )


def estimator_of_walk(
    config: Config, parts: Parts, online: OnlineParams, floors: FloorsWithPlans
) -> ExternalWalkEstimator | WalkEstimator:
    """Make the estimator of a walk that was given or configured, with a filter of its own or that of the tracker.

    Raises ConfigError for one that does not work online, or not with the floor plan that is given.
    """
    estimator = chosen_estimator(config, parts, floors.plan is not None)
    if floors.plan is not None and not estimator.spec.uses_plan:
        raise ConfigError(
            f"the estimator {estimator.spec.name} makes no use of the floor plan {floors.plan.name}: track with "
            "particle, or leave the plan out"
        )
    if isinstance(estimator, BuiltInEstimator) and not estimator.has_filter:
        return WalkEstimator(config, online)
    if not estimator.spec.online or not hasattr(estimator, "begin"):
        raise ConfigError(
            f"the estimator {estimator.spec.name} does not work online (spec.online = {estimator.spec.online}"
            f"{'' if hasattr(estimator, 'begin') else ', no begin'}): track with ekf or fixed-lag"
        )
    return ExternalWalkEstimator(cast(OnlineEstimator, estimator), config, online, floors)
