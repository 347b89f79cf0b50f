"""Multi-device EKF that rewinds and replays out-of-sequence measurements.

The steps are those of the offline filter (`estimators/kalman/joint_filter_step.py`); this one waits and rewinds.
"""

from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import replace
from math import inf, nextafter

from pdr_est.estimators.common.measurement_checks import given_at
from pdr_est.estimators.common.nodes import SAME_S
from pdr_est.estimators.common.tether_schedule import TetherSchedule
from pdr_est.estimators.common.tethers import PairTether, TetherParams
from pdr_est.estimators.kalman.joint_filter_step import WalkFilterState, WalkStepper
from pdr_est.online.device_log import DeviceLog, PendingNode, queue_nodes, release_steps
from pdr_est.online.filter_history import FilterRecord, OnlineState, last_states, tethered_devices, whole_steps
from pdr_est.online.params import OnlineParams
from pdr_est.online.start_and_fixes import StartAndFixes
from pdr_est.types.measurements import HeadingPrior, PositionFix, StepOdometry


class RewindableFilter:
    """Multi-device EKF whose state always equals that of the offline filter on everything that is known so far.

    Parameters
    ----------
    known
        Start pose and fixes of the walk; shared with the caller, who adds the fixes.
    tether
        Tethers between devices; None for devices without tethers.
    parameters
        Waiting and rewinding.

    Attributes
    ----------
    logs
        Log of each device; None before its first sample.
    history
        Records that can be undone, the oldest first.
    state
        State after all of them.
    tail_tethers
        Tethers after the last record, once the walk has ended.
    late_steps
        Number of steps that came too late to take their place in the order of time.
    missed_fixes
        Number of fixes that a device could not use because it had been standing for longer than can be undone.
    """

    def __init__(self, known: StartAndFixes, tether: TetherParams | None, parameters: OnlineParams) -> None:
        self._known, self._tether, self._parameters = known, tether, parameters
        self._schedule = TetherSchedule(None if tether is None else tether.every_s)
        self._stepper = WalkStepper(1)
        self._undone_tethered: set[int] = set()  # devices whose last pose was changed by a tether that was undone
        self._forgotten_s = -inf
        self.logs: list[DeviceLog | None] = []
        self.history: list[FilterRecord] = []
        self.state = OnlineState(WalkFilterState())
        self.tail_tethers: tuple[PairTether, ...] = ()
        self.late_steps = self.missed_fixes = 0

    @property
    def now_s(self) -> float:
        """Newest data time of all devices."""
        return max((log.end_s for log in self.logs if log is not None), default=-inf)

    def add_device(self) -> None:
        """Add a device that has not sent anything yet."""
        self.logs.append(None)
        self._schedule.spans_s.append(None)
        self._known.share_among(len(self.logs))
        self.rewind_after(-inf)
        self._stepper = WalkStepper(len(self.logs))
        before = self.state
        devices = (*before.walk.devices, None)
        if len(devices) > 1:
            walk = self._stepper.with_joint_of(devices, before.walk.begun_s)
        else:
            walk = WalkFilterState(devices, begun_s=before.walk.begun_s)
        self.state = OnlineState(walk, (*before.last_nodes, None), before.next_tether)

    def extend(
        self, device: int, start_s: float, end_s: float, measurements: Sequence[StepOdometry | HeadingPrior] = ()
    ) -> None:
        """Add measurements of a device, whose samples now reach up to a later time.

        Parameters
        ----------
        device
            Number of the device.
        start_s
            Time of its first sample.
        end_s
            Time up to which its samples reach.
        measurements
            Steps and heading priors since the last call.
        """
        log = self.logs[device]
        if log is None:
            log = self.logs[device] = DeviceLog(start_s)
        for measurement in measurements:
            log.append(measurement)
            if isinstance(measurement, HeadingPrior) and not measurement.relative:
                self._take_heading(device)
        log.end_s = max(log.end_s, end_s)
        tether_s = self._schedule.extend(device, log.start_s, end_s)
        if self.history and tether_s + SAME_S < self.history[-1].time_s:
            self.rewind_after(tether_s)

    def add_fix(self, fix: PositionFix) -> None:
        """Add a fix, and rewind to before the nodes for which it makes a difference."""
        changes_start = self._known.add(fix)
        after_s = -inf if changes_start else inf
        for log, own in zip(self.logs, self.state.walk.devices, strict=True):
            rewind_s = inf if log is None else log.rewind_time_s(fix.time_s)
            if rewind_s >= self._forgotten_s:
                after_s = min(after_s, rewind_s)
            else:
                self.missed_fixes += 1
            if own is not None and own.lost_heading_s is not None:
                after_s = min(after_s, nextafter(own.lost_heading_s, -inf))
        if changes_start:
            self._change_start()
        elif after_s < inf:
            self.rewind_after(after_s)

    def _take_heading(self, device: int) -> None:
        """Rewind to before the nodes for which it makes a difference that a heading in the map is known."""
        if self._known.observe_heading():
            self._change_start()
        own = self.state.walk.devices[device]
        if own is not None and own.lost_heading_s is not None:
            self.rewind_after(nextafter(own.lost_heading_s, -inf))

    def _change_start(self) -> None:
        """Undo everything because the prior at the start has changed; begin here if the start is forgotten."""
        self.rewind_after(-inf)
        if self._forgotten_s > -inf:
            self._restart_here()

    def end_walk(self, closing_sigma_m: float | None) -> None:
        """Take note that all samples have come.

        Parameters
        ----------
        closing_sigma_m
            Standard deviation of the distance between start and end of the walk of a single device; None for a walk
            that is not closed.
        """
        for device, (log, own) in enumerate(zip(self.logs, self.state.walk.devices, strict=True)):
            if log is None:
                continue
            log.complete = True
            if closing_sigma_m is not None and len(self.logs) == 1:
                log.closing_fix = self._known.closing_fix(device, log.step_end_s(log.last_step), closing_sigma_m)
            if log.closing_fix is not None and own is not None and own.lost_heading_s is not None:
                self.rewind_after(nextafter(own.lost_heading_s, -inf))

    def apply_tail_tethers(self) -> None:
        """Apply the tethers after the last node; nothing may come after."""
        self.state, self.tail_tethers = self._tethered(self.state, inf)

    def rewind_after(self, after_s: float) -> None:
        """Undo all nodes later than a time, and the other nodes of the steps that they belong to."""
        while self.history and self.history[-1].time_s > after_s:
            record = self.history.pop()
            self._undone_tethered |= tethered_devices(record.tethers)
            after_s = min(after_s, nextafter(record.pending.step_first_s, -inf))
            log = self.logs[record.pending.device]
            if log is not None:
                log.rewind(record.pending.step, record.number)
            self.state = record.before

    def catch_up(self) -> int:
        """Process all nodes that may be used by now.

        Returns
        -------
        int
            Number of records that were there before; those from this index on are new.
        """
        release_steps(self.logs, self.now_s, self._parameters.wait_s)
        self._rewind_for_standing_fixes()
        queue = queue_nodes(self.logs, self._known, self._schedule)
        while queue and self.history and queue[0].order < self.history[-1].order:
            self.rewind_after(nextafter(queue[0].time_s, -inf))
            queue = queue_nodes(self.logs, self._known, self._schedule)
        kept = len(self.history)
        for pending in queue:
            self._process(pending)
        return kept

    def restored_states(self, kept: int) -> list[tuple[OnlineState, int]]:
        """Find the last state of each device whose last pose had been changed by a tether that was undone.

        Parameters
        ----------
        kept
            Number of records that have not been undone.
        """
        devices, self._undone_tethered = self._undone_tethered, set()
        return last_states(self.history[:kept], devices) if devices else []

    def forget(self, smoothed: int) -> int:
        """Forget the records that are too old to be undone.

        Parameters
        ----------
        smoothed
            Number of oldest records that nobody needs any more.

        Returns
        -------
        int
            Number of records that were forgotten.
        """
        keep_s = -inf if self._known.start_may_change else self.now_s - self._parameters.horizon_s
        for own in self.state.walk.devices:
            if own is not None and own.lost_heading_s is not None:
                keep_s = min(keep_s, own.lost_heading_s)
        if len(self.logs) == 1 and self.history:  # fixes while the walker stands still apply to the last node
            keep_s = min(keep_s, self.history[-1].time_s)
        most = self._parameters.remembered_steps
        count = bisect_left(self.history, keep_s, key=lambda record: record.time_s)
        count = whole_steps(self.history, min(max(count, len(self.history) - most), smoothed))
        if count:
            self._forgotten_s = self.history[count - 1].time_s
            del self.history[:count]
            self._forget_steps()
            needed_s = [log.step_end_s(log.next_step - 1) for log in self.logs if log is not None]
            needed_s += [record.pending.step_first_s for record in self.history[:1]]
            self._known.forget(min(keep_s, *needed_s), most)
        return count

    def _forget_steps(self) -> None:
        """Forget the steps and nodes of each device that no remaining record needs."""
        for device, log in enumerate(self.logs):
            if log is None:
                continue
            own = next((record for record in self.history if record.pending.device == device), None)
            log.forget(
                log.next_step - 1 if own is None else own.pending.step - 1,
                log.next_node if own is None else own.number,
            )

    def _restart_here(self) -> None:
        """Restart the walk at the present states of the devices: its start has been forgotten."""
        walk = self.state.walk
        self._known.restart_from({device: own.state for device, own in enumerate(walk.devices) if own is not None})
        walk = replace(self._stepper.initial(walk.joint is not None), begun_s=walk.begun_s)
        self.state = replace(self.state, walk=walk, last_nodes=(None,) * len(self.logs))

    def _rewind_for_standing_fixes(self) -> None:
        """Rewind for fixes after the last step of a device, once it is known that the walker stood still then."""
        for log in self.logs:
            if log is None or log.next_step == 0 or not log.nodes:
                continue
            step = log.next_step - 1
            standing = log.standing_fixes(step, self._known.fixes, self._known.known_until_s(log.end_s))
            if [given_at(fix) for fix in standing] != [given_at(fix) for fix in log.nodes[-1].fixes]:
                if log.step_end_s(step) > self._forgotten_s:
                    self.rewind_after(log.motion_begin_s(step))
                else:
                    self.missed_fixes += 1
                    log.nodes[-1] = replace(log.nodes[-1], fixes=standing)

    def _process(self, pending: PendingNode) -> None:
        """Step the filter to a node, and add a record."""
        device, log, before = pending.device, self.logs[pending.device], self.state
        if log is None:
            return
        tethered, tethers = self._tethered(before, pending.time_s)
        number, own = log.next_node, tethered.walk.devices[device]
        log.nodes.append(pending.node)
        walk, entered = self._stepper.step(
            tethered.walk,
            device,
            number,
            pending.node,
            heading_observed_later=pending.heading_observed_later,
            prior=self._known.prior(device) if own is None else None,
        )
        last_nodes = (*tethered.last_nodes[:device], pending, *tethered.last_nodes[device + 1 :])
        self.state = OnlineState(walk, last_nodes, tethered.next_tether)
        self.late_steps += pending.ends_step and pending.time_s < self._forgotten_s
        place_s = max(pending.time_s, self.history[-1].time_s if self.history else self._forgotten_s)
        self.history.append(FilterRecord(pending, number, place_s, before, tethers, tethered, entered, self.state))
        if pending.ends_step:
            log.next_step = pending.step + 1

    def _tethered(self, state: OnlineState, before_s: float) -> tuple[OnlineState, tuple[PairTether, ...]]:
        """Apply the tethers before a time."""
        if self._tether is None or state.walk.joint is None:
            return state, ()
        pairs, next_tether = self._schedule.due(state.next_tether, self.now_s, before_s)
        due = [PairTether(a, b, self._tether.max_distance_m, self._tether.sigma_m) for a, b in pairs]
        walk, tethers = self._stepper.apply_tethers(state.walk, due)
        return replace(state, walk=walk, next_tether=next_tether), tethers
