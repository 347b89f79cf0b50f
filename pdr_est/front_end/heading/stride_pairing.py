"""Steps two by two: what a phone at a leg does comes back once a stride, every two steps."""

from collections.abc import Sequence
from typing import TypeVar

import numpy as np

from pdr_est.frames import Array
from pdr_est.front_end.heading.step_yaw import calibrated_mean_yaw
from pdr_est.types.steps import Step, begins_walk

Heading = TypeVar("Heading", float, Array)

STRIDE_LATENCY_S = 2.0  # a step waits for the next one, which in a walk comes before it counts as a standstill


class StridePairing:
    """Pairs of steps that follow each other. One that no step follows before a standstill or a gap stays alone; it
    is known to be alone when the next step comes, or at the end."""

    def __init__(self) -> None:
        self._first: Step | None = None

    def add(self, step: Step) -> list[tuple[Step, ...]]:
        """Take the next step; return what is now complete."""
        first = self._first
        if first is None or begins_walk(step, first):
            self._first = step
            return [] if first is None else [(first,)]
        self._first = None
        return [(first, step)]

    def rest(self) -> list[tuple[Step, ...]]:
        """The step that waits, alone; what comes next begins a pair."""
        first, self._first = self._first, None
        return [] if first is None else [(first,)]


def mean_yaw_of(steps: Sequence[Step]) -> float:
    """Mean yaw, rad in (-pi, pi], over all samples of some steps."""
    return calibrated_mean_yaw(np.concatenate([step.samples.yaw_rad for step in steps]))


def stride_average(before: Heading, at: Heading, after: Heading) -> Heading:
    """Headings, rad, not wrapped, of steps and their neighbours averaged so that what goes to and fro with the legs,
    from one step to the next, cancels."""
    return 0.25 * before + 0.5 * at + 0.25 * after
