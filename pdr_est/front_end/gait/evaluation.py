"""Measure how well gaits are recognised on steps of people whom the model has not seen."""

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
    """Compute the probabilities of walking, jogging and running.

    Parameters
    ----------
    model : GaitModel
        Trained classifier.
    pooled : ndarray, shape (n, 2)
        Pooled scores of both levels (`StepTable.pooled`).

    Returns
    -------
    ndarray, shape (n, 3)
    """
    return GaitScorer(model).probabilities(pooled.T)


def gait_metrics(table: StepTable, probability: Array) -> GaitMetrics:
    """Compute the metrics of each data set and of all together.

    Parameters
    ----------
    table : StepTable
        Labelled steps.
    probability : ndarray, shape (n, 3)
        Probabilities by models that left the person of the step out.
    """
    predicted = np.array([decide_gait((w, j, r)) for w, j, r in probability.tolist()], dtype=np.int8)
    everything = np.ones(len(table), dtype=bool)
    parts = {ALL: everything} | {name: table.data_set == name for name in np.unique(table.data_set).tolist()}
    confusions = {name: gait_confusion(table.gait[part], predicted[part]) for name, part in parts.items()}
    right = table.faster == (predicted != Gait.WALKING)
    return GaitMetrics(
        faster_accuracy={name: _rounded(float(right[part].mean())) for name, part in parts.items()},
        balanced_accuracy={name: _rounded(balanced_accuracy(counts)) for name, counts in confusions.items()},
        confusion=confusions,
        brier=_brier(table, probability),
    )


def gait_confusion(true: NDArray[np.int8], predicted: NDArray[np.int8]) -> Confusion:
    """Count the steps of each true gait (rows) that were classified as each gait (columns)."""

    def row(gait: Gait) -> tuple[int, int, int]:
        """Count the steps of a true gait by their classification."""
        taken = np.bincount(predicted[true == gait], minlength=len(Gait)).tolist()
        return taken[Gait.WALKING], taken[Gait.JOGGING], taken[Gait.RUNNING]

    return row(Gait.WALKING), row(Gait.JOGGING), row(Gait.RUNNING)


def balanced_accuracy(counts: Confusion) -> float:
    """Compute the mean, over the gaits that occur, of the share of their steps that were recognised."""
    return float(np.mean([row[i] / sum(row) for i, row in enumerate(counts) if sum(row)]))


def _brier(table: StepTable, probability: Array) -> tuple[float, float]:
    """Compute the Brier scores of the first level on all steps, and of the second where it can be told."""
    faster = 1.0 - probability[:, 0]
    chosen = table.has_both_gaits & table.faster
    running = probability[chosen, 2] / np.maximum(faster[chosen], np.finfo(float).tiny)
    return (
        _rounded(float(np.mean((faster - table.faster) ** 2))),
        _rounded(float(np.mean((running - (table.gait[chosen] == Gait.RUNNING)) ** 2))),
    )


def _rounded(value: float) -> float:
    return round(value, _DECIMALS)
