"""Walks of Tables VIII and IX of MMPDR (Tian et al. 2016) and of its park, for the scripts that measure them."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeVar

from recorded import command_line, write

from pdr_est.simulate import Scenario, SimulatedWalk, mmpdr_indoor, park_348, simulate_walk
from pdr_est.types.steps import CarryingMode

HOLDING, SWING, POCKET = CarryingMode.HOLDING, CarryingMode.SWING, CarryingMode.POCKET
WALKERS = 6

T = TypeVar("T")


@dataclass(frozen=True)
class Row:
    """Kind of walk: its carrying modes in their order, indoors or in the park."""

    words: str
    modes: tuple[CarryingMode, ...]
    park: bool = False

    def scenario(self, seed: int) -> Scenario:
        """Simulate the walk of one walker."""
        return park_348(*self.modes, seed=seed) if self.park else mmpdr_indoor(*self.modes, seed=seed)

    def walks(self, seeds: Sequence[int]) -> list[SimulatedWalk]:
        """Simulate the walks of some walkers."""
        return [simulate_walk(self.scenario(seed)) for seed in seeds]


ROWS = (
    Row("indoor HOLDING", (HOLDING,)),
    Row("indoor SWING", (SWING,)),
    Row("indoor POCKET", (POCKET,)),
    Row("indoor, all modes", (HOLDING, SWING, HOLDING, POCKET)),
    Row("indoor HOLDING, POCKET", (HOLDING, POCKET)),
    Row("park, all modes", (HOLDING, SWING, POCKET), park=True),
)


def tabulate(
    stem: str,
    description: str | None,
    measured: Callable[[Row, Sequence[int]], T],
    as_text: Callable[[Mapping[str, T], Sequence[int]], str],
    as_document: Callable[[Mapping[str, T], Sequence[int]], Mapping[str, object]],
) -> None:
    """Run a script: measure every row for the walkers of the command line, and write results/STEM.txt and .json."""
    seeds = command_line(description, {"--seeds": list(range(WALKERS))}).seeds
    table = {row.words: measured(row, seeds) for row in ROWS}
    write(stem, as_text(table, seeds), as_document(table, seeds))
