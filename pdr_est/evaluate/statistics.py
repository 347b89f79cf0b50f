"""Statistics of a metric over many walks."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Average:
    """Statistics of one metric over the walks that have it.

    Attributes
    ----------
    mean, median, p90 : float or None
        Mean (which may be weighted), median and 90th percentile (linear between walks); None if no walk has the
        metric.
    n : int
        Number of walks.
    """

    mean: float | None
    median: float | None
    p90: float | None
    n: int

    @classmethod
    def of(cls, values: Iterable[float | None], weights: Sequence[float] | None = None) -> "Average":
        """Compute the statistics of the values that are finite numbers.

        Parameters
        ----------
        values : iterable of float or None
            Value of each walk.
        weights : sequence of float or None
            Weight of each walk in the mean, such as the number of legs that its value is the mean of; equal for None.

        Raises
        ------
        ValueError
            If there are more or fewer weights than values.
        """
        numbers = list(values)
        rows = zip(numbers, [1.0] * len(numbers) if weights is None else weights, strict=True)
        known = [(value, weight) for value, weight in rows if value is not None and math.isfinite(value)]
        if not known:
            return cls(None, None, None, 0)
        finite, shares = (np.array(column) for column in zip(*known, strict=True))
        mean = np.mean(finite) if weights is None else np.average(finite, weights=shares)
        return cls(float(mean), float(np.median(finite)), float(np.percentile(finite, 90.0)), len(known))
