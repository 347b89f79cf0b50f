"""Delay in recognising a change between walking and a faster gait, on people outside of the training data.

    python experiments/gait_changes.py --data DIR

DIR holds `motionsense` and `sisfall`. No recording with a change exists, so the steps of two recordings of one person
are joined: some of one gait, then some of the other. Nothing leads up to such a change. Writes
results/gait_changes.txt and the table of experiments/paper-details.md.
"""

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from recorded import command_line, markdown_table, write_table

from pdr_est import pipeline
from pdr_est.config import Config
from pdr_est.front_end.gait import GaitClassifier, GaitFolds, GaitParams, shipped_folds
from pdr_est.io import read
from pdr_est.training.gait_files import labelled_files
from pdr_est.types.steps import Gait, Step

RESULT = Path(__file__).parent / "results" / "gait_changes.txt"
MARK = "<!-- gait changes -->"
STEPS = 12  # before a change, and after it
FROM, EVERY = 40, 15  # steps of a recording; its beginning and end are no steady gait
PLACES = {"motionsense": "pocket", "sisfall": "belt"}


@dataclass(frozen=True)
class Walk:
    """Steps of one recording."""

    person: str
    data_set: str
    gait: Gait
    steps: Sequence[Step]

    @property
    def faster(self) -> bool:
        """True for jogging and running."""
        return self.gait is not Gait.WALKING


def main() -> None:
    """Join the walks, classify, and write how many changes were recognised at which step."""
    seen = seen_at(list(walks_of(command_line(__doc__, {"--data": Path}).data)))
    rows = [row(f"{PLACES[place]}, {change}", steps) for (place, change), steps in sorted(seen.items())]
    rows.append(row("all", [step for steps in seen.values() for step in steps]))
    head = ("change", "joins", "1st step", "2nd", "3rd", "later")
    RESULT.write_text("\n".join("".join(f"{cell:>28}" for cell in cells) for cells in (head, *rows)) + "\n", "utf-8")
    write_table(MARK, markdown_table(head, rows))
    print(RESULT.read_text(encoding="utf-8"), end="")


def walks_of(data: Path) -> Iterator[Walk]:
    """Read the walks of both data sets, with default settings and without gaits."""
    config = replace(Config(), gait=GaitParams(method="none"))
    for file in labelled_files(data):
        if file.data_set in PLACES:
            recording = read(file.path)
            for device in pipeline.analyse_recording(recording, config):
                yield Walk(file.person, file.data_set, file.gait_of(recording), device.steps)


def seen_at(walks: Sequence[Walk]) -> dict[tuple[str, str], list[int]]:
    """Find the number of the first right step after each change, by data set and direction."""
    folds = shipped_folds("auto")
    found: dict[tuple[str, str], list[int]] = {}
    for first, second in itertools.permutations(walks, 2):
        if first.person != second.person or first.faster is second.faster:
            continue
        change = "to faster" if second.faster else "to walking"
        for at in range(FROM, min(len(first.steps), len(second.steps)) - FROM, EVERY):
            joined = [*first.steps[at - STEPS : at], *second.steps[at : at + STEPS]]
            number = first_right(folds, first.person, joined, second.faster)
            found.setdefault((first.data_set, change), []).append(number)
    return found


def first_right(folds: GaitFolds, person: str, joined: Sequence[Step], faster: bool) -> int:
    """Find the number of the first right step after the change; one more than the steps if none is right."""
    model = folds.model_for(person)
    if model is None:
        raise SystemExit(f"{person}: not among the people of the shipped model; take its data")
    stage = GaitClassifier(model)
    labels = [found.gait for step in joined for found in stage.push(step)][STEPS:]
    right = [number for number, gait in enumerate(labels, start=1) if (gait is not Gait.WALKING) is faster]
    return right[0] if right else STEPS + 1


def row(name: str, steps: Sequence[int]) -> tuple[str, ...]:
    """Make a row of the table: shares in percent."""
    shares = [sum(step == number for step in steps) for number in (1, 2, 3)]
    return name, str(len(steps)), *(f"{100.0 * n / len(steps):.1f} %" for n in (*shares, len(steps) - sum(shares)))


if __name__ == "__main__":
    main()
