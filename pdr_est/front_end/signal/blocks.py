"""Joining and cutting blocks of level samples."""

from collections.abc import Sequence
from dataclasses import fields

import numpy as np

from pdr_est.records import LevelBlock

_COLUMNS = tuple(field.name for field in fields(LevelBlock) if field.name not in ("first_index", "segment"))


def join(blocks: Sequence[LevelBlock]) -> LevelBlock:
    """Consecutive blocks of one segment as one block."""
    if len(blocks) == 1:
        return blocks[0]
    columns = {name: np.concatenate([getattr(block, name) for block in blocks]) for name in _COLUMNS}
    return LevelBlock(first_index=blocks[0].first_index, segment=blocks[0].segment, **columns)


def part(block: LevelBlock, start: int, stop: int) -> LevelBlock:
    """Samples start to stop (exclusive) of a block: views, as nobody changes arrays in place."""
    columns = {name: getattr(block, name)[start:stop] for name in _COLUMNS}
    return LevelBlock(first_index=block.first_index + start, segment=block.segment, **columns)
