"""Comparison of two variants on the same walks: differences with bootstrap intervals, and wins."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from pdr_est.evaluate.metric_definitions import DEFINITIONS
from pdr_est.frames import Array

RESAMPLES = 10_000
_SEED = 20_160_401  # fixed, so that equal results have equal intervals
ROUNDING = 1e-6  # smaller differences of a metric are ties
_BLOCK = 1_000_000  # numbers drawn at once


@dataclass(frozen=True)
class PairedComparison:
    """One metric of two variants over the walks on which both have it.

    Attributes
    ----------
    metric : str
        Name of the metric.
    first, second : str
        Names of the variants.
    n : int
        Number of walks.
    mean_first, mean_second : float
        Means of the metric.
    difference : float
        Mean over the walks of the second's distance from the ideal value minus the first's; negative if the second is
        better.
    low, high : float or None
        95 % interval of `difference`; None for a single walk.
    first_wins, second_wins : int
        Number of walks on which each is nearer to the ideal value; the others are ties.
    """

    metric: str
    first: str
    second: str
    n: int
    mean_first: float
    mean_second: float
    difference: float
    low: float | None
    high: float | None
    first_wins: int
    second_wins: int

    @property
    def ties(self) -> int:
        """Number of walks on which neither is better."""
        return self.n - self.first_wins - self.second_wins

    @property
    def better(self) -> str | None:
        """Variant that is better if the interval of the difference does not contain zero, else None."""
        if self.low is None or self.high is None or self.low <= 0.0 <= self.high:
            return None
        return self.second if self.high < 0.0 else self.first


def compare_paired(
    metric: str, first: str, second: str, by_first: Mapping[str, float], by_second: Mapping[str, float]
) -> PairedComparison | None:
    """Compare two variants over the walks that both have; None if there is none.

    Unknown metrics are treated as errors, whose ideal value is zero.

    Parameters
    ----------
    metric : str
        Name of the metric.
    first, second : str
        Names of the variants.
    by_first, by_second : Mapping
        Walk -> value of the metric; a walk counts once, with the mean over its tracks.
    """
    walks = [walk for walk in by_first if walk in by_second]
    if not walks:
        return None
    a, b = (np.array([values[walk] for walk in walks]) for values in (by_first, by_second))
    ideal = DEFINITIONS[metric].ideal if metric in DEFINITIONS else 0.0
    difference = np.abs(b - ideal) - np.abs(a - ideal)
    difference[np.abs(difference) < ROUNDING] = 0.0
    low, high = bootstrap_interval(difference) if len(walks) > 1 else (None, None)
    return PairedComparison(
        metric=metric,
        first=first,
        second=second,
        n=len(walks),
        mean_first=float(a.mean()),
        mean_second=float(b.mean()),
        difference=float(difference.mean()),
        low=low,
        high=high,
        first_wins=int((difference > 0.0).sum()),
        second_wins=int((difference < 0.0).sum()),
    )


def bootstrap_interval(values: Array, confidence: float = 0.95) -> tuple[float, float]:
    """Compute the percentile bootstrap interval of the mean of values (n,).

    Walks are drawn with replacement, `RESAMPLES` times. With few walks the interval is too narrow: with 5 walks it
    contains the true mean in about 84 % of the cases instead of 95 %.
    """
    rng = np.random.default_rng(_SEED)
    rows = max(_BLOCK // len(values), 1)
    means = [
        values[rng.integers(len(values), size=(min(rows, RESAMPLES - begun), len(values)))].mean(axis=1)
        for begun in range(0, RESAMPLES, rows)
    ]
    low, high = np.quantile(np.concatenate(means), [0.5 - confidence / 2.0, 0.5 + confidence / 2.0])
    return float(low), float(high)
