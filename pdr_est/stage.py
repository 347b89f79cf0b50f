"""The contract of a processing stage, the chain that runs stages one after the other, and stages side by side.

A stage consumes items one at a time and emits items of the phenomena it is sure of. How the input is cut into blocks
changes when an output appears and never what it is, so online and offline use are one code path.
"""

from collections.abc import Iterable, Sequence
from typing import Any, Protocol, runtime_checkable


@runtime_checkable
class Stage(Protocol):
    """One step of the processing.

    Implementations keep their whole state in picklable attributes. `pdr_est.testing` tests the contract.
    """

    @property
    def latency_s(self) -> float:
        """Longest time between a phenomenon and the input sample that makes the stage emit it, s."""
        ...

    def push(self, item: Any, /) -> list[Any]:
        """Take one item, and return the outputs that are now certain, often none."""
        ...

    def flush(self) -> list[Any]:
        """Return what was still held back; called once, at the end of the recording."""
        ...


@runtime_checkable
class BatchStage(Stage, Protocol):
    """A stage that also takes many items at once, at less cost than one after the other.

    `pdr_est.testing` tests that the outputs are those of `push` to the last bit, wherever the batches are cut.
    """

    def push_all(self, items: Sequence[Any], /) -> list[Any]:
        """Take items in their order, and return the outputs that are now certain."""
        ...


@runtime_checkable
class TellingStage(BatchStage, Protocol):
    """A stage that takes many items at once and tells which of its outputs came at which item.

    `Parallel` needs that to emit the outputs of several stages item after item.
    """

    def push_each(self, items: Sequence[Any], /) -> list[list[Any]]:
        """Take items in their order, and return for each the outputs that are certain with it, as `push` would."""
        ...


def push_all(stage: Stage, items: Sequence[Any]) -> list[Any]:
    """Give items in their order to a stage, at once where it can take them so, and return what it emits."""
    own = getattr(stage, "push_all", None)  # `isinstance` with a protocol takes longer than most stages for a sample
    if own is not None:
        return list(own(items))
    return [output for item in items for output in stage.push(item)]


def push_each(stage: Stage, items: Sequence[Any]) -> list[list[Any]]:
    """Give items in their order to a stage, and return what it emits at each of them.

    A `TellingStage` takes them at once, any other stage one by one.
    """
    own = getattr(stage, "push_each", None)
    return [stage.push(item) for item in items] if own is None else list(own(items))


def run_through(stage: Stage, items: Sequence[Any]) -> list[Any]:
    """Give all items of a recording to a stage, flush it, and return what it emits."""
    return push_all(stage, items) + stage.flush()


class Parallel:
    """Stages that each take every item, one after the other; itself a stage.

    Parameters
    ----------
    stages
        Stages that consume the same items.
    """

    def __init__(self, stages: Iterable[Stage]) -> None:
        self.stages: tuple[Stage, ...] = tuple(stages)

    @property
    def latency_s(self) -> float:
        """Largest latency of the stages, s."""
        return max((stage.latency_s for stage in self.stages), default=0.0)

    def push(self, item: Any, /) -> list[Any]:
        """Give one item to each stage, and return what they emit."""
        return [output for stage in self.stages for output in stage.push(item)]

    def push_all(self, items: Sequence[Any], /) -> list[Any]:
        """Give many items to each stage, and return what they emit at each item, item after item."""
        found = [push_each(stage, items) for stage in self.stages]
        return [output for at_item in zip(*found, strict=True) for outputs in at_item for output in outputs]

    def flush(self) -> list[Any]:
        """Flush each stage, and return what they held back."""
        return [output for stage in self.stages for output in stage.flush()]


class Chain:
    """Stages in sequence; itself a stage.

    Parameters
    ----------
    stages
        Stages, each of which consumes what the one before it emits.
    """

    def __init__(self, stages: Iterable[Stage]) -> None:
        self.stages: tuple[Stage, ...] = tuple(stages)

    @property
    def latency_s(self) -> float:
        """Sum of the latencies of the stages, s."""
        return sum(stage.latency_s for stage in self.stages)

    def push(self, item: Any, /) -> list[Any]:
        """Pass one item through all stages."""
        return self._run([item], self.stages)

    def push_all(self, items: Sequence[Any], /) -> list[Any]:
        """Pass many items through all stages, each stage after the one before it."""
        return self._run(items, self.stages)

    def flush(self) -> list[Any]:
        """Flush each stage in turn, and pass what it held back through the stages behind it."""
        outputs: list[Any] = []
        for position, stage in enumerate(self.stages):
            outputs += self._run(stage.flush(), self.stages[position + 1 :])
        return outputs

    @staticmethod
    def _run(items: Sequence[Any], stages: Sequence[Stage]) -> list[Any]:
        for stage in stages:
            items = push_all(stage, items)
        return list(items)
