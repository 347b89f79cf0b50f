"""Samples of many steps at once.

An operation on a few samples costs more for its call than for its arithmetic. Steps with the same number of samples
are therefore computed together, as the rows of an array. Sums along a row, and products of each row by itself, do not
depend on the other rows, so that a step has the same numbers to the last bit in whatever batch it comes.
"""

from collections.abc import Callable, Iterator, Sequence
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.types.sensors import LevelBlock
from pdr_est.types.steps import Step

Places = NDArray[np.intp]
Result = TypeVar("Result")

_AT_ONCE = 128  # steps: their samples fit into the cache of a processor


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
        self._set([step.samples for step in steps])

    @classmethod
    def of_blocks(cls, blocks: Sequence[LevelBlock]) -> "StepSamples":
        """Join the samples of steps that are given without the steps, at least one."""
        found = object.__new__(cls)
        found._set(blocks)
        return found

    def _set(self, blocks: Sequence[LevelBlock]) -> None:
        self._blocks = blocks
        self.count: Places = np.array([len(block.time_s) for block in blocks])
        self.start: Places = self.count.cumsum() - self.count

    def column(self, name: str) -> Array:
        """Join a column of `LevelBlock`, which every step must have."""
        columns = [getattr(block, name) for block in self._blocks]
        return columns[0] if len(columns) == 1 else np.concatenate(columns)

    def sums(self, terms: Array) -> Array:
        """Return the sums (k, steps) over each step, of at least one sample, of terms (k, samples)."""
        return np.asarray(np.add.reduceat(terms, self.start, axis=1))


def for_each_step(
    blocks: Sequence[LevelBlock], compute: Callable[[StepSamples], Sequence[Result]], without: Result
) -> list[Result]:
    """Compute something of each of many steps from its samples, for some steps at once.

    Parameters
    ----------
    blocks : Sequence[LevelBlock]
        Samples of each step.
    compute : callable
        Function of the samples of some steps, at least one sample each, that returns the result of each step.
    without
        Result of a step without samples.
    """
    found = [without] * len(blocks)
    usable = [number for number, block in enumerate(blocks) if len(block.time_s)]
    for begin in range(0, len(usable), _AT_ONCE):
        part = usable[begin : begin + _AT_ONCE]
        samples = StepSamples.of_blocks([blocks[number] for number in part])
        for number, result in zip(part, compute(samples), strict=True):
            found[number] = result
    return found


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
