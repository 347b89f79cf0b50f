"""Runs of equal labels in a sequence, such as the samples of one carrying mode."""

from typing import Any

import numpy as np
from numpy.typing import NDArray


def label_runs(*labels: NDArray[Any]) -> list[tuple[int, int]]:
    """Divide a sequence into runs in which every label stays the same.

    Parameters
    ----------
    *labels
        One or more arrays (n,) with the labels of the same n samples.

    Returns
    -------
    list of (start, stop)
        Index range of each run, in order; `stop` is exclusive. Empty for empty arrays.
    """
    count = len(labels[0])
    if not count:
        return []
    differs = np.zeros(count - 1, dtype=np.bool_)
    for label in labels:
        differs |= label[1:] != label[:-1]
    borders = (np.flatnonzero(differs) + 1).tolist()
    return list(zip([0, *borders], [*borders, count], strict=True))
