"""The filter of all devices in the order of time, which goes back when something comes late.

Its states are those that `ekf.run_filter` and `joint_ekf.follow` would have for all that is known by now.
"""

from collections.abc import Iterable
from dataclasses import replace
from itertools import combinations
from math import ceil, floor, inf, nextafter

import numpy as np

from pdr_est.estimators.motion import STATES, Moments
from pdr_est.estimators.pose_filter import PoseFilter
from pdr_est.estimators.ties import TetherParams
from pdr_est.estimators.timeline import SAME_S
from pdr_est.online import alone as single
from pdr_est.online.alone import Alone
from pdr_est.online.known import Known
from pdr_est.online.log import DeviceLog
from pdr_est.online.params import OnlineParams
from pdr_est.online.state import Pending, Record, WalkState
from pdr_est.records import PositionFix

Pair = tuple[int, int]


class WalkFilter:
    """history: what was gone through and can be undone, the oldest first; state: after all of it.

    late: steps that came too late to take their place in the order of time; missed: fixes that a device could not
    take, because it has been standing for too long.
    """

    def __init__(self, known: Known, tether: TetherParams | None, parameters: OnlineParams) -> None:
        self._known, self._tether, self._parameters = known, tether, parameters
        self.logs: list[DeviceLog | None] = []
        self.history: list[Record] = []
        self.state = WalkState((), (), None, frozenset(), 0)
        self.late = self.missed = 0
        self.tail_pulls: tuple[Pair, ...] = ()
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
        self.state = WalkState(alone, at, None, frozenset(), self.state.next_tie)
        if len(self.logs) > 1:
            directed = {d: one.end for d, one in enumerate(alone) if one is not None and one.directed}
            for device, moments in directed.items():
                self._all.enter(moments, device)
            joint = single.unload(self._all)
            self.state = WalkState(alone, at, joint, frozenset(directed), self.state.next_tie)
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
        before_s, log.end_s = log.end_s, max(log.end_s, end_s)
        for pair in combinations(range(len(self.logs)), 2):
            if device in pair:
                moment_s = self._first_moment_after(pair, before_s if log.ready else -inf, device)
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
            self.state = WalkState(nowhere, nowhere, joint, frozenset(), self.state.next_tie)
        elif after_s < inf:
            self.undo_after(after_s)

    def undo_after(self, after_s: float) -> None:
        """Undo all nodes later than a time, and the rest of the steps that they belong to."""
        while self.history and self.history[-1].time_s > after_s:
            record = self.history.pop()
            after_s = min(after_s, record.pending.step_from_s)
            log = self.logs[record.pending.device]
            if log is not None:
                log.undo(record.pending.step, record.number)
            self.state = record.before

    def catch_up(self) -> tuple[int, list[Record]]:
        """Go through all nodes that may be used by now; return how many of the records were there before, and those
        that were added."""
        self._release()
        queue = self._queue()
        while queue and self.history and _place(queue[0]) < self._head():
            self.undo_after(nextafter(queue[0].time_s, -inf))
            queue = self._queue()
        begin = len(self.history)
        for pending in queue:
            self._go(pending)
        return begin, self.history[begin:]

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
        count = sum(1 for record in self.history if record.time_s < keep_s) if keep_s > -inf else 0
        count = self._whole_steps(min(max(count, len(self.history) - most), fed))
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

    def _whole_steps(self, count: int) -> int:
        """So many records or fewer, so that no step is cut in two."""
        while 0 < count < len(self.history) and any(
            record.pending.step_from_s < self.history[count - 1].time_s and self._begun_before(count, record)
            for record in self.history[count : count + 50]
        ):
            count -= 1
        return count

    def _begun_before(self, count: int, record: Record) -> bool:
        return any(
            (other.pending.device, other.pending.step) == (record.pending.device, record.pending.step)
            for other in self.history[max(count - 50, 0) : count]
        )

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
        moments_s = self._moments_between(begin_s, end_s) if step else []
        nodes = log.nodes_of(step, fixes, moments_s, self._known.reached_s(log.end_s))
        told = self._known.last_fix_s >= end_s or (log.flushed and log.home is not None)
        for i, node in enumerate(nodes):
            later = told or any(other.fixes for other in nodes[i:])
            yield Pending(node.time_s, device, node, step, begin_s, i == len(nodes) - 1, later)

    def _go(self, pending: Pending) -> None:
        device, log, before = pending.device, self.logs[pending.device], self.state
        if log is None:
            return
        pulled, pulls = self._pulled(before, pending.time_s)
        number = log.next_node
        log.nodes.append(pending.node)
        own = self._alone(pulled.alone[device], pending, number, log)
        alone = (*pulled.alone[:device], own, *pulled.alone[device + 1 :])
        joint = pulled.joint
        if joint is not None and own.directed:
            single.load(self._all, joint)
            if own.entered:
                self._all.enter(own.end, device)
            else:
                self._all.advance(pending.node, device)
                self._all.measure(pending.node, device)
            joint = single.unload(self._all)
        present = pulled.present | {device} if own.directed else pulled.present
        at = (*pulled.at[:device], pending, *pulled.at[device + 1 :])
        self.state = WalkState(alone, at, joint, present, pulled.next_tie)
        self.late += pending.is_last and pending.time_s < self._forgotten_s
        place_s = max(pending.time_s, self.history[-1].time_s if self.history else self._forgotten_s)
        entered = own.end if own.entered else None
        self.history.append(Record(pending, number, place_s, before, pulls, pulled, entered, self.state))
        if pending.is_last:
            log.ready = pending.step + 1

    def _alone(self, before: Alone | None, pending: Pending, number: int, log: DeviceLog) -> Alone:
        if before is None:
            prior = self._known.prior(pending.device, len(self.logs))
            return single.begin(pending.node, number, prior, self._one)
        nodes = log.since(before.begin) if not before.directed else ()
        if len(nodes) > self._parameters.remembered_steps:
            return single.begin_anew(before, pending.node, number, self._one)
        return single.follow(before, pending.node, number, nodes, pending.told_later, self._one)

    def _pulled(self, state: WalkState, before_s: float) -> tuple[WalkState, tuple[Pair, ...]]:
        """The state after the tethers whose moment is before a time, and the pairs that were asked for."""
        tether, next_tie, pulls = self._tether, state.next_tie, []
        if tether is None or state.joint is None:
            return state, ()
        single.load(self._all, state.joint)
        last = floor(min(self.now_s, before_s) / tether.every_s)
        next_tie = max(next_tie, ceil(self._least_begin_s() / tether.every_s))
        while next_tie <= last and next_tie * tether.every_s + SAME_S < before_s:
            for a, b in combinations(range(len(self.logs)), 2):
                if self._is_wanted((a, b), next_tie) and _directed(state, a) and _directed(state, b):
                    self._all.keep_together(a, b, tether.max_distance_m, tether.sigma_m)
                    pulls.append((a, b))
            next_tie += 1
        joint = single.unload(self._all) if pulls else state.joint
        return replace(state, joint=joint, next_tie=next_tie), tuple(pulls)

    def _moments_between(self, begin_s: float, end_s: float) -> list[float]:
        """Moments inside a step at which tethers of any pair are asked for."""
        if self._tether is None or len(self.logs) < 2:
            return []
        every_s = self._tether.every_s
        numbers = range(ceil(begin_s / every_s), floor(end_s / every_s) + 1)
        pairs = list(combinations(range(len(self.logs)), 2))
        return [k * every_s for k in numbers if any(self._is_wanted(pair, k) for pair in pairs)]

    def _is_wanted(self, pair: Pair, number: int) -> bool:
        """Whether the tether of a pair is asked for at a moment: while both record."""
        a, b = self.logs[pair[0]], self.logs[pair[1]]
        if a is None or b is None or self._tether is None:
            return False
        every_s = self._tether.every_s
        return ceil(max(a.start_s, b.start_s) / every_s) <= number <= floor(min(a.end_s, b.end_s) / every_s)

    def _first_moment_after(self, pair: Pair, before_s: float, device: int) -> float:
        """The first moment of a pair that came to be asked for when the samples of a device went on from a time."""
        a, b = self.logs[pair[0]], self.logs[pair[1]]
        if a is None or b is None or self._tether is None:
            return inf
        other = b if pair[0] == device else a
        reached_s, every_s = min(before_s, other.end_s), self._tether.every_s
        number = ceil(max(a.start_s, b.start_s) / every_s)
        number = number if reached_s == -inf else max(number, floor(reached_s / every_s) + 1)
        return number * every_s if self._is_wanted(pair, number) else inf

    def _least_begin_s(self) -> float:
        return min(log.start_s for log in self.logs if log is not None)

    def _head(self) -> tuple[float, int]:
        return self.history[-1].time_s, self.history[-1].pending.device


def joint_moments(state: WalkState) -> Moments:
    """Mean (5 d,) and covariance (5 d, 5 d) of all devices; of a single one by itself."""
    if state.joint is None:
        return state.moments(0)
    return Moments(state.joint[0].copy(), 0.5 * (state.joint[1] + state.joint[1].T))


def _directed(state: WalkState, device: int) -> bool:
    own = state.alone[device]
    return own is not None and own.directed


def _place(pending: Pending) -> tuple[float, int]:
    return pending.time_s, pending.device
