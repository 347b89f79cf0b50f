"""Table IV of UPTIME (Alzantot and Youssef 2012): confusion of gaits, by data set and by split.

    python experiments/uptime_table4.py --data DIR [--jobs 2]

DIR holds `motionsense` (phone in the front trouser pocket: walking and jogging) and `sisfall` (box at the belt:
walking, slow and quick jogging, which stand for the three gaits). Their labels of jogging contradict each other, so
each set is scored alone.

`published` is the paper's classifier: its six features of a step, each step by itself, two support-vector machines
with the same kernel, no weights, trained on all steps of the set. The paper does not say how it parted training and
test. So there are two ways: a random tenth of the steps is tested, whose neighbours were learnt from, or a person is,
of whom nothing was. `stride` is the same with our six features of a stride. `uptime` and `auto` are the models that
come with the package, for people who were left out of their training on both sets. Prints the matrices and writes
them to experiments/results/, and the shares to experiments/paper-details.md.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from recorded import command_line, markdown_table, write, write_table
from sklearn.preprocessing import StandardScaler
from sklearn.svm import SVC

from pdr_est import pipeline
from pdr_est.config import Config
from pdr_est.evaluate.gait_recognition import KNOWN, accuracies, recalls
from pdr_est.experiment import comparison_on_axis, run_benchmark
from pdr_est.experiment.suite import ConfusionMatrix
from pdr_est.frames import Array
from pdr_est.front_end.gait import GaitParams
from pdr_est.front_end.gait.features import FeatureSet
from pdr_est.front_end.gait.training_data import LabelledSteps, StepTable, labelled_steps, step_table
from pdr_est.io import read
from pdr_est.training.gait_files import labelled_files
from pdr_est.types.steps import Gait

MARK = "<!-- uptime table 4 -->"
SETS = ("motionsense", "sisfall")
CLASSIFIERS: Mapping[str, FeatureSet] = {"published": "uptime", "stride": "auto"}
SPLITS = ("random steps", "people left out")
SHIPPED: tuple[Literal["uptime", "auto"], ...] = ("uptime", "auto")
COST, GAMMA = 1.0, 0.25  # of the shipped `uptime`; the paper gives none
FOLDS = 10
PAPER_ROWS = {Gait.WALKING: (479, 1, 0), Gait.JOGGING: (18, 572, 0), Gait.RUNNING: (5, 5, 206)}
SHARES = ("gait_accuracy", "balanced_accuracy", "walking_accuracy")
HEADS = ("all gaits, of all steps", "mean of the gaits' recalls", "walking against faster")

Counts = NDArray[np.int64]


@dataclass(frozen=True)
class Matrix:
    """Steps by true gait and label, by the numbers of `Gait`, of a classifier or the paper on a data set."""

    who: str
    split: str
    where: str
    counts: Counts

    def percent(self) -> dict[str, float]:
        """Compute `SHARES`, in percent."""
        return {name: round(100.0 * share, 2) for name, share in accuracies(self.counts).items()}


def main() -> None:
    """Measure, and write results/uptime_table4.json and .txt and the README's table."""
    options = command_line(__doc__, {"--data": Path, "--jobs": 1})
    table = [paper(), *trained(steps_of(options.data))]
    table += [matrix for method in SHIPPED for matrix in shipped(method, options.data, options.jobs)]
    write("uptime_table4", as_text(table), as_document(table))
    write_table(MARK, as_markdown(table))


def paper() -> Matrix:
    """Return Table IV of the paper: phones in hand and pocket, people and split not said."""
    counts = np.zeros((len(Gait), len(Gait)), dtype=np.int64)
    for gait, row in PAPER_ROWS.items():
        counts[gait, list(KNOWN)] = row
    return Matrix("paper", "not said", "hand, pocket", counts)


def steps_of(data: Path) -> dict[FeatureSet, list[LabelledSteps]]:
    """Find the steps of all recordings with default settings, with the features of each set."""
    config = replace(Config(), gait=GaitParams(method="none"))
    found: dict[FeatureSet, list[LabelledSteps]] = {features: [] for features in CLASSIFIERS.values()}
    for file in labelled_files(data):
        if file.data_set not in SETS:
            continue
        recording = read(file.path)
        (device,) = pipeline.analyse_recording(recording, config)
        known = {"person": file.person, "data_set": file.data_set, "gait": file.gait_of(recording)}
        for features, walks in found.items():
            walks.append(labelled_steps(device.steps, features, **known))
    return found


def trained(steps: Mapping[FeatureSet, list[LabelledSteps]]) -> list[Matrix]:
    """Train and test every classifier on each data set alone, with both splits."""
    table = []
    for who, features in CLASSIFIERS.items():
        for split in SPLITS:
            for data_set in SETS:
                own = step_table([walk for walk in steps[features] if walk.data_set == data_set])
                labels = cross_validated(own, folds_of(own, split))
                table.append(Matrix(who, split, data_set, counts_of_labels(own.gait, labels)))
    return table


def folds_of(table: StepTable, split: str) -> NDArray[np.int64]:
    """Deal the steps (n,) into folds: each by itself, or all of a person into one."""
    if split == "random steps":
        return np.random.default_rng(0).permutation(len(table)) % FOLDS
    return np.unique(table.person, return_inverse=True)[1].astype(np.int64)


def cross_validated(table: StepTable, fold: NDArray[np.int64]) -> NDArray[np.int8]:
    """Label the steps (n,) of each fold by machines that were trained on the others."""
    labels = np.empty(len(table), dtype=np.int8)
    for number in np.unique(fold):
        tested = fold == number
        labels[tested] = published_labels(table, ~tested, table.features[tested])
    return labels


def published_labels(table: StepTable, seen: NDArray[np.bool_], features: Array) -> NDArray[np.int8]:
    """Train both levels on the steps seen, and label others (k, 6); the second level needs jogging and running."""
    scaler = StandardScaler().fit(table.features[seen])
    learnt, asked = scaler.transform(table.features), scaler.transform(features)
    faster = SVC(C=COST, gamma=GAMMA).fit(learnt[seen], table.faster[seen]).predict(asked)
    quick, running = seen & table.faster, table.gait == Gait.RUNNING
    labels = np.where(faster, Gait.JOGGING, Gait.WALKING).astype(np.int8)
    if running[quick].any():
        upper = SVC(C=COST, gamma=GAMMA).fit(learnt[quick], running[quick]).predict(asked)
        labels[faster & upper] = Gait.RUNNING
    return labels


def counts_of_labels(true: NDArray[np.int8], labels: NDArray[np.int8]) -> Counts:
    """Count steps by true gait and label."""
    counts = np.zeros((len(Gait), len(Gait)), dtype=np.int64)
    np.add.at(counts, (true, labels), 1)
    return counts


def shipped(method: Literal["uptime", "auto"], data: Path, jobs: int) -> list[Matrix]:
    """Measure the model that comes with the package on each data set, without the person in its training."""
    comparison = comparison_on_axis(replace(Config(), gait=GaitParams(method=method)))
    found = run_benchmark("gait", data, comparison, jobs).confusions(comparison.main.name)
    return [Matrix(method, "people left out", name, counts_of(found[name])) for name in SETS if name in found]


def counts_of(confusion: ConfusionMatrix) -> Counts:
    """Convert the counts of the suite into a matrix."""
    counts = np.zeros((len(Gait), len(Gait)), dtype=np.int64)
    for true, labels in confusion.counts.items():
        for label, steps in labels.items():
            counts[Gait[true.upper()], Gait[label.upper()]] = steps
    return counts


def as_document(table: list[Matrix]) -> list[dict[str, object]]:
    """Make the document: each matrix with its shares in percent, one row for each true gait."""
    return [
        {
            "who": matrix.who,
            "split": matrix.split,
            "where": matrix.where,
            "counts": {gait.name.lower(): matrix.counts[gait, list(KNOWN)].tolist() for gait in KNOWN},
            "percent": matrix.percent(),
        }
        for matrix in table
    ]


def as_text(table: list[Matrix]) -> str:
    """Format a block for each matrix."""
    lines = ["UPTIME Table IV: steps by true gait (rows) and label, and percent of right labels.", ""]
    for matrix in table:
        title = f"{matrix.who}, {matrix.where}, {matrix.split}"
        lines.append(f"{title:44}" + "".join(f"{gait.name.lower():>10}" for gait in KNOWN))
        own = recalls(matrix.counts)
        for gait in own:
            cells = "".join(f"{steps:10d}" for steps in matrix.counts[gait, list(KNOWN)])
            lines.append(f"  {gait.name.lower():42}{cells}{100.0 * own[gait]:10.2f}")
        percent = matrix.percent()
        lines += [f"  {head}: {percent[name]:.2f}" for name, head in zip(SHARES, HEADS, strict=True)]
        lines.append("")
    return "\n".join(lines)


def as_markdown(table: list[Matrix]) -> str:
    """Make the table of the README: a row for each classifier and split, the shares in percent by data set."""
    rows: dict[tuple[str, str], dict[str, dict[str, float]]] = {}
    for matrix in table:
        rows.setdefault((matrix.who, matrix.split), {})[matrix.where] = matrix.percent()
    cells = []
    for (who, split), by_set in rows.items():
        pocket, belt = (by_set.get(name, by_set.get("hand, pocket", {})) for name in SETS)
        shares = (pocket["walking_accuracy"], *(belt[name] for name in SHARES))
        cells.append((who if who == "paper" else f"`{who}`", split, *(f"{share:.2f}" for share in shares)))
    heads = ("MotionSense: walking against jogging", *(f"SisFall: {head}" for head in HEADS))
    return markdown_table(("classifier", "test", *heads), cells)


if __name__ == "__main__":
    main()
