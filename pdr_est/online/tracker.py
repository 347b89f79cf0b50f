"""The tracker: samples of some devices, block by block, to estimates of where they are."""

import pickle
import warnings
from collections.abc import Sequence

from pdr_est.config import Config
from pdr_est.errors import ConfigError, EstimationError
from pdr_est.estimators.common.measurement_checks import refuse_unusable
from pdr_est.estimators.person.track import NAME as PERSON
from pdr_est.online.changed_poses import ChangedPoses
from pdr_est.online.device_front_end import DeviceFrontEnd, ExpectedDevice
from pdr_est.online.external_estimator import external_estimator
from pdr_est.online.params import OnlineParams
from pdr_est.online.rewindable_filter import WalkFilter
from pdr_est.online.sample_checks import refuse_malformed
from pdr_est.online.start_and_fixes import StartAndFixes
from pdr_est.online.step_log import DeviceLog
from pdr_est.online.update import Kind, Update
from pdr_est.online.update_assembly import Estimates
from pdr_est.parts import NO_PARTS, Parts
from pdr_est.pipeline.inputs import refuse_no_config
from pdr_est.types.measurements import HeadingPrior, PositionFix, StepOdometry
from pdr_est.types.sensors import SensorBlock

_ONLINE = OnlineParams()
_UNREADABLE = (pickle.UnpicklingError, EOFError, AttributeError, ImportError, IndexError, KeyError, ValueError)
_PATIENCE = 20  # pushes after which all work that waits is done at once


class Tracker:
    """Follows a walk while it is recorded.

    The estimates of kind "filtered" are those of the estimator `ekf` on all that is known by then: however the
    recording is cut, and in whatever order the blocks of its devices come within `OnlineParams.wait_s` of each other,
    the last update of each pose equals the pose of `ekf` on the whole recording with `devices.clock: none`. With
    `estimator.name: fixed-lag` there are those of kind "delayed" besides. Of several devices there are those of the
    person, device "fused", besides (`person.Person`).

    A step is a lot of work for one sample. A push of a single sample therefore does one piece of what waits: samples
    to steps, steps to poses, and so on; the pushes that follow do the rest, twenty at most. A longer block waits for
    nothing.

    devices: those that will send samples; others join when their first block comes. The walk's first device is the
    first of them. refused_fixes: those that came later than the horizon.
    """

    def __init__(
        self,
        config: Config | None = None,
        devices: Sequence[str | ExpectedDevice] = (),
        online: OnlineParams = _ONLINE,
        parts: Parts = NO_PARTS,
    ) -> None:
        self._config = Config() if config is None else config
        refuse_no_config(self._config)
        if self._config.heading.dominant.direction_rad is not None:
            raise ConfigError(
                "heading.dominant.direction_rad: the directions of a building are found from the whole walk: leave "
                "it out for tracking, or use `pdr-est smooth`"
            )
        self._online, self._parts = online, parts
        self._external = external_estimator(self._config, parts, online)
        self._names: list[str] = []
        self._fronts: list[DeviceFrontEnd] = []
        self._found: list[list[StepOdometry | HeadingPrior]] = []  # by device: what waits for the filter
        self._waited = 0  # pushes since nothing waited
        start, sigma_scale = self._config.start.pose(), self._config.odometry.sigma_length_scale
        self._known = StartAndFixes(start, sigma_scale)
        tether = self._config.devices.tether if self._config.devices.tethered else None
        self._walk = WalkFilter(self._known, tether, online)
        self._rows = ChangedPoses()
        self._delayed = None
        behind_s: dict[Kind, float] = {"filtered": 0.0}
        if self._external is None and self._config.estimator.make().spec.delayed:
            from pdr_est.online.delayed_estimates import Delayed  # gtsam is slow to load: only when it is used

            self._delayed = Delayed(self._config.estimator.fixed_lag, self._config.devices.tether)
            behind_s["delayed"] = online.settle_s + self._config.estimator.fixed_lag.lag_s
        self._lag_s = behind_s.get("delayed")
        self._estimates = Estimates(self._names, self._fronts, self._config.devices, online.wait_s, behind_s)
        self._flushed = False
        self.refused_fixes = 0
        for device in devices:
            self._join(ExpectedDevice(device) if isinstance(device, str) else device)

    @property
    def devices(self) -> tuple[str, ...]:
        return tuple(self._names)

    @property
    def latency_s(self) -> float:
        """How long after a step its first estimate comes, at most, in the data time of its device."""
        return max((front.latency_s for front in self._fronts), default=0.0) + self._online.wait_s

    @property
    def lag_s(self) -> float | None:
        """How long after a step its delayed estimate comes, once a later step is known; None without."""
        return self._lag_s

    @property
    def late_steps(self) -> int:
        """Steps that came later than the horizon: they were used, but after what other devices did meanwhile."""
        return self._walk.late

    @property
    def missed_fixes(self) -> int:
        """How often a fix was not used for one device: it had been standing for longer than can be gone back."""
        return self._walk.missed

    @property
    def unheard(self) -> tuple[str, ...]:
        """Devices of which nothing could be used so far: accelerometer and gyroscope are needed."""
        return tuple(name for name, front in zip(self._names, self._fronts, strict=True) if front.start_s is None)

    @property
    def remembered(self) -> int:
        """Nodes that can still be gone through again: what the memory of a long walk depends on."""
        return len(self._walk.history)

    def push(self, device: str, block: SensorBlock) -> list[Update]:
        """Take consecutive samples of one channel of a device; return the estimates that are new or have changed.

        Raises EstimationError for samples that are no block of a known channel, and after `flush`.
        """
        self._refuse_flushed()
        refuse_malformed(device, block)
        if device not in self._names:
            self._join(ExpectedDevice(device))
        came = self._fronts[self._names.index(device)].push(block)
        if len(block.time_s) > 1 or self._waited >= _PATIENCE:
            return self._work()
        done = [] if came else self._work_a_little()
        self._waited = 0 if done is None else self._waited + 1
        return done or []

    def push_fix(self, fix: PositionFix) -> list[Update]:
        """Take a known position, of the past or of the future; return the estimates that it changes.

        One from before the horizon is refused with a warning and counted. Raises EstimationError for one that cannot
        be used, and after `flush`.
        """
        self._refuse_flushed()
        horizon_s = self._walk.now_s - self._online.horizon_s
        if fix.time_s < horizon_s:
            self.refused_fixes += 1
            warnings.warn(
                f"fix ({fix.source}) at {fix.time_s:.3f} s came more than {self._online.horizon_s:g} s late, at "
                f"{self._walk.now_s:.3f} s, and was refused: {self.refused_fixes} so far",
                stacklevel=2,
            )
            return []
        refuse_unusable("", [], [fix], [])  # before the estimates that wait are taken out
        if self._external is not None:
            self._external.add_fix(fix)
            return self._work()
        found = self._work()
        left, missed = len(self._walk.history), self._walk.missed
        self._walk.undo_for_fix(fix, self._known.add(fix))
        self._warn_of_missed(missed)
        self._catch_up(left)
        return [*found, *self._filtered(), *self._work()]

    def flush(self) -> list[Update]:
        """The end of the walk: what was held back."""
        self._refuse_flushed()
        found = self._work()
        for number, front in enumerate(self._fronts):
            self._take(number, front.flush())
        self._flushed = True
        if self._external is not None:
            self._external.finish()
        left = len(self._walk.history)
        self._walk.flush(self._config.start.sigma_closed_m if self._config.start.closed else None)
        self._catch_up(left)
        state = self._walk.finish()
        self._rows.pulled(state, self._walk.tail_pulls)
        found += self._filtered()
        if self._delayed is not None:
            last = self._delayed.finish(self._walk.history, self._walk.tail_pulls, state)
            found += self._estimates.of_devices("delayed", last)
        return found + self._estimates.last_of_person()

    def state(self) -> bytes:
        """Everything, for `restore`: with what comes then, the tracker goes on as if nothing had happened."""
        return pickle.dumps(self)

    @staticmethod
    def restore(state: bytes) -> "Tracker":
        """The tracker of a `state`, which must come from a trusted place: it is a pickle. Raises EstimationError for
        something else."""
        try:
            tracker = pickle.loads(state)
        except _UNREADABLE as error:
            raise EstimationError(
                f"the state cannot be read ({error}): give all bytes that Tracker.state of this version made"
            ) from error
        if not isinstance(tracker, Tracker):
            raise EstimationError(
                f"the state is that of a {type(tracker).__name__}: give one that Tracker.state made"
            )
        return tracker

    def _refuse_flushed(self) -> None:
        if self._flushed:
            raise EstimationError("the walk was ended by flush(): begin another one with a new Tracker")

    def _join(self, device: ExpectedDevice) -> None:
        if device.name in self._names:
            raise EstimationError(f"device {device.name!r} is expected twice: give each a name of its own")
        if device.name == PERSON:
            raise EstimationError(f"device {PERSON!r}: that is what the person is called: give it another name")
        self._names.append(device.name)
        self._fronts.append(DeviceFrontEnd(device, self._config, self._parts))
        if self._external is not None:
            self._external.add_device(device.name)
        self._found.append([])
        left = self._walk.add_device()
        if self._delayed is not None:
            self._delayed.undone(left)

    def _work(self) -> list[Update]:
        """Do all that waits."""
        found: list[Update] = []
        while (done := self._work_a_little()) is not None:
            found += done
        self._waited = 0
        return found

    def _work_a_little(self) -> list[Update] | None:
        """Do a piece of what waits; None if nothing does."""
        for number, measurements in enumerate(self._found):
            if measurements:
                self._found[number] = []
                self._take(number, measurements)
                return self._filtered()
        for number, front in enumerate(self._fronts):
            if front.waits:
                self._found[number] = front.work()
                if not self._found[number]:
                    self._take(number, [])
                return self._filtered()
        settled_s = self._walk.now_s - self._online.settle_s
        if self._delayed is not None and self._delayed.waits(self._walk.history, settled_s):
            return self._estimates.of_devices("delayed", self._delayed.take(self._walk.history, settled_s))
        kind = self._estimates.waits
        return None if kind is None else self._estimates.of_person(kind, self._walk.now_s, most=1)

    def _take(self, number: int, measurements: Sequence[StepOdometry | HeadingPrior]) -> None:
        """What the front end of a device found, and how far its samples reach now."""
        front, left, missed = self._fronts[number], len(self._walk.history), self._walk.missed
        if front.start_s is None or front.end_s is None:
            return
        self._known.latency_s = max(self._known.latency_s, front.latency_s)
        log = self._walk.logs[number]
        if log is not None and not measurements and front.end_s == log.end_s:
            return  # the samples wait for those of another sensor
        if log is None:
            log = self._walk.logs[number] = DeviceLog(front.start_s)
        if self._external is not None:
            self._external.extend((front.start_s, front.end_s), measurements, front.latency_s)
            measurements = ()
        for measurement in measurements:
            log.append(measurement)
        self._estimates.recorded(number, log.end_s, front.end_s)
        self._walk.extend(number, front.end_s)
        self._catch_up(left)
        self._warn_of_missed(missed)

    def _catch_up(self, left: int) -> None:
        """Bring the filter up to date. left: how many records the history had before something of it was undone."""
        kept, recorded = self._walk.catch_up()
        if self._delayed is not None:
            self._delayed.undone(min(left, kept))
        for state, device in self._walk.let_go(kept):
            self._rows.last(state, device)
        for record in recorded:
            self._rows.record(record)
        if recorded:
            fed = len(self._walk.history) if self._delayed is None else self._delayed.fed
            forgotten = self._walk.forget(fed)
            if self._delayed is not None:
                self._delayed.forgotten(forgotten)

    def _filtered(self) -> list[Update]:
        """The filter's poses that are new or have changed."""
        before_s = self._walk.now_s - 2.0 * self._online.horizon_s
        own = self._external
        found = self._estimates.of_devices("filtered", own.take_filtered(before_s) if own else self._rows.changed())
        self._rows.forget(before_s)
        self._estimates.forget(before_s)
        return found

    def _warn_of_missed(self, before: int) -> None:
        if self._walk.missed > before:
            warnings.warn(
                f"a fix was not used for {self._walk.missed - before} of {len(self._names)} devices, whose last step "
                f"is longer ago than can be gone back: {self._walk.missed} so far",
                stacklevel=3,
            )
