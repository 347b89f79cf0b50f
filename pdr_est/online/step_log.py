"""The measurements of one device that may still be gone through again, and the nodes that they make."""

from bisect import bisect_left, bisect_right
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from pdr_est.estimators.common.timeline import Node, SplitPoint, split_step
from pdr_est.types.measurements import HeadingPrior, PositionFix, StepOdometry
from pdr_est.types.steps import CarryingMode

Fixes = Sequence[PositionFix]  # in order of time


class DeviceLog:
    """Steps of a device by number, 1 for the first; 0 is the start. Old ones are forgotten, numbers stay.

    nodes: those that the filter has gone through, by number likewise. ready: number of the next step that the filter
    has to go through; released: of the first that may not be used yet.
    """

    def __init__(self, start_s: float) -> None:
        self.start_s = start_s
        self.end_s = -np.inf  # of the samples
        self.ready = 0
        self.released = 0
        self.flushed = False
        self.home: PositionFix | None = None
        self._first = 1  # number of the oldest step that is remembered
        self._end_before_s = start_s  # end of the step before that
        self._steps: list[StepOdometry] = []
        self._priors: list[tuple[HeadingPrior, ...]] = []
        self._first_node = 0
        self.nodes: list[Node] = []

    @property
    def count(self) -> int:
        """Number of the last step that is known."""
        return self._first + len(self._steps) - 1

    def append(self, item: StepOdometry | HeadingPrior) -> None:
        if isinstance(item, HeadingPrior):
            self._priors[-1] = (*self._priors[-1], item)
            return
        self._steps.append(item)
        self._priors.append(())
        if self.count == 1:
            self._end_before_s = min(self.start_s, item.time_s)

    def step_end_s(self, number: int) -> float:
        """When a step is over; 0: when the walk begins."""
        return self._end_before_s if number < self._first else self._steps[number - self._first].time_s

    def begin_s(self, number: int) -> float:
        """When the movement of a step begins; of the start, and of steps that are forgotten, long ago."""
        if number < self._first or number == 0:
            return -np.inf
        return max(self._steps[number - self._first].start_s, self.step_end_s(number - 1))

    def nodes_of(self, number: int, fixes: Fixes, split_times_s: Sequence[float], reached_s: float) -> list[Node]:
        """The nodes of a step, or of the start. reached_s: no step that is still to come begins before that."""
        standing = self.standing(number, fixes, reached_s)
        if number == 0:
            begin_s = self.step_end_s(0)
            mode = self._steps[0].mode if self._steps else CarryingMode.UNKNOWN
            return [Node(begin_s, begin_s, 0.0, 0.0, np.zeros((3, 3)), True, 0.0, mode, fixes=standing)]
        step, begin_s = self._steps[number - self._first], self.begin_s(number)
        inside = _from_to(fixes, begin_s, step.time_s)
        moments = [SplitPoint(fix.time_s, (fix,)) for fix in inside if begin_s < fix.time_s < step.time_s]
        moments += [SplitPoint(time_s, ()) for time_s in split_times_s if begin_s < time_s < step.time_s]
        *before, last = split_step(step, begin_s, sorted(moments, key=lambda moment: moment.time_s))
        priors = self._priors[number - self._first]
        return [*before, replace(last, fixes=standing, priors=priors)]

    def before_fix_s(self, time_s: float) -> float:
        """When the movement began at whose nodes a fix at a time is used; infinite while that is still ahead."""
        if self.ready == 0 or (self.ready <= self.count and time_s > self.begin_s(self.ready)):
            return np.inf
        if self.ready > self.count and time_s > self.step_end_s(self.ready - 1) and not self.flushed:
            return self.begin_s(self.ready - 1) if time_s <= self.end_s else np.inf
        number = self.ready - 1
        while self.begin_s(number) >= time_s:
            number -= 1
        return self.begin_s(number)

    def since(self, begin: int) -> list[Node]:
        """The nodes from a number on that are remembered."""
        return self.nodes[max(begin - self._first_node, 0) :]

    @property
    def next_node(self) -> int:
        return self._first_node + len(self.nodes)

    def undo(self, step: int, node: int) -> None:
        """Go back to before a node of a step, and to the beginning of the step."""
        self.ready = min(self.ready, step)
        del self.nodes[max(node - self._first_node, 0) :]

    def forget(self, step: int, node: int) -> None:
        """Steps and nodes before these numbers."""
        drop = min(max(step - self._first, 0), max(len(self._steps) - 1, 0))
        if drop:
            self._end_before_s = self._steps[drop - 1].time_s
            del self._steps[:drop], self._priors[:drop]
            self._first += drop
        drop = min(max(node - self._first_node, 0), len(self.nodes))
        del self.nodes[:drop]
        self._first_node += drop

    def standing(self, number: int, fixes: Fixes, reached_s: float) -> tuple[PositionFix, ...]:
        """The fixes at the end of a step and while the walker stands afterwards."""
        from_s = -np.inf if number == 0 else self.step_end_s(number)
        if number < self.count:
            until_s = self.begin_s(number + 1)
        else:
            until_s = np.inf if self.flushed else max(reached_s, self.step_end_s(number))
        found = tuple(_from_to(fixes, from_s, until_s))
        last = self.flushed and number == self.count and self.home is not None
        return (*found, self.home) if last and self.home is not None else found


def _from_to(fixes: Fixes, from_s: float, until_s: float) -> Fixes:
    begin = bisect_left(fixes, from_s, key=lambda fix: fix.time_s)
    return fixes[begin : bisect_right(fixes, until_s, key=lambda fix: fix.time_s)]
