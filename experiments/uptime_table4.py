"""Table IV of UPTIME (Alzantot and Youssef 2012) on people left out: which gait was taken for which, by position.

    python experiments/uptime_table4.py --data DIR [--jobs 2]

DIR holds `motionsense` (phone in the front trouser pocket) and `sisfall` (box at the belt). The steps of every person
are labelled by a model that was trained without the person: by the paper's six features (`uptime`), and by those of a
stride (`auto`). Prints the matrices and writes them to experiments/results/, and the shares to experiments/README.md.
"""

import argparse
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from recorded import write, write_table

from pdr_est.config import Config
from pdr_est.evaluate.gait_recognition import KNOWN, accuracies, recalls
from pdr_est.experiment import comparison_on_axis, run_benchmark
from pdr_est.experiment.suite import ConfusionMatrix
from pdr_est.front_end.gait import GaitParams
from pdr_est.types.steps import Gait

MARK = "<!-- uptime table 4 -->"
METHODS: tuple[Literal["uptime", "auto"], ...] = ("uptime", "auto")
PLACES = {"pocket": "motionsense", "belt": "sisfall", "both": "all"}  # in words: as the suite names it
PAPER_ROWS = {Gait.WALKING: (479, 1, 0), Gait.JOGGING: (18, 572, 0), Gait.RUNNING: (5, 5, 206)}
SHARES = ("gait_accuracy", "balanced_accuracy", "walking_accuracy")
HEADS = ("three gaits, of all steps", "mean of the gaits' recalls", "walking against faster")


@dataclass(frozen=True)
class Matrix:
    """Steps by true gait and label, both by the numbers of `Gait`. who: method or paper; where: the phone was."""

    who: str
    where: str
    counts: NDArray[np.int64]

    def percent(self) -> dict[str, float]:
        """`SHARES`, in percent."""
        return {name: round(100.0 * share, 2) for name, share in accuracies(self.counts).items()}


def main() -> None:
    """Run the suite with both feature sets, write results/uptime_table4.json and .txt and the README's table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--jobs", type=int, default=1)
    options = parser.parse_args()
    table = [paper(), *(matrix for method in METHODS for matrix in measured(method, options.data, options.jobs))]
    write("uptime_table4", as_text(table), as_document(table))
    write_table(MARK, as_markdown(table))


def paper() -> Matrix:
    """Table IV of the paper: phones in hand and pocket, the same people in training and test."""
    counts = np.zeros((len(Gait), len(Gait)), dtype=np.int64)
    for gait, row in PAPER_ROWS.items():
        counts[gait, list(KNOWN)] = row
    return Matrix("paper", "hand, pocket", counts)


def measured(method: Literal["uptime", "auto"], data: Path, jobs: int) -> list[Matrix]:
    """The matrices of a feature set by position."""
    comparison = comparison_on_axis(replace(Config(), gait=GaitParams(method=method)))
    result = run_benchmark("gait", data, comparison, jobs)
    found = result.confusions(comparison.main.name)
    return [Matrix(method, place, counts_of(found[name])) for place, name in PLACES.items() if name in found]


def counts_of(confusion: ConfusionMatrix) -> NDArray[np.int64]:
    """The suite's counts as a matrix."""
    counts = np.zeros((len(Gait), len(Gait)), dtype=np.int64)
    for true, labels in confusion.counts.items():
        for label, steps in labels.items():
            counts[Gait[true.upper()], Gait[label.upper()]] = steps
    return counts


def as_document(table: list[Matrix]) -> list[dict[str, object]]:
    """Each matrix with its shares in percent; a row a true gait, columns in the same order."""
    return [
        {
            "who": matrix.who,
            "where": matrix.where,
            "counts": {gait.name.lower(): matrix.counts[gait, list(KNOWN)].tolist() for gait in KNOWN},
            "percent": matrix.percent(),
        }
        for matrix in table
    ]


def as_text(table: list[Matrix]) -> str:
    """A block for each matrix."""
    lines = ["UPTIME Table IV: steps by true gait (rows) and label, and percent of right labels.", ""]
    for matrix in table:
        lines.append(f"{f'{matrix.who}, {matrix.where}':24}" + "".join(f"{gait.name.lower():>10}" for gait in KNOWN))
        own = recalls(matrix.counts)
        for gait in own:
            cells = "".join(f"{steps:10d}" for steps in matrix.counts[gait, list(KNOWN)])
            lines.append(f"  {gait.name.lower():22}{cells}{100.0 * own[gait]:10.2f}")
        percent = matrix.percent()
        lines += [f"  {head}: {percent[name]:.2f}" for name, head in zip(SHARES, HEADS, strict=True)]
        lines.append("")
    return "\n".join(lines)


def as_markdown(table: list[Matrix]) -> str:
    """The README's table: the shares in percent."""
    lines = [f"| labels | position | {' | '.join(HEADS)} |", "|---" * (2 + len(HEADS)) + "|"]
    for matrix in table:
        percent = matrix.percent()
        who = matrix.who if matrix.who == "paper" else f"`{matrix.who}`"
        lines.append(f"| {who} | {matrix.where} | {' | '.join(f'{percent[name]:.2f}' for name in SHARES)} |")
    return "\n".join(lines)


if __name__ == "__main__":
    main()
