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

    def flush(self) -> list[Any]:
        """Flush each stage in turn, and pass what it held back through the stages behind it."""
        outputs: list[Any] = []
        for position, stage in enumerate(self.stages):
            outputs += self._run(stage.flush(), self.stages[position + 1 :])
        return outputs

    @staticmethod
    def _run(items: Sequence[Any], stages: Sequence[Stage]) -> list[Any]:
        for stage in stages:
            items = [output for item in items for output in stage.push(item)]
        return list(items)
