"""Samples of many steps at once.

An operation on a few samples costs more for its call than for its arithmetic. Steps with the same number of samples
are therefore computed together, as the rows of an array. Sums along a row, and products of each row by itself, do not
depend on the other rows, so that a step has the same numbers to the last bit in whatever batch it comes.
"""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.types.steps import Step

Places = NDArray[np.intp]


class StepSamples:
    """Columns of the samples of some steps, one step after the other.

    Parameters
    ----------
    steps : Sequence[Step]
        At least one step.

    Attributes
    ----------
    count, start : ndarray of int, shape (steps,)
        Number of samples of each step, and the place of its first one.
    """

    def __init__(self, steps: Sequence[Step]) -> None:
        self._blocks = [step.samples for step in steps]
        self.count: Places = np.array([len(block.time_s) for block in self._blocks])
        self.start: Places = self.count.cumsum() - self.count

    def column(self, name: str) -> Array:
        """Join a column of `LevelBlock`, which every step must have."""
        columns = [getattr(block, name) for block in self._blocks]
        return columns[0] if len(columns) == 1 else np.concatenate(columns)


def of_equal_count(count: Places) -> Iterator[tuple[int, Places]]:
    """Yield each number of samples that occurs, and the places of the steps that have it, in their order."""
    if len(count) == 1:
        yield int(count[0]), np.zeros(1, dtype=np.intp)
        return
    order = count.argsort(kind="stable")
    ordered = count[order]
    borders = np.flatnonzero(ordered[1:] != ordered[:-1]) + 1
    for places in np.split(order, borders):
        yield int(count[places[0]]), places


def rows_from(values: Array, start: Places, count: int) -> Array:
    """Return the `count` samples from each place on as rows: (steps, count), or (steps, count, k) for k columns."""
    if len(start) == 1:
        begin = int(start[0])
        return values[None, begin : begin + count]
    rows: Array = values[start[:, None] + np.arange(count)]
    return rows
