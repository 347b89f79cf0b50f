"""Stretches in which a label stays the same."""

from typing import Any

import numpy as np
from numpy.typing import NDArray


def runs(*labels: NDArray[Any]) -> list[tuple[int, int]]:
    """(start, stop) of each run of samples that agree in every one of the labels, (n,) each; stop is exclusive."""
    count = len(labels[0])
    if not count:
        return []
    differs = np.zeros(count - 1, dtype=np.bool_)
    for label in labels:
        differs |= label[1:] != label[:-1]
    borders = (np.flatnonzero(differs) + 1).tolist()
    return list(zip([0, *borders], [*borders, count], strict=True))
