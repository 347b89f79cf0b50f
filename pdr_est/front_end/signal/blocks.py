"""Joining and cutting blocks of level samples."""

from collections.abc import Sequence
from dataclasses import fields
from operator import attrgetter

import numpy as np

from pdr_est.records import LevelBlock

_OPTIONAL = "magnetic_field_ut"  # None in all blocks of a device, or in none
_COLUMNS = tuple(
    field.name for field in fields(LevelBlock) if field.name not in ("first_index", "segment", _OPTIONAL)
)
_columns_of = attrgetter(*_COLUMNS)


def join(blocks: Sequence[LevelBlock]) -> LevelBlock:
    """Consecutive blocks of one segment as one block."""
    if len(blocks) == 1:
        return blocks[0]
    columns = map(np.concatenate, zip(*map(_columns_of, blocks), strict=True))
    fields_ut = [block.magnetic_field_ut for block in blocks if block.magnetic_field_ut is not None]
    return LevelBlock(
        blocks[0].first_index,
        blocks[0].segment,
        **dict(zip(_COLUMNS, columns, strict=True)),
        magnetic_field_ut=np.concatenate(fields_ut) if fields_ut else None,
    )


def take(blocks: list[LevelBlock], count: int) -> LevelBlock:
    """Take the first `count` samples, at least one, off a list of consecutive blocks of one segment."""
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
    """Samples start to stop (exclusive) of a block: views, as nobody changes arrays in place."""
    columns = {name: getattr(block, name)[start:stop] for name in _COLUMNS}
    field_ut = None if block.magnetic_field_ut is None else block.magnetic_field_ut[start:stop]
    return LevelBlock(
        first_index=block.first_index + start, segment=block.segment, **columns, magnetic_field_ut=field_ut
    )
