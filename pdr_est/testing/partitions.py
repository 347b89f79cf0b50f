"""Ways of cutting the input of a stage, and the exact content of what a stage emits."""

import pickle
from collections.abc import Iterable, Sequence
from dataclasses import fields, is_dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

from pdr_est.types.sensors import ImuBlock, LevelBlock, SensorBlock

Block = SensorBlock | ImuBlock | LevelBlock
_BLOCKS = (SensorBlock, ImuBlock, LevelBlock)


def slice_block(block: Block, start: int, stop: int) -> Block:
    """Copy the samples start to stop (exclusive) of a block, possibly none."""
    own = {
        field.name: getattr(block, field.name)[start:stop].copy()
        for field in fields(block)
        if isinstance(getattr(block, field.name), np.ndarray)
    }
    if isinstance(block, SensorBlock):
        return replace(block, **own)
    hole = block.hole if start == 0 else None
    return replace(block, first_index=block.first_index + start, hole=hole, **own)


def cut_block(block: Block, rng: np.random.Generator, pieces: int) -> list[Block]:
    """Cut a block at random into a number of pieces, some of them possibly empty."""
    borders = np.sort(rng.integers(0, len(block.time_s) + 1, pieces - 1))
    edges = [0, *borders.tolist(), len(block.time_s)]
    return [slice_block(block, start, stop) for start, stop in pairwise(edges)]


def cut_randomly(items: Sequence[Any], rng: np.random.Generator) -> list[Any]:
    """Cut blocks at random and interleave channels at random; items that are no blocks stay as they are."""
    if not items or not isinstance(items[0], _BLOCKS):
        return list(items)
    pieces = [cut_block(block, rng, int(rng.integers(1, 60))) for block in items]
    if isinstance(items[0], SensorBlock):
        return interleave(pieces, rng)
    return [piece for block in pieces for piece in block]


def cut_finely(items: Sequence[Any]) -> list[Any]:
    """Cut blocks into single samples, those of several channels in order of time; other items stay as they are."""
    if not items or not isinstance(items[0], _BLOCKS):
        return list(items)
    return in_time_order(items) if isinstance(items[0], SensorBlock) else one_by_one(items)


def one_by_one(blocks: Iterable[Block]) -> list[Block]:
    """Cut blocks into single samples, block after block."""
    return [slice_block(block, i, i + 1) for block in blocks for i in range(len(block.time_s))]


def interleave(streams: Sequence[Sequence[Any]], rng: np.random.Generator) -> list[Any]:
    """Put the items of several streams into a random order that keeps the order within each stream."""
    turns = rng.permutation(np.repeat(np.arange(len(streams)), [len(stream) for stream in streams]))
    iterators = [iter(stream) for stream in streams]
    return [next(iterators[turn]) for turn in turns]


def in_bursts(streams: Sequence[Sequence[SensorBlock]], lag_s: float, rng: np.random.Generator) -> list[SensorBlock]:
    """Put the blocks of several streams into the order in which a recorder sends them.

    The first stream is sent every lag_s, the others ten times as often. Clocks must not run back.
    """
    arrivals = []
    for number, stream in enumerate(streams):
        every_s, known_s = lag_s / (10.0 if number else 1.0), -np.inf
        begin_s = rng.uniform(0.0, every_s)
        for block in stream:
            if len(block.time_s):
                known_s = begin_s + every_s * np.ceil((float(block.time_s[-1]) - begin_s) / every_s)
            arrivals.append((known_s, number, block))
    return [block for _, _, block in sorted(arrivals, key=lambda arrival: arrival[:2])]


def in_time_order(blocks: Sequence[SensorBlock]) -> list[Block]:
    """Cut blocks into single samples, the channels in step with each other as a live recorder delivers them."""
    counts = [len(block.time_s) for block in blocks]
    order = sorted((i / count, n, i) for n, count in enumerate(counts) for i in range(count))
    return [slice_block(blocks[n], i, i + 1) for _, n, i in order]


def run_stage(stage: Any, items: Iterable[Any], restore_at: Sequence[int] = ()) -> tuple[list[Any], Any]:
    """Run a stage to its end, and return its outputs and the stage.

    Parameters
    ----------
    stage
        The stage.
    items
        Inputs, in order.
    restore_at
        Numbers of the inputs before which the stage is pickled and restored.
    """
    outputs: list[Any] = []
    for number, item in enumerate(items):
        if number in restore_at:
            stage = pickle.loads(pickle.dumps(stage))
        outputs += stage.push(item)
    return outputs + stage.flush(), stage


def exact_content(outputs: Sequence[Any]) -> list[Any]:
    """Convert outputs to values that compare to the last bit, blocks sample by sample however they were cut."""
    exact: list[Any] = []
    for output in outputs:
        if isinstance(output, ImuBlock | LevelBlock):
            exact += [_exact(slice_block(output, i, i + 1)) for i in range(len(output.time_s))]
        else:
            exact.append(_exact(output))
    return exact


def _exact(value: Any) -> Any:
    if is_dataclass(value):
        return (type(value).__name__, *(_exact(getattr(value, field.name)) for field in fields(value)))
    if isinstance(value, np.ndarray):
        return (value.dtype.str, value.shape, value.tobytes())
    if isinstance(value, float):
        return float(value).hex()
    if type(value) is tuple:  # a NaN inside is not itself any more when it comes back from a pickle
        return tuple(_exact(item) for item in value)
    return value
