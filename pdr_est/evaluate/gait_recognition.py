"""How well gaits are recognised, step by step, against the one gait that a walk was walked in.

Counts are (gaits, gaits) matrices: steps with the true gait of the row's number and the label of the column's.
The row of UNKNOWN does not count: a step whose true gait is not known is neither right nor wrong. The label UNKNOWN
is wrong in every row.
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
"""By the words that recordings and folders use."""

Counts = NDArray[np.int64]


def counts_of(true: Gait, labels: Iterable[Gait]) -> Counts:
    """The matrix of a walk in one gait. labels: of its steps."""
    counts = np.zeros((len(Gait), len(Gait)), dtype=np.int64)
    for label in labels:
        counts[true, label] += 1
    return counts


def recalls(counts: Counts) -> dict[Gait, float]:
    """Share of right labels of each gait that was walked."""
    return {gait: float(counts[gait, gait] / counts[gait].sum()) for gait in KNOWN if counts[gait].sum()}


def accuracies(counts: Counts) -> dict[str, float]:
    """Shares of right labels; NaN when no step's true gait is known.

    gait_accuracy: of all steps, the three gaits told apart. walking_accuracy: of all steps, walking told from jogging
    or running, which are one gait here. balanced_accuracy: mean of the recalls of the gaits that were walked.
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
