"""The walks of MMPDR's (Tian et al. 2016) Tables VIII and IX and of its park, for the scripts that measure them."""

import argparse
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeVar

from recorded import write

from pdr_est.simulate import Scenario, SimulatedWalk, mmpdr_indoor, park_348, simulate_walk
from pdr_est.types.steps import CarryingMode

HOLDING, SWING, POCKET = CarryingMode.HOLDING, CarryingMode.SWING, CarryingMode.POCKET
WALKERS = 6

T = TypeVar("T")


@dataclass(frozen=True)
class Row:
    """A kind of walk. modes: in the order of carrying; park: there instead of indoors."""

    words: str
    modes: tuple[CarryingMode, ...]
    park: bool = False

    def scenario(self, seed: int) -> Scenario:
        """The walk of one walker."""
        return park_348(*self.modes, seed=seed) if self.park else mmpdr_indoor(*self.modes, seed=seed)

    def walks(self, seeds: Sequence[int]) -> list[SimulatedWalk]:
        """The walks of some walkers."""
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
    """A script: measure every row for the walkers of the command line, print the text, and write it and the numbers
    to results/STEM.txt and .json. description: of the script."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, nargs="+", default=list(range(WALKERS)))
    seeds = parser.parse_args().seeds
    table = {row.words: measured(row, seeds) for row in ROWS}
    write(stem, as_text(table, seeds), as_document(table, seeds))
