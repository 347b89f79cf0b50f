"""Metrics of recognised gaits, step by step, against the one true gait of a walk.

Counts are (gaits, gaits) matrices: steps by true gait (row) and label (column). The row of UNKNOWN does not count: a
step whose true gait is not known is neither right nor wrong. The label UNKNOWN is wrong in every row.
"""

from collections.abc import Iterable, Mapping

import numpy as np
from numpy.typing import NDArray

from pdr_est.types.steps import Gait

GAIT_METRIC = "gait_accuracy"
WALKING_METRIC = "walking_accuracy"
BALANCED_METRIC = "balanced_accuracy"
KNOWN = (Gait.WALKING, Gait.JOGGING, Gait.RUNNING)
KNOWN_BY_NAME: Mapping[str, Gait] = {gait.name.lower(): gait for gait in KNOWN}
"""Known gaits by the words that recordings and folders use."""

Counts = NDArray[np.int64]


def counts_of(true: Gait, labels: Iterable[Gait]) -> Counts:
    """Count the labels of the steps of a walk in one true gait."""
    counts = np.zeros((len(Gait), len(Gait)), dtype=np.int64)
    for label in labels:
        counts[true, label] += 1
    return counts


def recalls(counts: Counts) -> dict[Gait, float]:
    """Compute the share of right labels of each gait that was walked."""
    return {gait: float(counts[gait, gait] / counts[gait].sum()) for gait in KNOWN if counts[gait].sum()}


def accuracies(counts: Counts) -> dict[str, float]:
    """Compute the shares of right labels; NaN if no true gait is known.

    Returns
    -------
    dict
        gait_accuracy: share of all steps, with three different gaits. walking_accuracy: share of all steps, with
        jogging and running as one gait. balanced_accuracy: mean of the recalls of the gaits that were walked.
    """
    known = counts[list(KNOWN)]
    total = int(known.sum())
    fast = (Gait.JOGGING, Gait.RUNNING)
    apart = int(counts[Gait.WALKING, Gait.WALKING] + counts[np.ix_(fast, fast)].sum())
    right = sum(int(counts[gait, gait]) for gait in KNOWN)
    return {
        GAIT_METRIC: right / total if total else float("nan"),
        WALKING_METRIC: apart / total if total else float("nan"),
        BALANCED_METRIC: float(np.mean(list(recalls(counts).values()))) if total else float("nan"),
    }
