"""Walks of Tables VIII and IX of MMPDR (Tian et al. 2016) and of its park, for the scripts that measure them.

The rows that begin with "indoor" are walks as the paper's method wants them (`mmpdr_published`). A walk in one mode
is one in which the paper's state machine gives more than `LABELLED` of it that mode, as in the paper's Fig. 10: a
walker whose phone it mistakes is replaced by another, and counted. "Anywhere" are walks of the same people who change
the mode at equal distances, corner or not (`mmpdr_indoor`), and whose steps differ more from eq. 9.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal, TypeVar

import numpy as np
from numpy.typing import NDArray
from recorded import command_line, write

from pdr_est.config import Config, load_config
from pdr_est.frames import Array
from pdr_est.front_end.attitude import AttitudeParams
from pdr_est.pipeline import analyse_recording
from pdr_est.simulate import Scenario, SimulatedWalk, mmpdr_indoor, mmpdr_published, park_348, simulate_walk
from pdr_est.types.steps import CarryingMode

HOLDING, SWING, POCKET = CarryingMode.HOLDING, CarryingMode.SWING, CarryingMode.POCKET
WALKERS = 12
LABELLED = 0.9
SETTLED_S = 2.5  # after a change, in which the state machine watches for 2 s
NEXT_WALKER = 100  # from the seed of a walker to that of the one who replaces him
SETTINGS = Path(__file__).resolve().parents[1] / "configs" / "settings" / "mmpdr.yaml"
# The chain of the paper. Its phone's attitude comes from the phone's gyroscope and accelerometer; ours does, too, by
# VQF, because the attitude that the simulator records is free of errors.
PAPER_CHAIN = replace(load_config(SETTINGS), attitude=AttitudeParams(source="vqf"))

T = TypeVar("T")


@dataclass(frozen=True)
class Row:
    """Kind of walk: its carrying modes in their order, and where it is walked."""

    words: str
    modes: tuple[CarryingMode, ...]
    where: Literal["published", "anywhere", "park"] = "published"

    def scenario(self, seed: int) -> Scenario:
        """Make the walk of one walker."""
        make = {"published": mmpdr_published, "anywhere": mmpdr_indoor, "park": park_348}[self.where]
        return make(*self.modes, seed=seed)

    def walks(self, seeds: Sequence[int]) -> list[SimulatedWalk]:
        """Simulate the walks of some walkers."""
        return [self.walk(seed) for seed in seeds]

    def walk(self, seed: int) -> SimulatedWalk:
        """Simulate the walk of one walker, or of the next one whose single mode the paper's chain recognises."""
        while True:
            walk = simulate_walk(self.scenario(seed))
            if self.where != "published" or len(self.modes) > 1 or labelled(walk, self.modes[0]) > LABELLED:
                return walk
            seed += NEXT_WALKER


def labelled(walk: SimulatedWalk, mode: CarryingMode, config: Config = PAPER_CHAIN) -> float:
    """Return the share of a walk, from its first step to its last, to which a chain gives a mode."""
    time_s, modes = labels_of(walk, config)
    inside = (time_s >= walk.steps.start_s[0]) & (time_s <= walk.steps.time_s[-1])
    return float(np.mean(modes[inside] == mode))


def recognised(walk: SimulatedWalk, config: Config = PAPER_CHAIN) -> bool:
    """Return whether a chain gives each stay of the phone its mode, from `SETTLED_S` after a change to the next."""
    time_s, modes = labels_of(walk, config)
    stays = walk.devices[0].modes
    edges_s = np.append(stays.start_s, walk.steps.time_s[-1])
    for mode, begin_s, end_s in zip(stays.mode.tolist(), edges_s[:-1], edges_s[1:], strict=True):
        inside = (time_s >= begin_s + SETTLED_S) & (time_s < end_s)
        if mode != CarryingMode.TRANS and inside.any() and np.mean(modes[inside] == mode) <= LABELLED:
            return False
    return True


def labels_of(walk: SimulatedWalk, config: Config) -> tuple[Array, NDArray[np.int8]]:
    """Return the times (n,), s, and the mode labels (n,) of the samples of a walk."""
    blocks = analyse_recording(walk.recording, config)[0].level
    return np.concatenate([block.time_s for block in blocks]), np.concatenate([block.mode for block in blocks])


def replaced(walks: Sequence[SimulatedWalk]) -> int:
    """Count the walkers who were replaced before these were found."""
    return sum(walk.scenario.seed // NEXT_WALKER for walk in walks)


ROWS = (
    Row("indoor HOLDING", (HOLDING,)),
    Row("indoor SWING", (SWING,)),
    Row("indoor POCKET", (POCKET,)),
    Row("indoor, all modes", (HOLDING, SWING, HOLDING, POCKET)),
    Row("indoor HOLDING, POCKET", (HOLDING, POCKET)),
    Row("anywhere, all modes", (HOLDING, SWING, HOLDING, POCKET), where="anywhere"),
    Row("park, all modes", (HOLDING, SWING, POCKET), where="park"),
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
