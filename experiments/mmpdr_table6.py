"""Table VI of MMPDR (Tian et al. 2016) on simulated walks: recognition of the carrying mode.

    python experiments/mmpdr_table6.py [--people 17] [--seeds 0 1 2]

17 people walk 80 m each and change between HOLDING, SWING and POCKET 106 times in all. Two tables a method:

* *Walking time*: of the time that each mode was really carried, between the first and the last step, the share that
  carries each label. What the hand does while it moves the phone (true mode TRANS, 0.8 to 1.6 s) has no right label
  and is left out; the 2 s before and after are not. The label TRANS is wrong everywhere else. A label belongs to the
  sample that it stands on, so the delay of a recogniser is neither excused nor counted: it shows online only.
* *Changes*, the paper's table: of the changes to each mode that were detected, the share with each label half-way to
  the next change. A change is missed if nothing is fired between 1 s before and 1 s after it, false if it is fired
  and belongs to none; both as shares of the true changes. Fired is a run of TRANS, whatever follows, or one mode's
  label directly after another's. True and fired changes are paired one to one, so that a change seen as two is one
  false one.

Writes experiments/results/mmpdr_table6.json and .txt.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from recorded import command_line, write

from pdr_est.config import Config
from pdr_est.evaluate.carrying_modes import Transitions, count_transitions, mode_confusion, row_shares
from pdr_est.front_end.mode import ModeParams
from pdr_est.pipeline import analyse_recording
from pdr_est.simulate import SimulatedWalk, mmpdr_mode_walks, simulate_walk
from pdr_est.types.steps import CarryingMode

METHODS: tuple[Literal["mmpdr", "auto"], ...] = ("mmpdr", "auto")
TRUE = (CarryingMode.HOLDING, CarryingMode.SWING, CarryingMode.POCKET)
LABELS = (*TRUE, CarryingMode.OTHER, CarryingMode.TRANS, CarryingMode.UNKNOWN)
PAPER = {  # of the detected changes to each mode; percent
    "HOLDING": {"HOLDING": 96.88, "SWING": 0.0, "POCKET": 3.12},
    "SWING": {"HOLDING": 5.26, "SWING": 89.48, "POCKET": 5.26},
    "POCKET": {"HOLDING": 3.57, "SWING": 3.57, "POCKET": 92.86},
}
PAPER_MISSED, PAPER_FALSE = 7.55, 1.89


@dataclass(frozen=True)
class Score:
    """Score of a method over all walks: samples by true mode and label, and counted changes."""

    time: NDArray[np.int64]
    changes: Transitions


def main() -> None:
    """Simulate, recognise, print and write the tables."""
    options = command_line(__doc__, {"--people": 17, "--seeds": [0, 1, 2]})
    scores = measured(options.people, options.seeds)
    text = as_text(scores, options.people, options.seeds)
    write("mmpdr_table6", text, as_document(scores, options.people, options.seeds))


def measured(people: int, seeds: Sequence[int]) -> dict[str, Score]:
    """Score each method over the walks of all seeds."""
    walks = [simulate_walk(scenario) for seed in seeds for scenario in mmpdr_mode_walks(people, seed)]
    return {method: score(walks, replace(Config(), mode=ModeParams(method=method))) for method in METHODS}


def score(walks: Sequence[SimulatedWalk], config: Config) -> Score:
    """Score a configuration."""
    total: Score | None = None
    for walk in walks:
        modes = walk.devices[0].modes
        span_s = (float(walk.steps.time_s[0]), float(walk.steps.time_s[-1]))
        level = analyse_recording(walk.recording, config)[0].level
        own = Score(mode_confusion(modes, level, span_s), count_transitions(modes, level, span_s))
        total = own if total is None else Score(total.time + own.time, total.changes + own.changes)
    if total is None:
        raise ValueError("no walk to score: give at least one person and one seed")
    return total


def percent(counts: NDArray[np.int64]) -> dict[str, dict[str, float]]:
    """Compute the shares of the labels by true mode, percent."""
    share = 100.0 * row_shares(counts)
    return {true.name: {label.name: round(float(share[true, label]), 2) for label in LABELS} for true in TRUE}


def missed_and_false(changes: Transitions) -> tuple[float, float]:
    """Compute missed and false changes in percent of the true changes."""
    return 100.0 * changes.missed / changes.real, 100.0 * changes.false / changes.real


def as_document(scores: dict[str, Score], people: int, seeds: Sequence[int]) -> dict[str, object]:
    """Make the document with the numbers of the text, in percent."""
    methods = {}
    for name, own in scores.items():
        missed, false = missed_and_false(own.changes)
        methods[name] = {
            "time": percent(own.time),
            "changes": percent(own.changes.arrived),
            "true_changes": own.changes.real,
            "missed": round(missed, 2),
            "false": round(false, 2),
        }
    paper = {"changes": PAPER, "missed": PAPER_MISSED, "false": PAPER_FALSE}
    return {"people": people, "seeds": list(seeds), "paper": paper, "methods": methods}


def as_text(scores: dict[str, Score], people: int, seeds: Sequence[int]) -> str:
    """Format a block for the paper and two for each method, with a column for each true mode."""
    lines = [f"MMPDR Table VI: {people} people, seeds {' '.join(map(str, seeds))}; percent, a column a true mode", ""]
    lines += block("paper, changes", PAPER, PAPER_MISSED, PAPER_FALSE)
    for name, own in scores.items():
        lines += block(f"{name}, walking time", percent(own.time))
        lines += block(
            f"{name}, {own.changes.real} changes", percent(own.changes.arrived), *missed_and_false(own.changes)
        )
    return "\n".join(lines)


def block(
    title: str, cells: dict[str, dict[str, float]], missed: float | None = None, false: float | None = None
) -> list[str]:
    """Format the lines of one table; rows of labels that never occur are left out."""
    lines = [f"{title:26}" + "".join(f"{true.name:>10}" for true in TRUE)]
    for label in LABELS:
        row = [cells[true.name].get(label.name, 0.0) for true in TRUE]
        if label in TRUE or any(row):
            lines.append(f"  labelled {label.name:15}" + "".join(f"{value:10.2f}" for value in row))
    if missed is not None and false is not None:
        lines.append(f"  missed {missed:.2f}, false {false:.2f}")
    return [*lines, ""]


if __name__ == "__main__":
    main()
