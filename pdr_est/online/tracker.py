"""Tracker: turns the samples of some devices, block by block, into estimates of where the devices are."""

import warnings
from collections.abc import Collection, Sequence

from pdr_est.config import Config
from pdr_est.errors import EstimationError
from pdr_est.estimators.common.fix_noise import fixes_with_noise
from pdr_est.estimators.common.measurement_checks import refuse_unusable
from pdr_est.estimators.person.track import NAME as PERSON
from pdr_est.online.device_front_end import DeviceFrontEnd, ExpectedDevice, refuse_malformed
from pdr_est.online.external_estimator import estimator_of_walk
from pdr_est.online.heights.floors_with_plans import FloorsWithPlans
from pdr_est.online.params import OnlineParams
from pdr_est.online.saved_state import pack, unpack
from pdr_est.online.update import Kind, Update
from pdr_est.online.update_assembly import UpdateAssembly
from pdr_est.parts import NO_PARTS, Parts
from pdr_est.pipeline.inputs import refuse_settings_for_whole_walks
from pdr_est.types.floor_plan import BuildingPlan, FloorPlan
from pdr_est.types.height import WalkerHeight
from pdr_est.types.measurements import HeadingPrior, PositionFix, StepOdometry
from pdr_est.types.sensors import SensorBlock

_ONLINE = OnlineParams()
_PARTS = "parts"  # in saved states: the parts of the user's own, which are given again
_MOST_DEFERRED = 40  # pushes of single samples after which all pending work is done at once


class Tracker:
    """Follows a walk while it is recorded.

    The estimates of kind "filtered" are those of the estimator `ekf` on everything that is known so far: however the
    recording is cut, and in whatever order the blocks of its devices come within `OnlineParams.wait_s` of each other,
    the last update of each pose equals the pose of `ekf` on the whole recording with `devices.clock: none`. Updates
    with height and floor need air pressure; those of kind "delayed" `estimator.name: fixed-lag`; those of the person,
    device "fused", several devices (see `person_estimates.py`).

    A push of a single sample does one piece of the pending work, such as samples to steps or steps to poses; the next
    pushes, forty at most, do the rest. A push of a longer block does everything at once.

    Parameters
    ----------
    config
        Configuration; the defaults without it.
    devices
        Devices that will send samples, the first device of the walk first; others join with their first block.
    online
        Waiting and rewinding.
    parts
        Stages and an estimator of the user's own.
    plan
        Floor plan, or those of several floors, for an estimator that uses one.

    Attributes
    ----------
    refused_fixes
        Number of fixes that came later than the horizon.

    Raises
    ------
    ConfigError
        For a configuration that cannot be used online, and an estimator that makes no use of the plan.
    FloorPlanError
        For a plan that cannot be used, and several floors without that of the start.
    EstimationError
        For two devices of the same name.
    """

    def __init__(
        self,
        config: Config | None = None,
        devices: Sequence[str | ExpectedDevice] = (),
        online: OnlineParams = _ONLINE,
        parts: Parts = NO_PARTS,
        plan: FloorPlan | BuildingPlan | None = None,
    ) -> None:
        self._config = Config() if config is None else config
        refuse_settings_for_whole_walks(self._config)
        floors = FloorsWithPlans(plan, self._config)
        self._online, self._parts = online, parts
        self._names: list[str] = []
        self._front_ends: list[DeviceFrontEnd] = []
        self._measured: list[list[StepOdometry | HeadingPrior]] = []  # by device: what waits for the filter
        self._processed_s: list[float] = []  # by device: time up to which its samples have been filtered
        self._estimator = estimator_of_walk(self._config, parts, online, floors)
        delays_s: dict[Kind, float] = {"filtered": 0.0}
        self._lag_s = online.settle_s + self._config.estimator.fixed_lag.lag_s if self._estimator.delayed else None
        delays_s |= {} if self._lag_s is None else {"delayed": self._lag_s}
        self._updates = UpdateAssembly(self._names, self._front_ends, self._config, online, delays_s, floors)
        self._flushed = self._has_filtered = False  # the latter while there may be filtered poses to return
        self._deferred = self._reported_missed = self.refused_fixes = 0  # the first: pushes since all work was done
        expected = [ExpectedDevice(device) if isinstance(device, str) else device for device in devices]
        for one in sorted(expected, key=lambda device: device.name):  # as for whole walks
            self._join(one)

    @property
    def devices(self) -> tuple[str, ...]:
        """Names of the devices."""
        return tuple(self._names)

    @property
    def latency_s(self) -> float:
        """Largest time from a step to its first estimate, in the data time of its device, s."""
        return max((front_end.latency_s for front_end in self._front_ends), default=0.0) + self._online.wait_s

    @property
    def lag_s(self) -> float | None:
        """Time from a step to its delayed estimate once a later step is known, s; None without delayed estimates."""
        return self._lag_s

    @property
    def now_s(self) -> float:
        """Newest data time up to which samples have been processed; minus infinity at the beginning."""
        return self._estimator.now_s

    @property
    def height(self) -> WalkerHeight | None:
        """Height and floor at the last second for which they are known; None without air pressure."""
        return self._updates.height

    @property
    def late_steps(self) -> int:
        """Number of steps that came later than the horizon and were used after the later steps of other devices."""
        return self._estimator.late_steps

    @property
    def missed_fixes(self) -> int:
        """Number of times a fix was not used for a device that had been standing for longer than can be undone."""
        return self._estimator.missed_fixes

    @property
    def unheard(self) -> tuple[str, ...]:
        """Devices without usable samples so far: accelerometer and gyroscope are needed."""
        return tuple(name for name, one in zip(self._names, self._front_ends, strict=True) if one.start_s is None)

    @property
    def remembered(self) -> int:
        """Number of nodes that can still be filtered again, on which the memory of a long walk depends."""
        return self._estimator.undoable

    def push(self, device: str, block: SensorBlock) -> list[Update]:
        """Add consecutive samples of one channel of a device; return the estimates that are new or have changed.

        Raises
        ------
        EstimationError
            For samples that are not a block of a known channel, and after `flush`.
        """
        self._refuse_flushed()
        refuse_malformed(device, block)
        if device not in self._names:
            self._join(ExpectedDevice(device))
        self._updates.listen(device, block)
        has_resampled = self._front_ends[self._names.index(device)].push(block)
        if len(block.time_s) > 1 or self._deferred >= _MOST_DEFERRED:
            found = self._work()
        else:
            done = [] if has_resampled else self._work_a_little()
            found, self._deferred = done or [], 0 if done is None else self._deferred + 1
        self._warn_of_missed_fixes()
        return found

    def push_fix(self, fix: PositionFix) -> list[Update]:
        """Add a known position, of the past or of the future; return the estimates that it changes.

        A fix from before the horizon is refused with a warning, and counted.

        Raises
        ------
        EstimationError
            For a fix without usable values, and after `flush`.
        """
        self._refuse_flushed()
        if fix.time_s < self.now_s - self._online.horizon_s:
            self.refused_fixes += 1
            late = f"came more than {self._online.horizon_s:g} s late, at {self.now_s:.3f} s, and was refused"
            told = f"fix ({fix.source}) at {fix.time_s:.3f} s {late}: {self.refused_fixes} so far"
            warnings.warn(told, stacklevel=2)
            return []
        refuse_unusable("", [], [fix], [])  # before the pending estimates are taken out
        found = self._work()
        (noisy,) = fixes_with_noise([fix], self._config.fixes)
        self._updates.add_fix(noisy)
        self._estimator.add_fix(noisy)
        found += [*self._filtered(), *self._work()]
        self._warn_of_missed_fixes()
        return found

    def flush(self) -> list[Update]:
        """End the walk; return the remaining estimates. Raises EstimationError if it was ended before."""
        self._refuse_flushed()
        found = self._work()
        for number, front_end in enumerate(self._front_ends):
            self._filter(number, front_end.flush())
        self._flushed = True
        self._estimator.finish(self._config.start.sigma_closed_m if self._config.start.closed else None)
        found += self._filtered()
        found += self._updates.last(self._estimator.last_delayed())
        self._warn_of_missed_fixes()
        return found

    def state(self) -> bytes:
        """Return the state as data: with the same input, the restored tracker goes on in the same way.

        Raises
        ------
        EstimationError
            If a part of the user's own holds something that is no data, such as an open file.
        """
        return pack(self, {_PARTS: self._parts})  # parts may be functions

    @staticmethod
    def restore(state: bytes, parts: Parts = NO_PARTS, modules: Collection[str] = ()) -> "Tracker":
        """Restore a tracker from its `state`; nothing in it is executed.

        Parameters
        ----------
        state
            The bytes.
        parts
            Parts with which the tracker was made.
        modules
            Names of modules of the user's own whose objects the state may hold, besides those of `parts`.

        Raises
        ------
        EstimationError
            For a state that is damaged, of another version or not of a tracker.
        """
        return unpack(state, Tracker, {*parts.modules, *modules}, {_PARTS: parts})

    def _refuse_flushed(self) -> None:
        if self._flushed:
            raise EstimationError("the walk was ended by flush(): begin another one with a new Tracker")

    def _join(self, device: ExpectedDevice) -> None:
        """Add a device."""
        if device.name in (*self._names, PERSON):
            fault = "the person is called that" if device.name == PERSON else "is expected twice"
            raise EstimationError(f"device {device.name!r}: {fault}; give each device a name of its own")
        self._names.append(device.name)
        self._front_ends.append(DeviceFrontEnd(device, self._config, self._parts))
        self._measured.append([])
        self._processed_s.append(float("-inf"))
        self._estimator.add_device(device.name)

    def _work(self) -> list[Update]:
        """Do all pending work."""
        found: list[Update] = []
        while (done := self._work_a_little()) is not None:
            found += done
        self._deferred = 0
        return found

    def _work_a_little(self) -> list[Update] | None:
        """Do one piece of the pending work; return None if there is none."""
        if self._has_filtered:
            return self._filtered()
        for number, (measurements, front_end) in enumerate(zip(self._measured, self._front_ends, strict=True)):
            if measurements or front_end.end_s not in (None, self._processed_s[number]):
                self._measured[number] = []
                self._filter(number, measurements)
                return []
        for number, front_end in enumerate(self._front_ends):
            if front_end.pending:
                self._measured[number] = front_end.work()
                return []
        if self._estimator.delayed_pending:
            return self._updates.of_devices("delayed", self._estimator.take_delayed())
        kind = self._updates.pending_person
        return None if kind is None else self._updates.of_person(kind, self.now_s, most=1)

    def _filter(self, number: int, measurements: Sequence[StepOdometry | HeadingPrior]) -> None:
        """Filter the measurements of a device, whose samples reach up to a later time."""
        front_end, before_s = self._front_ends[number], self._processed_s[number]
        if front_end.start_s is None or front_end.end_s is None:
            return
        if not measurements and front_end.end_s == before_s:
            return  # the samples wait for those of another sensor
        self._processed_s[number], self._has_filtered = front_end.end_s, True
        self._updates.extend(number, before_s, front_end.end_s, measurements)
        self._estimator.extend(number, (front_end.start_s, front_end.end_s), measurements, front_end.latency_s)

    def _filtered(self) -> list[Update]:
        """Return the updates of the filtered poses that are new or have changed."""
        self._has_filtered = False
        found = self._updates.of_devices("filtered", self._estimator.take_filtered())
        before_s = self.now_s - 2.0 * self._online.horizon_s
        self._estimator.forget(before_s)
        self._updates.forget(before_s)
        return found

    def _warn_of_missed_fixes(self) -> None:
        """Warn of fixes that were missed since the last warning."""
        new, self._reported_missed = self.missed_fixes - self._reported_missed, self.missed_fixes
        if new:
            words = f"a fix was not used for {new} of {len(self._names)} devices, whose last step is longer ago"
            warnings.warn(f"{words} than can be undone: {self.missed_fixes} so far", stacklevel=3)
