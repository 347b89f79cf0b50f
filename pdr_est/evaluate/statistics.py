"""Statistics of a metric over many walks."""

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Average:
    """Statistics of one metric over the walks that have it.

    Attributes
    ----------
    mean, median, p90 : float or None
        Mean, median and 90th percentile (linear between walks); None if no walk has the metric.
    n : int
        Number of walks.
    """

    mean: float | None
    median: float | None
    p90: float | None
    n: int

    @classmethod
    def of(cls, values: Iterable[float | None]) -> "Average":
        """Compute the statistics of the values that are finite numbers."""
        known = [value for value in values if value is not None and math.isfinite(value)]
        if not known:
            return cls(None, None, None, 0)
        return cls(float(np.mean(known)), float(np.median(known)), float(np.percentile(known, 90.0)), len(known))
