"""How a metric lies over many walks."""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np


@dataclass(frozen=True)
class Average:
    """Of one metric over the walks that have it; None when none has. p90: 90th percentile, linear between walks."""

    mean: float | None
    median: float | None
    p90: float | None
    n: int

    @classmethod
    def of(cls, values: Iterable[float | None]) -> "Average":
        """Of the values that are finite numbers."""
        known = [value for value in values if value is not None and math.isfinite(value)]
        if not known:
            return cls(None, None, None, 0)
        return cls(float(np.mean(known)), float(np.median(known)), float(np.percentile(known, 90.0)), len(known))

    def to_dict(self) -> dict[str, Any]:
        """As it stands in a JSON document."""
        return {"mean": self.mean, "median": self.median, "p90": self.p90, "n": self.n}
