"""How well gaits were told on steps of people whom the model had not seen."""

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.front_end.gait.model import Confusion, GaitMetrics, GaitModel
from pdr_est.front_end.gait.svm_scorer import GaitScorer, decide_gait
from pdr_est.front_end.gait.training_data import StepTable
from pdr_est.types.steps import Gait

ALL = "all"
"""The name of all data sets together."""

_DECIMALS = 4


def gait_probabilities(model: GaitModel, pooled: Array) -> Array:
    """Probabilities (n, 3) of walking, jogging and running for pooled scores (n, 2) of both levels."""
    scorer = GaitScorer(model)
    return np.array([scorer.probabilities((faster, running)) for faster, running in pooled.tolist()]).reshape(-1, 3)


def gait_metrics(table: StepTable, probability: Array) -> GaitMetrics:
    """The figures of each data set and of all together. probability: (n, 3), by models that left the person out."""
    found = np.array([decide_gait((w, j, r)) for w, j, r in probability.tolist()], dtype=np.int8)
    everything = np.ones(len(table), dtype=bool)
    parts = {ALL: everything} | {name: table.data_set == name for name in np.unique(table.data_set).tolist()}
    confusions = {name: gait_confusion(table.gait[part], found[part]) for name, part in parts.items()}
    right = table.faster == (found != Gait.WALKING)
    return GaitMetrics(
        faster_accuracy={name: _rounded(float(right[part].mean())) for name, part in parts.items()},
        balanced_accuracy={name: _rounded(balanced_accuracy(counts)) for name, counts in confusions.items()},
        confusion=confusions,
        brier=_brier(table, probability),
    )


def gait_confusion(true: NDArray[np.int8], found: NDArray[np.int8]) -> Confusion:
    """How many steps of each gait (rows) were taken for each (columns)."""

    def row(gait: Gait) -> tuple[int, int, int]:
        taken = np.bincount(found[true == gait], minlength=len(Gait)).tolist()
        return taken[Gait.WALKING], taken[Gait.JOGGING], taken[Gait.RUNNING]

    return row(Gait.WALKING), row(Gait.JOGGING), row(Gait.RUNNING)


def balanced_accuracy(counts: Confusion) -> float:
    """Mean over the gaits that occur of the share of steps that were found."""
    return float(np.mean([row[i] / sum(row) for i, row in enumerate(counts) if sum(row)]))


def _brier(table: StepTable, probability: Array) -> tuple[float, float]:
    """Of the first level on all steps, of the second where it can be told."""
    faster = 1.0 - probability[:, 0]
    chosen = table.has_both_gaits & table.faster
    running = probability[chosen, 2] / np.maximum(faster[chosen], np.finfo(float).tiny)
    return (
        _rounded(float(np.mean((faster - table.faster) ** 2))),
        _rounded(float(np.mean((running - (table.gait[chosen] == Gait.RUNNING)) ** 2))),
    )


def _rounded(value: float) -> float:
    return round(value, _DECIMALS)
