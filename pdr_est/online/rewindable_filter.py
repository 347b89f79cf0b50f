"""The filter of all devices in the order of time, which goes back when something comes late.

Its states are those that `ekf.run_filter` and `joint_ekf.follow` would have for all that is known by now.
"""

from bisect import bisect_left
from collections.abc import Iterable
from dataclasses import replace
from math import inf, nextafter

from pdr_est.estimators.common.motion_model import GaussianState
from pdr_est.estimators.common.tethers import TetherParams, donor_of
from pdr_est.estimators.common.timeline import SAME_S
from pdr_est.estimators.kalman import filter_step as single
from pdr_est.estimators.kalman.filter_step import DeviceFilterState
from pdr_est.estimators.kalman.multi_device_ekf import PoseFilter
from pdr_est.online.filter_records import Pending, Record, WalkState, whole_steps
from pdr_est.online.params import OnlineParams
from pdr_est.online.start_and_fixes import StartAndFixes
from pdr_est.online.step_log import DeviceLog
from pdr_est.online.tether_schedule import Pair, Tethering
from pdr_est.types.measurements import PositionFix


class WalkFilter:
    """history: what was gone through and can be undone, the oldest first; state: after all of it.

    late: steps that came too late to take their place in the order of time; missed: fixes that a device could not
    take, because it has been standing for too long.
    """

    def __init__(self, known: StartAndFixes, tether: TetherParams | None, parameters: OnlineParams) -> None:
        self._known, self._tether, self._parameters = known, tether, parameters
        self.logs: list[DeviceLog | None] = []
        self._tethering = Tethering(None if tether is None else tether.every_s, self.logs)
        self.history: list[Record] = []
        self.state = WalkState()
        self.late = self.missed = 0
        self.tail_pulls: tuple[Pair, ...] = ()
        self._let_go: set[int] = set()  # devices that a tether pulled at, which was undone
        self._forgotten_s = -inf
        self._one, self._all = PoseFilter(1), PoseFilter(1)

    @property
    def now_s(self) -> float:
        """The newest data time of all devices."""
        return max((log.end_s for log in self.logs if log is not None), default=-inf)

    def add_device(self) -> int:
        """Make room for one more, which has not sent anything yet; return how much of the history is left."""
        self.logs.append(None)
        self._known.share(len(self.logs))
        self.undo_after(-inf)
        self._all = PoseFilter(len(self.logs))
        alone = (*self.state.alone, None)
        at = (*self.state.at, None)
        self.state = replace(self.state, alone=alone, at=at, joint=None, present=frozenset())
        if len(self.logs) > 1:
            directed = {d: one.end for d, one in enumerate(alone) if one is not None and one.directed}
            for device, moments in directed.items():
                self._all.enter(moments, device)
            joint = single.unload(self._all)
            self.state = replace(self.state, joint=joint, present=frozenset(directed))
        return len(self.history)

    def flush(self, closing_sigma_m: float | None) -> None:
        """All samples have come. closing_sigma_m: how near to its start the walk of a single device ends."""
        after_s = inf
        for device, (log, own) in enumerate(zip(self.logs, self.state.alone, strict=True)):
            if log is None:
                continue
            log.flushed = True
            if closing_sigma_m is not None and len(self.logs) == 1:
                log.home = self._known.home(device, log.step_end_s(log.count), closing_sigma_m)
            open_fix_s = self._known.last_fix_s > log.step_end_s(log.count)
            if (log.home is not None or open_fix_s) and log.ready > log.count:
                after_s = min(after_s, log.begin_s(log.count))
            if log.home is not None and own is not None and own.lost_s is not None:
                after_s = min(after_s, nextafter(own.lost_s, -inf))
        if after_s < inf:
            self.undo_after(after_s)

    def extend(self, device: int, end_s: float) -> None:
        """The samples of a device reach up to a time."""
        log = self.logs[device]
        if log is None:
            return
        moment_s = self._tethering.extend(device, end_s)
        if self.history and moment_s + SAME_S < self.history[-1].time_s:
            self.undo_after(moment_s)

    def undo_for_fix(self, fix: PositionFix, opens_start: bool) -> None:
        """Go back to before the nodes for which a fix makes a difference."""
        after_s = -inf if opens_start else inf
        for log, own in zip(self.logs, self.state.alone, strict=True):
            reached_s = inf if log is None else log.before_fix_s(fix.time_s)
            if reached_s >= self._forgotten_s:
                after_s = min(after_s, reached_s)
            else:
                self.missed += 1
            if own is not None and own.lost_s is not None:
                after_s = min(after_s, nextafter(own.lost_s, -inf))
        if opens_start and self._forgotten_s > -inf:
            self.undo_after(-inf)
            self._known.begin_anew({d: one.end for d, one in enumerate(self.state.alone) if one is not None})
            joint = None if self.state.joint is None else (self.state.joint[0] * 0.0, self.state.joint[1] * 0.0)
            nowhere = (None,) * len(self.logs)
            self.state = replace(self.state, alone=nowhere, at=nowhere, joint=joint, present=frozenset())
        elif after_s < inf:
            self.undo_after(after_s)

    def undo_after(self, after_s: float) -> None:
        """Undo all nodes later than a time, and the rest of the steps that they belong to."""
        while self.history and self.history[-1].time_s > after_s:
            record = self.history.pop()
            self._let_go |= {device for pair in record.pulls for device in pair}
            after_s = min(after_s, nextafter(record.pending.step_from_s, -inf))
            log = self.logs[record.pending.device]
            if log is not None:
                log.undo(record.pending.step, record.number)
            self.state = record.before

    def catch_up(self) -> tuple[int, list[Record]]:
        """Go through all nodes that may be used by now; return how many of the records were there before, and those
        that were added."""
        self._release()
        self._take_standing()
        queue = self._queue()
        while queue and self.history and _place(queue[0]) < self._head():
            self.undo_after(nextafter(queue[0].time_s, -inf))
            queue = self._queue()
        begin = len(self.history)
        for pending in queue:
            self._go(pending)
        return begin, self.history[begin:]

    def let_go(self, left: int) -> list[tuple[WalkState, int]]:
        """The states in which the last poses of devices were left, if a tether that pulled at them was undone. left:
        how many records there were before all was gone through again."""
        devices, self._let_go = self._let_go, set()
        found = []
        for record in reversed(self.history[:left]):
            if record.pending.device in devices:
                found.append((record.after, record.pending.device))
                devices.discard(record.pending.device)
            for device in {device for pair in record.pulls for device in pair} & devices:
                found.append((record.pulled, device))
                devices.discard(device)
            if not devices:
                break
        return found

    def finish(self) -> WalkState:
        """Ask for the last tethers; nothing comes after."""
        self.state, self.tail_pulls = self._pulled(self.state, inf)
        return self.state

    def forget(self, fed: int) -> int:
        """Forget what is too old to be undone, of what `fed` records were smoothed; return how many records."""
        keep_s = self.now_s - self._parameters.horizon_s
        if self._known.start_may_open:
            keep_s = -inf
        for own in self.state.alone:
            keep_s = min(keep_s, inf if own is None or own.lost_s is None else own.lost_s)
        if len(self.logs) == 1 and self.history:  # fixes while the walker stands belong there
            keep_s = min(keep_s, self.history[-1].time_s)
        most = self._parameters.remembered_steps
        count = bisect_left(self.history, keep_s, key=lambda record: record.time_s)
        count = whole_steps(self.history, min(max(count, len(self.history) - most), fed))
        if count:
            self._forgotten_s = self.history[count - 1].time_s
            del self.history[:count]
            self._forget_steps()
            needed = [log.step_end_s(log.ready - 1) for log in self.logs if log is not None]
            needed += [record.pending.step_from_s for record in self.history[:1]]
            self._known.forget(min(keep_s, *needed), most)
        return count

    def _forget_steps(self) -> None:
        for device, log in enumerate(self.logs):
            own = next((record for record in self.history if record.pending.device == device), None)
            if log is not None:
                first = log.next_node if own is None else own.number
                states = (self.history[0].before.alone if self.history else self.state.alone, self.state.alone)
                begins = [one[device] for one in states]
                first = min([first, *(one.begin for one in begins if one is not None and not one.directed)])
                log.forget(log.ready - 1 if own is None else own.pending.step - 1, first)

    def _take_standing(self) -> None:
        """Go back for fixes of the time that a device has been standing, now that it is known to have been."""
        for log in self.logs:
            if log is None or log.ready == 0 or not log.nodes:
                continue
            step = log.ready - 1
            standing = log.standing(step, self._known.fixes, self._known.reached_s(log.end_s))
            if len(standing) != len(log.nodes[-1].fixes):
                if log.step_end_s(step) > self._forgotten_s:
                    self.undo_after(log.begin_s(step))
                else:
                    self.missed += 1
                    log.nodes[-1] = replace(log.nodes[-1], fixes=standing)

    def _release(self) -> None:
        """Let the steps of each device be used for which all others have come so far, or were waited for."""
        now_s = self.now_s
        for device, log in enumerate(self.logs):
            if log is None:
                continue
            others = [other for d, other in enumerate(self.logs) if d != device]
            reached_s = min((-inf if other is None else other.end_s for other in others), default=inf)
            until_s = inf if log.flushed else max(reached_s, now_s - self._parameters.wait_s)
            number = max(log.released, 1)
            while number <= log.count and log.step_end_s(number) <= until_s:
                number += 1
            log.released = number if number > 1 or log.flushed else 0

    def _queue(self) -> list[Pending]:
        queue: list[Pending] = []
        for device, log in enumerate(self.logs):
            if log is not None:
                for step in range(log.ready, log.released):
                    queue += self._pending(device, log, step)
        return sorted(queue, key=_place)

    def _pending(self, device: int, log: DeviceLog, step: int) -> Iterable[Pending]:
        fixes, begin_s, end_s = self._known.fixes, log.begin_s(step), log.step_end_s(step)
        split_times_s = self._tethering.moments_between(begin_s, end_s) if step else []
        nodes = log.nodes_of(step, fixes, split_times_s, self._known.reached_s(log.end_s))
        told = self._known.last_fix_s >= end_s or (log.flushed and log.home is not None)
        for i, node in enumerate(nodes):
            later = told or any(other.fixes for other in nodes[i:])
            yield Pending(node.time_s, device, node, step, nodes[0].time_s, i == len(nodes) - 1, later)

    def _go(self, pending: Pending) -> None:
        device, log, before = pending.device, self.logs[pending.device], self.state
        if log is None:
            return
        pulled, pulls = self._pulled(before, pending.time_s)
        number = log.next_node
        log.nodes.append(pending.node)
        own = self._alone(pulled.alone[device], pending, number, log)
        alone = (*pulled.alone[:device], own, *pulled.alone[device + 1 :])
        joint, entered = pulled.joint, own.end if own.entered else None
        if joint is not None and own.directed:
            donor = donor_of(number, pending.time_s, pulled.begun_s, pulled.present)
            joint, entered = _followed(self._all, joint, pending, entered, donor)
        present = pulled.present | {device} if own.directed else pulled.present
        at = (*pulled.at[:device], pending, *pulled.at[device + 1 :])
        self.state = WalkState(alone, at, joint, present, pulled.next_tie, min(before.begun_s, pending.time_s))
        self.late += pending.is_last and pending.time_s < self._forgotten_s
        place_s = max(pending.time_s, self.history[-1].time_s if self.history else self._forgotten_s)
        self.history.append(Record(pending, number, place_s, before, pulls, pulled, entered, self.state))
        if pending.is_last:
            log.ready = pending.step + 1

    def _alone(
        self, before: DeviceFilterState | None, pending: Pending, number: int, log: DeviceLog
    ) -> DeviceFilterState:
        if before is None:
            prior = self._known.prior(pending.device, len(self.logs))
            return single.begin(pending.node, number, prior, self._one)
        nodes = log.since(before.begin) if not before.directed else ()
        if len(nodes) > self._parameters.remembered_steps:
            return single.begin_anew(before, pending.node, number, self._one)
        return single.follow(before, pending.node, number, nodes, pending.told_later, self._one)

    def _pulled(self, state: WalkState, before_s: float) -> tuple[WalkState, tuple[Pair, ...]]:
        """The state after the tethers whose moment is before a time, and the pairs that were asked for."""
        if self._tether is None or state.joint is None:
            return state, ()
        pairs, next_tie = self._tethering.asked_for(state.next_tie, min(self.now_s, before_s), before_s)
        pulls = tuple((a, b) for a, b in pairs if state.directed(a) and state.directed(b))
        if not pulls:
            return replace(state, next_tie=next_tie), ()
        single.load(self._all, state.joint)
        for a, b in pulls:
            self._all.keep_together(a, b, self._tether.max_distance_m, self._tether.sigma_m)
        return replace(state, joint=single.unload(self._all), next_tie=next_tie), pulls

    def _head(self) -> tuple[float, int]:
        return self.history[-1].time_s, self.history[-1].pending.device


def _followed(
    workhorse: PoseFilter, joint: single.Raw, pending: Pending, entered: GaussianState | None, donor: int | None
) -> tuple[single.Raw, GaussianState | None]:
    """The joint filter after a node of one device, and the state that the device entered it with, if it did."""
    single.load(workhorse, joint)
    if entered is not None:
        entered = workhorse.join(entered, pending.node, pending.device, donor)
    else:
        workhorse.advance(pending.node, pending.device)
        workhorse.measure(pending.node, pending.device)
    return single.unload(workhorse), entered


def _place(pending: Pending) -> tuple[float, int]:
    return pending.time_s, pending.device
