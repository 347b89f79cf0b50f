"""Pair steps into strides: the motion of a phone at a leg repeats once per stride, every two steps."""

from collections.abc import Sequence
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.front_end.heading.step_yaw import calibrated_mean_yaw
from pdr_est.types.steps import Step, begins_walk

Heading = TypeVar("Heading", float, Array, NDArray[np.complex128])
Values = TypeVar("Values", Array, NDArray[np.complex128])

STRIDE_LATENCY_S = 2.0  # a step waits for the next one, which in a walk comes before it counts as a standstill


class StridePairing:
    """Pair steps that follow each other.

    A step that no other follows before a standstill or a gap stays alone; it is known to be alone when the next step
    comes, or at the end.
    """

    def __init__(self) -> None:
        self._first: Step | None = None

    def add(self, step: Step) -> list[tuple[Step, ...]]:
        """Take the next step and return the pairs, or lone steps, that are now complete."""
        first = self._first
        if first is None or begins_walk(step, first):
            self._first = step
            return [] if first is None else [(first,)]
        self._first = None
        return [(first, step)]

    def flush(self) -> list[tuple[Step, ...]]:
        """Return the step that waits, alone; the next step begins a pair."""
        first, self._first = self._first, None
        return [] if first is None else [(first,)]


def mean_yaw_of(steps: Sequence[Step]) -> float:
    """Compute the mean yaw, rad in (-pi, pi], over all samples of some steps."""
    return calibrated_mean_yaw(np.concatenate([step.samples.yaw_rad for step in steps]))


def stride_average(before: Heading, at: Heading, after: Heading) -> Heading:
    """Average values with those of the steps before and after, with weights 1/4, 1/2, 1/4.

    What goes to and fro with the legs from one step to the next cancels.

    Parameters
    ----------
    before, at, after : float or ndarray
        Values; headings must not be wrapped.
    """
    return 0.25 * before + 0.5 * at + 0.25 * after


def stride_averages(values: Values) -> Values:
    """Average values (n,) of successive steps over the stride; the first and the last one have a single neighbour.

    It stands for both. A single value stays as it is.
    """
    if len(values) < 2:
        return values
    padded = np.concatenate([values[1:2], values, values[-2:-1]])
    return stride_average(padded[:-2], padded[1:-1], padded[2:])
