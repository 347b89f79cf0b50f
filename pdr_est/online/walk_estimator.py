"""Estimator of a walk that goes on: the online filter with its changed poses, and the delayed estimates."""

from collections import OrderedDict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from pdr_est.config import Config
from pdr_est.estimators.common.nodes import Node
from pdr_est.frames import Array
from pdr_est.online.filter_history import OnlineState, tethered_devices
from pdr_est.online.params import OnlineParams
from pdr_est.online.rewindable_filter import RewindableFilter
from pdr_est.online.start_and_fixes import StartAndFixes
from pdr_est.online.update import PoseEstimate
from pdr_est.types.measurements import HeadingPrior, PositionFix, StepOdometry

if TYPE_CHECKING:
    from pdr_est.online.delayed_estimates import DelayedEstimates


@dataclass(frozen=True)
class FilteredPose:
    """Filtered pose of a device at a node.

    Attributes
    ----------
    device
        Number of the device.
    node
        The node.
    pose
        Pose (3,), east m, north m, heading rad.
    covariance
        Its covariance (3, 3) in the map frame.
    scale
        Length scale and its standard deviation.
    """

    device: int
    node: Node
    pose: Array
    covariance: Array
    scale: tuple[float, float]

    def equals(self, other: "FilteredPose | None") -> bool:
        """Tell whether another pose has the same time, pose and covariance."""
        return (
            other is not None
            and self.node.time_s == other.node.time_s
            and bool((self.pose == other.pose).all() and (self.covariance == other.covariance).all())
        )


class ChangedPoses:
    """Filtered poses at the ends of steps that are new or have changed since they were last given."""

    def __init__(self) -> None:
        self._new: dict[tuple[int, int], FilteredPose] = {}  # by device and step
        self._given: OrderedDict[tuple[int, int], FilteredPose] = OrderedDict()  # nearly in order of time

    @property
    def remembered(self) -> int:
        """Number of remembered poses."""
        return len(self._given)

    def record(self, state: OnlineState, devices: Iterable[int]) -> None:
        """Take the last poses of some devices from a state."""
        for device in devices:
            last = state.last_nodes[device]
            if last is not None and last.node.is_step:
                pose, covariance = state.walk.pose_of(device)
                scale = state.walk.state_of(device).length_scale
                self._new[device, last.step] = FilteredPose(device, last.node, pose, covariance, scale)

    def take(self) -> list[FilteredPose]:
        """Return the new and changed poses in order of time; each of them only once."""
        changed = {key: pose for key, pose in self._new.items() if not pose.equals(self._given.get(key))}
        self._given.update(changed)
        self._new.clear()
        return sorted(changed.values(), key=lambda pose: (pose.node.time_s, pose.device))

    def forget(self, before_s: float) -> None:
        """Forget poses before a time, which will not change any more."""
        while self._given and next(iter(self._given.values())).node.time_s < before_s:
            self._given.popitem(last=False)


class WalkEstimator:
    """Filters the measurements of all devices while they come, and smooths the settled ones with a lag.

    Parameters
    ----------
    config
        Estimator, start pose and tethers.
    online
        Waiting and rewinding.

    Attributes
    ----------
    filter
        The online filter.
    """

    def __init__(self, config: Config, online: OnlineParams) -> None:
        self._online = online
        self._known = StartAndFixes(config.start.pose(), config.odometry.sigma_length_scale)
        tether = config.devices.tether if config.devices.tethered else None
        self.filter = RewindableFilter(self._known, tether, online)
        self._changed = ChangedPoses()
        self._delayed = _delayed_estimates(config)

    @property
    def now_s(self) -> float:
        """Newest data time of all devices."""
        return self.filter.now_s

    @property
    def remembered(self) -> int:
        """Number of remembered records, steps, nodes, fixes and poses."""
        logs = sum(log.remembered for log in self.filter.logs if log is not None)
        taken = 0 if self._delayed is None else self._delayed.taken
        return len(self.filter.history) + logs + len(self._known.fixes) + self._changed.remembered + taken

    @property
    def undoable(self) -> int:
        """Number of nodes that can still be filtered again."""
        return len(self.filter.history)

    @property
    def late_steps(self) -> int:
        """Number of steps that came later than the horizon."""
        return self.filter.late_steps

    @property
    def missed_fixes(self) -> int:
        """Number of times a fix was not used for a device that had been standing for long."""
        return self.filter.missed_fixes

    @property
    def delayed(self) -> bool:
        """Tell whether there are delayed estimates."""
        return self._delayed is not None

    def add_device(self, _name: str = "") -> None:
        """Add a device that has not sent anything yet."""
        self.filter.add_device()
        self._rewind_delayed(len(self.filter.history))

    def extend(
        self,
        device: int,
        span_s: tuple[float, float],
        measurements: Sequence[StepOdometry | HeadingPrior],
        latency_s: float,
    ) -> None:
        """Add measurements of a device, and filter what can be filtered by now.

        Parameters
        ----------
        device
            Number of the device.
        span_s
            Time of its first sample, and time up to which its samples have been processed.
        measurements
            Steps and heading priors since the last call.
        latency_s
            Latency of the front end of the device.
        """
        self._known.latency_s = max(self._known.latency_s, latency_s)
        before = len(self.filter.history)
        self.filter.extend(device, *span_s, measurements)
        self._catch_up(before)

    def add_fix(self, fix: PositionFix) -> None:
        """Add a position fix, and filter again what it changes.

        Raises
        ------
        EstimationError
            For a fix without usable values.
        """
        before = len(self.filter.history)
        self.filter.add_fix(fix)
        self._catch_up(before)

    def finish(self, closing_sigma_m: float | None) -> None:
        """Filter all that is left at the end of the walk.

        Parameters
        ----------
        closing_sigma_m
            Standard deviation of the distance between start and end; None for a walk that is not closed.
        """
        before = len(self.filter.history)
        self.filter.end_walk(closing_sigma_m)
        self._catch_up(before)
        self.filter.apply_tail_tethers()
        self._changed.record(self.filter.state, sorted(tethered_devices(self.filter.tail_tethers)))

    def take_filtered(self) -> Sequence[PoseEstimate]:
        """Return the filtered poses that are new or have changed; each of them only once."""
        return self._changed.take()

    @property
    def delayed_pending(self) -> bool:
        """Tell whether `take_delayed` has something to do."""
        return self._delayed is not None and self._delayed.pending(self.filter.history, self._settled_s)

    def take_delayed(self) -> Sequence[PoseEstimate]:
        """Smooth one settled record; return the poses that are a lag older."""
        return [] if self._delayed is None else self._delayed.take(self.filter.history, self._settled_s)

    def last_delayed(self) -> Sequence[PoseEstimate] | None:
        """Smooth all remaining records at the end of the walk; None without delayed estimates."""
        if self._delayed is None:
            return None
        return self._delayed.finish(self.filter.history, self.filter.tail_tethers, self.filter.state)

    def forget(self, before_s: float) -> None:
        """Forget poses before a time, which will not change any more."""
        self._changed.forget(before_s)

    @property
    def _settled_s(self) -> float:
        return self.now_s - self._online.settle_s

    def _catch_up(self, before: int) -> None:
        """Filter what can be filtered by now.

        Parameters
        ----------
        before
            Number of records in the history before any of them were undone.
        """
        kept = self.filter.catch_up()
        self._rewind_delayed(min(before, kept))
        for state, device in self.filter.restored_states(kept):
            self._changed.record(state, [device])
        recorded = self.filter.history[kept:]
        for record in recorded:
            self._changed.record(record.tethered, sorted(tethered_devices(record.tethers)))
            self._changed.record(record.after, [record.pending.device])
        if recorded:
            smoothed = len(self.filter.history) if self._delayed is None else self._delayed.taken
            forgotten = self.filter.forget(smoothed)
            if self._delayed is not None:
                self._delayed.forget(forgotten)

    def _rewind_delayed(self, kept: int) -> None:
        if self._delayed is not None:
            self._delayed.rewind(kept)


def _delayed_estimates(config: Config) -> "DelayedEstimates | None":
    if not config.estimator.make().spec.delayed:
        return None
    from pdr_est.online import delayed_estimates  # loads the smoother, which is slow

    return delayed_estimates.DelayedEstimates(config.estimator.fixed_lag)
