"""The contract of a stage, and the partition test.

`docs/writing-a-stage.md` explains the contract.
"""

import pickle
from collections.abc import Callable, Sequence
from numbers import Real
from typing import Any

import numpy as np

from pdr_est.stage import BatchStage, TellingStage
from pdr_est.testing.partitions import cut_finely, cut_randomly, exact_content, run_stage, slice_block
from pdr_est.types.sensors import ImuBlock, LevelBlock, SensorBlock

_RANDOM_CUTS = 3
_RESTORED = 3  # how often a stage is pickled and restored in each run


def check_stage(factory: Callable[[], Any], items: Sequence[Any]) -> None:
    """Check what every stage promises, apart from how its input is cut.

    It has `push`, `flush` and `latency_s`; both methods return lists; inputs are not changed; two stages share no
    state; empty blocks change nothing; a stage can be pickled; and of level samples no output comes later than
    `latency_s` after its phenomenon.

    Parameters
    ----------
    factory
        Callable that makes a new stage.
    items
        Inputs from which the stage emits something, such as those of `stage_inputs`.

    Raises
    ------
    AssertionError
        With what is wrong.
    """
    stage = factory()
    name = type(stage).__name__
    for attribute in ("push", "flush", "latency_s"):
        assert hasattr(stage, attribute), f"{name} has no {attribute}"
    latency_s = stage.latency_s
    assert isinstance(latency_s, Real), f"{name}.latency_s is {latency_s!r}: it must be a number of seconds"
    assert float(latency_s) >= 0.0, f"{name}.latency_s is {latency_s!r}: it must be 0 or more"
    before = exact_content(items)
    outputs = _outputs_of(stage, items, name)
    assert outputs, f"{name} emits nothing for these inputs: give inputs with something to find"
    assert exact_content(items) == before, f"{name} changes its inputs: make new records with dataclasses.replace"
    expected = exact_content(outputs)
    _check_independence(factory, items, expected, name)
    _check_empty_blocks(factory, items, expected, name)
    if isinstance(items[0], LevelBlock):
        _check_latency(factory(), items, name)
    try:
        pickle.loads(pickle.dumps(stage))
    except Exception as error:
        raise AssertionError(
            f"{name} cannot be pickled ({error}): keep functions and files out of its state"
        ) from error


def check_partition(
    factory: Callable[[], Any],
    items: Sequence[Any],
    cuttings: Sequence[Sequence[Any]] | None = None,
    seed: int = 0,
    compare: Callable[[Any], Any] | None = None,
) -> None:
    """Check that a stage emits the same to the last bit however its input is cut, and however often it is restored.

    Parameters
    ----------
    factory
        Callable that makes a new stage.
    items
        Inputs, uncut.
    cuttings
        Ways of cutting them; default: three at random, with empty blocks and interleaved channels, and one sample at
        a time.
    seed
        Seed of the random cuts, and of the places at which the stage is pickled and restored.
    compare
        Function of the stage at the end whose result must not depend on the cut either.

    Raises
    ------
    AssertionError
        With the first output that differs.
    """
    rng = np.random.default_rng(seed)
    if cuttings is None:
        cuttings = [*(cut_randomly(items, rng) for _ in range(_RANDOM_CUTS)), cut_finely(items)]
    outputs, stage = run_stage(factory(), items)
    name, expected = type(stage).__name__, exact_content(outputs)
    assert expected, f"{name} emits nothing for these inputs: give inputs with something to find"
    for number, pieces in enumerate(cuttings, start=1):
        restore_at = [int(place) for place in rng.integers(0, len(pieces), _RESTORED)]
        found, other = run_stage(factory(), pieces, restore_at)
        where = f"{name}, cut {number} of {len(cuttings)} into {len(pieces)} pieces"
        _refuse_difference(exact_content(found), expected, where)
        _check_batches(factory, pieces, rng, expected, where)
        if compare is not None:
            assert compare(other) == compare(stage), f"{where}: ends in {compare(other)}, uncut in {compare(stage)}"


def _check_batches(
    factory: Callable[[], Any], items: Sequence[Any], rng: np.random.Generator, expected: list[Any], where: str
) -> None:
    """Check a stage that takes many items at once: batches cut at random give what single items give."""
    stage = factory()
    if not isinstance(stage, BatchStage):
        return
    outputs: list[Any] = []
    cuts = sorted(int(cut) for cut in rng.integers(0, len(items) + 1, _RANDOM_CUTS))
    for begin, end in zip([0, *cuts], [*cuts, len(items)], strict=True):
        outputs += stage.push_all(items[begin:end])
    _refuse_difference(exact_content(outputs + stage.flush()), expected, f"{where}, by push_all")
    _check_telling(factory, items, cuts, where)


def _check_telling(factory: Callable[[], Any], items: Sequence[Any], cuts: Sequence[int], where: str) -> None:
    """Check a stage that tells the outputs of many items apart: each item gets what `push` gives at it."""
    telling, single = factory(), factory()
    if not isinstance(telling, TellingStage):
        return
    for begin, end in zip([0, *cuts], [*cuts, len(items)], strict=True):
        of_items = telling.push_each(items[begin:end])
        expected = [single.push(item) for item in items[begin:end]]
        assert list(map(exact_content, of_items)) == list(map(exact_content, expected)), (
            f"{where}: push_each gives items {begin} to {end} other outputs than push"
        )


def _outputs_of(stage: Any, items: Sequence[Any], name: str) -> list[Any]:
    outputs: list[Any] = []
    for item in items:
        emitted = stage.push(item)
        assert isinstance(emitted, list), f"{name}.push returns {type(emitted).__name__}: it must return a list"
        outputs += emitted
    emitted = stage.flush()
    assert isinstance(emitted, list), f"{name}.flush returns {type(emitted).__name__}: it must return a list"
    return outputs + emitted


def _check_independence(factory: Callable[[], Any], items: Sequence[Any], expected: list[Any], name: str) -> None:
    """Run two stages in turns: what one of them has seen must not reach the other."""
    one, other = factory(), factory()
    assert one is not other, f"the factory of {name} gives one stage twice: it must make a new one at each call"
    found: tuple[list[Any], list[Any]] = ([], [])
    for item in items:
        found[0].extend(one.push(item))
        found[1].extend(other.push(item))
    found[0].extend(one.flush())
    found[1].extend(other.flush())
    for outputs in found:
        _refuse_difference(exact_content(outputs), expected, f"two stages {name} in turns share state")


def _check_empty_blocks(factory: Callable[[], Any], items: Sequence[Any], expected: list[Any], name: str) -> None:
    first, last = items[0], items[-1]
    if isinstance(first, SensorBlock | ImuBlock | LevelBlock):
        empty = [slice_block(first, 0, 0), *items, slice_block(last, len(last.time_s), len(last.time_s))]
        _refuse_difference(exact_content(run_stage(factory(), empty)[0]), expected, f"{name} with empty blocks")


def _check_latency(stage: Any, items: Sequence[LevelBlock], name: str) -> None:
    for block in cut_finely(items):
        for output in stage.push(block):
            if getattr(output, "segment", None) != block.segment:
                continue
            phenomenon_s = float(np.min(output.time_s))
            late_s = float(block.time_s[-1]) - phenomenon_s
            assert late_s <= stage.latency_s + 1e-6, (
                f"{name}: the output of {phenomenon_s:.3f} s comes {late_s:.3f} s later, "
                f"more than latency_s = {stage.latency_s:.3f}"
            )


def _refuse_difference(found: list[Any], expected: list[Any], where: str) -> None:
    for number, (one, other) in enumerate(zip(found, expected, strict=False)):
        assert one == other, f"{where}: output {number} of {len(expected)} differs: {one} for {other}"
    assert len(found) == len(expected), f"{where}: {len(found)} outputs for {len(expected)}"
