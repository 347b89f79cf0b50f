"""Join and cut blocks of level samples."""

from collections.abc import Iterable, Sequence
from dataclasses import fields
from operator import attrgetter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pdr_est.types.sensors import LevelBlock

_COLUMNS = tuple(field.name for field in fields(LevelBlock) if field.name not in ("first_index", "segment", "hole"))
_columns_of = attrgetter(*_COLUMNS)


def join(blocks: Sequence[LevelBlock]) -> LevelBlock:
    """Join consecutive blocks of one segment into one block.

    Parameters
    ----------
    blocks : Sequence[LevelBlock]
        At least one block; the samples of each follow those of the block before.
    """
    if len(blocks) == 1:
        return blocks[0]
    columns = map(_joined, zip(*map(_columns_of, blocks), strict=True))
    first = blocks[0]
    return LevelBlock(first.first_index, first.segment, hole=first.hole, **dict(zip(_COLUMNS, columns, strict=True)))


def _joined(columns: Sequence[NDArray[Any] | None]) -> Any:
    """Concatenate the same column of all blocks; a column that the device does not record is None in all of them."""
    present = [column for column in columns if column is not None]
    return np.concatenate(present) if present else None


def take(blocks: list[LevelBlock], count: int) -> LevelBlock:
    """Remove the first `count` samples, at least one, from a list of consecutive blocks, and return them.

    Parameters
    ----------
    blocks : list[LevelBlock]
        Blocks of one segment with at least `count` samples; changed in place.
    count : int
        Number of samples.
    """
    taken: list[LevelBlock] = []
    while count > 0:
        block = blocks.pop(0)
        if len(block) > count:
            blocks.insert(0, part(block, count, len(block)))
            block = part(block, 0, count)
        taken.append(block)
        count -= len(block)
    return join(taken)


def part(block: LevelBlock, start: int, stop: int) -> LevelBlock:
    """Return samples `start` to `stop` (exclusive) of a block.

    The columns are views, because arrays are never changed in place.
    """
    return parts(block, [(start, stop)])[0]


def parts(block: LevelBlock, spans: Iterable[tuple[int, int]]) -> list[LevelBlock]:
    """Return several spans of samples of a block, each as `part` does."""
    # Without the constructor, which sets each field by a call of its own: a walk has thousands of parts.
    same = {name: value for name, value in block.__dict__.items() if name not in _COLUMNS or value is None}
    columns = [(name, block.__dict__[name]) for name in _COLUMNS if name not in same]
    found = []
    for start, stop in spans:
        one, values = object.__new__(LevelBlock), same.copy()
        values["first_index"], values["hole"] = block.first_index + start, block.hole if start == 0 else None
        for name, column in columns:
            values[name] = column[start:stop]
        object.__setattr__(one, "__dict__", values)
        found.append(one)
    return found
