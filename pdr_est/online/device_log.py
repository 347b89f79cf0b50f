"""Log of one device: the steps and nodes that can still be filtered again, and the nodes that wait for the filter."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from math import inf

from pdr_est.estimators.common.nodes import Node, NodeBuilder
from pdr_est.estimators.common.tether_schedule import TetherSchedule
from pdr_est.online.start_and_fixes import StartAndFixes
from pdr_est.types.measurements import HeadingPrior, PositionFix, StepOdometry

Fixes = Sequence[PositionFix]
"""Position fixes as ordered by `sort_fixes`."""


@dataclass(frozen=True)
class PendingNode:
    """Node that waits for the filter.

    Attributes
    ----------
    time_s
        Time of the node.
    device
        Number of the device.
    node
        The node.
    step
        Number of the step that it belongs to.
    step_first_s
        Time of the first node of that step.
    ends_step
        True for the last node of the step.
    heading_observed_later
        True if this node or a later one of the device observes the heading.
    """

    time_s: float
    device: int
    node: Node
    step: int
    step_first_s: float
    ends_step: bool
    heading_observed_later: bool

    @property
    def order(self) -> tuple[float, int]:
        """Return the place in the order of processing: time, then device."""
        return self.time_s, self.device


class DeviceLog:
    """Measurements of one device and their progress through the filter; old ones are forgotten, numbers stay.

    Parameters
    ----------
    start_s
        Time of the first sample.

    Attributes
    ----------
    start_s
        Time of the first sample.
    end_s
        Time up to which the samples reach.
    next_step
        Number of the next step that the filter must process.
    released
        Number of the first step that the filter may not process yet.
    complete
        True once all samples have come.
    closing_fix
        Fix at the end of a closed walk, if there is one.
    last_heading_s
        Time of the latest heading prior in the map.
    nodes
        Remembered nodes that the filter has processed.
    """

    def __init__(self, start_s: float) -> None:
        self.start_s = start_s
        self.end_s = -inf
        self.next_step = 0
        self.released = 0
        self.complete = False
        self.closing_fix: PositionFix | None = None
        self.last_heading_s = -inf
        self.nodes: list[Node] = []
        self._first_node = 0  # number of the first remembered node
        self._builder = NodeBuilder(start_s)

    @property
    def last_step(self) -> int:
        """Number of the last known step."""
        return self._builder.count

    @property
    def next_node(self) -> int:
        """Number of the next node that the filter will process."""
        return self._first_node + len(self.nodes)

    @property
    def remembered(self) -> int:
        """Number of remembered steps and nodes."""
        return self._builder.remembered + len(self.nodes)

    def append(self, item: StepOdometry | HeadingPrior) -> None:
        """Add the next step, or a heading prior."""
        self._builder.append(item)
        if isinstance(item, HeadingPrior) and not item.relative:
            self.last_heading_s = max(self.last_heading_s, item.time_s)

    def step_end_s(self, number: int) -> float:
        """Return the time at which a step ends; for number 0, the time at which the walk begins."""
        return self._builder.step_end_s(number)

    def motion_begin_s(self, number: int) -> float:
        """Return the time at which the motion of a step begins; minus infinity for the start and forgotten steps."""
        return self._builder.motion_begin_s(number)

    def standing_fixes(self, number: int, fixes: Fixes, known_until_s: float) -> tuple[PositionFix, ...]:
        """Return the fixes at the end of a step and while the walker stands still after it.

        Parameters
        ----------
        number
            Number of the step.
        fixes
            All fixes.
        known_until_s
            No step that is still to come begins before this time.
        """
        found = self._builder.standing_fixes(number, fixes, inf if self.complete else known_until_s)
        if self.closing_fix is None or not self.complete or number != self.last_step:
            return found
        return (*found, self.closing_fix)

    def pending_nodes(
        self,
        device: int,
        step: int,
        fixes: Fixes,
        split_times_s: Sequence[float],
        known_until_s: float,
        last_fix_s: float,
    ) -> Iterator[PendingNode]:
        """Make the nodes of a step for the filter.

        Parameters
        ----------
        device
            Number of this device.
        step
            Number of the step.
        fixes
            All fixes.
        split_times_s
            Times within the step at which a node is wanted.
        known_until_s
            No step that is still to come begins before this time.
        last_fix_s
            Time of the latest fix that is known.
        """
        nodes = self._builder.nodes_of(step, fixes, split_times_s, inf if self.complete else known_until_s)
        closing = (self.closing_fix,) if self.complete and self.closing_fix is not None else ()
        if closing and step == self.last_step:
            nodes[-1] = replace(nodes[-1], fixes=(*nodes[-1].fixes, *closing))
        observed = bool(closing) or max(last_fix_s, self.last_heading_s) >= self.step_end_s(step)
        for i, node in enumerate(nodes):
            later = observed or any(other.observes_heading for other in nodes[i:])
            ends_step = i == len(nodes) - 1
            yield PendingNode(node.time_s, device, node, step, nodes[0].time_s, ends_step, later)

    def rewind_time_s(self, fix_s: float) -> float:
        """Return the time at which the motion began whose nodes use a fix; infinity if they are still to come."""
        number = self.next_step
        if number == 0 or (number <= self.last_step and fix_s > self.motion_begin_s(number)):
            return inf
        if number > self.last_step and fix_s > self.step_end_s(number - 1) and not self.complete:
            return self.motion_begin_s(number - 1) if fix_s <= self.end_s else inf
        number -= 1
        while self.motion_begin_s(number) >= fix_s:
            number -= 1
        return self.motion_begin_s(number)

    def release(self, until_s: float) -> None:
        """Allow the filter to process the steps that end up to a time."""
        number = max(self.released, 1)
        while number <= self.last_step and self.step_end_s(number) <= until_s:
            number += 1
        self.released = number if number > 1 or self.complete else 0

    def rewind(self, step: int, node: int) -> None:
        """Return to before a node, and to the beginning of its step."""
        self.next_step = min(self.next_step, step)
        del self.nodes[max(node - self._first_node, 0) :]

    def forget(self, step: int, node: int) -> None:
        """Forget steps and nodes before these numbers."""
        self._builder.forget(step)
        drop = min(max(node - self._first_node, 0), len(self.nodes))
        del self.nodes[:drop]
        self._first_node += drop


def release_steps(logs: Sequence[DeviceLog | None], now_s: float, wait_s: float) -> None:
    """Release the steps of each device up to the time that all others have reached, or were waited for.

    Parameters
    ----------
    logs
        Log of each device; None before its first sample.
    now_s
        Newest data time of all devices.
    wait_s
        Time for which a device waits for the others.
    """
    for device, log in enumerate(logs):
        if log is not None:
            others = [other for number, other in enumerate(logs) if number != device]
            reached_s = min((-inf if other is None else other.end_s for other in others), default=inf)
            log.release(inf if log.complete else max(reached_s, now_s - wait_s))


def queue_nodes(
    logs: Sequence[DeviceLog | None], known: StartAndFixes, schedule: TetherSchedule
) -> list[PendingNode]:
    """Make all released nodes that the filter has not processed, in order of time and device."""
    queue: list[PendingNode] = []
    for device, log in enumerate(logs):
        if log is None:
            continue
        until_s = known.known_until_s(log.end_s)
        for step in range(log.next_step, log.released):
            splits_s = schedule.times_between(log.motion_begin_s(step), log.step_end_s(step)) if step else []
            queue += log.pending_nodes(device, step, known.fixes, splits_s, until_s, known.last_fix_s)
    return sorted(queue, key=lambda pending: pending.order)
