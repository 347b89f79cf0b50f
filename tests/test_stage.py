"""The chain of stages: order, the flush that runs down the chain, and the latency."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import pytest

from pdr_est.stage import Chain, Parallel, Stage, TellingStage, push_all, push_each, run_through
from pdr_est.testing import check_partition


@dataclass
class Pairs:
    """Sums of two consecutive numbers; an odd one out comes at the end."""

    latency_s: float = 0.5
    held: list[int] = field(default_factory=list)

    def push(self, item: int, /) -> list[int]:
        self.held.append(item)
        if len(self.held) < 2:
            return []
        total, self.held = sum(self.held), []
        return [total]

    def flush(self) -> list[int]:
        left, self.held = self.held, []
        return left


@dataclass
class Repeat:
    """Each number twice."""

    latency_s: float = 0.25

    def push(self, item: int, /) -> list[int]:
        return [item, item]

    def flush(self) -> list[int]:
        return []


def test_outputs_of_a_stage_are_inputs_of_the_next() -> None:
    chain = Chain([Repeat(), Pairs(), Repeat()])
    assert chain.push(3) == [6, 6]
    assert chain.flush() == []


def test_what_a_stage_holds_back_runs_through_the_later_ones() -> None:
    chain = Chain([Pairs(), Pairs(), Repeat()])
    assert [output for item in (1, 2, 4) for output in chain.push(item)] == []
    assert chain.flush() == [7, 7]  # 4 leaves the first stage and meets the 3 that waits in the second
    assert chain.flush() == []


def test_latencies_add_up() -> None:
    assert Chain([Pairs(), Repeat(), Pairs()]).latency_s == 1.25
    assert Chain([]).latency_s == 0


def test_a_chain_is_a_stage_and_may_be_part_of_another() -> None:
    assert isinstance(Chain([]), Stage)
    assert not isinstance(object(), Stage)
    inner = Chain([Pairs(), Repeat()])
    assert Chain([inner, Pairs()]).push(5) == []
    assert [output for item in (5, 6) for output in Chain([Chain([Repeat()]), Pairs()]).push(item)] == [10, 12]


class SumOfTwo:
    """Emits the sum of each two numbers; takes many at once."""

    latency_s = 0.0

    def __init__(self, forgets: bool = False) -> None:
        self.held: list[float] = []
        self.forgets = forgets

    def push(self, item: float, /) -> list[float]:
        return self.push_all([item])

    def push_all(self, items: Sequence[float], /) -> list[float]:
        numbers = [*self.held, *items]
        pairs = len(numbers) // 2
        self.held = [] if self.forgets and len(items) > 1 else numbers[2 * pairs :]
        return [numbers[2 * i] + numbers[2 * i + 1] for i in range(pairs)]

    def flush(self) -> list[float]:
        return [sum(self.held)] if self.held else []


def test_a_chain_gives_a_batch_to_a_stage_at_once_and_single_items_to_another() -> None:
    numbers = [1.0, 2.0, 4.0, 8.0, 16.0]
    assert push_all(SumOfTwo(), numbers) == [3.0, 12.0]
    assert run_through(Chain([SumOfTwo(), SumOfTwo()]), numbers) == [15.0, 16.0]


def test_a_batch_stage_whose_batches_differ_from_single_items_is_refused() -> None:
    numbers = [float(i) for i in range(41)]
    check_partition(SumOfTwo, numbers, [numbers])
    with pytest.raises(AssertionError, match="by push_all"):
        check_partition(lambda: SumOfTwo(forgets=True), numbers, [numbers])


class Halves:
    """Emits even numbers halved; takes many at once and tells their outputs apart."""

    latency_s = 0.0

    def __init__(self, late: bool = False) -> None:
        self.late = late

    def push(self, item: int, /) -> list[int]:
        return [] if item % 2 else [item // 2]

    def push_all(self, items: Sequence[int], /) -> list[int]:
        return [output for outputs in self.push_each(items) for output in outputs]

    def push_each(self, items: Sequence[int], /) -> list[list[int]]:
        found = [self.push(item) for item in items]
        return [*[[] for _ in found[1:]], [output for outputs in found for output in outputs]] if self.late else found

    def flush(self) -> list[int]:
        return []


class HalvesOneByOne:
    """Does the same one by one."""

    latency_s = 0.0

    def push(self, item: int, /) -> list[int]:
        return Halves().push(item)

    def flush(self) -> list[int]:
        return []


def test_stages_side_by_side_emit_item_after_item_also_when_they_take_many_at_once() -> None:
    items = [10, 11, 20]
    assert Parallel([Halves(), Repeat()]).push_all(items) == [5, 10, 10, 11, 11, 10, 20, 20]
    check_partition(lambda: Parallel([Halves(), Pairs(), Repeat()]), items)
    assert Parallel([]).push_all(items) == []


def test_a_stage_that_tells_outputs_apart_otherwise_than_single_items_is_refused() -> None:
    items = list(range(40))
    assert isinstance(Halves(), TellingStage)
    assert not isinstance(SumOfTwo(), TellingStage)
    assert push_each(Halves(), items[:4]) == push_each(HalvesOneByOne(), items[:4]) == [[0], [], [1], []]
    check_partition(Halves, items, [items])
    with pytest.raises(AssertionError, match="push_each gives items"):
        check_partition(lambda: Halves(late=True), items, [items])
