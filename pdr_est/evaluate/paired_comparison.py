"""Comparison of two variants on the same walks: differences with bootstrap intervals, and wins."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from statistics import NormalDist

import numpy as np

from pdr_est.evaluate.metric_definitions import DEFINITIONS
from pdr_est.frames import Array

RESAMPLES = 10_000
MOST_RESAMPLED = 5_000
"""Number of walks above which the distribution of their mean is taken for normal."""
_SEED = 20_160_401  # fixed, so that equal results have equal intervals
ROUNDING = 1e-6  # smaller differences of a metric are ties
_BLOCK = 1_000_000  # numbers drawn at once
_CONFIDENCE = 0.95  # probability that an interval holds the mean


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


@dataclass(frozen=True)
class PairedValues:
    """Values of one metric of two variants, by walk; a walk counts once, with the mean over its tracks.

    Attributes
    ----------
    metric
        Name of the metric; an unknown one is treated as an error, whose ideal value is zero.
    first, second
        Names of the variants.
    by_first, by_second
        Walk -> value of the metric.
    """

    metric: str
    first: str
    second: str
    by_first: Mapping[str, float]
    by_second: Mapping[str, float]

    def common(self) -> tuple[Array, Array]:
        """Return the values (n,) of both variants on the walks that both have."""
        walks = [walk for walk in self.by_first if walk in self.by_second]
        first, second = (np.array([values[walk] for walk in walks]) for values in (self.by_first, self.by_second))
        return first, second

    def differences(self) -> Array:
        """Return how much farther the second is from the ideal value on each common walk, (n,); ties are 0."""
        first, second = self.common()
        ideal = DEFINITIONS[self.metric].ideal if self.metric in DEFINITIONS else 0.0
        difference: Array = np.abs(second - ideal) - np.abs(first - ideal)
        difference[np.abs(difference) < ROUNDING] = 0.0
        return difference


def compare_pairs(pairs: Sequence[PairedValues]) -> tuple[PairedComparison, ...]:
    """Compare each pair of variants over the walks that both have; pairs without a common walk are left out."""
    differences = [pair.differences() for pair in pairs]
    of_length: dict[int, list[int]] = {}
    for number, difference in enumerate(differences):
        of_length.setdefault(len(difference), []).append(number)
    intervals: dict[int, tuple[float, float]] = {}
    for length, numbers in of_length.items():
        if length > 1:
            bounds = bootstrap_intervals(np.array([differences[number] for number in numbers]))
            intervals.update(zip(numbers, map(tuple, bounds.tolist()), strict=True))
    return tuple(
        _comparison(pair, difference, *intervals.get(number, (None, None)))
        for number, (pair, difference) in enumerate(zip(pairs, differences, strict=True))
        if len(difference)
    )


def _comparison(pair: PairedValues, difference: Array, low: float | None, high: float | None) -> PairedComparison:
    first, second = pair.common()
    return PairedComparison(
        metric=pair.metric,
        first=pair.first,
        second=pair.second,
        n=len(difference),
        mean_first=float(first.mean()),
        mean_second=float(second.mean()),
        difference=float(difference.mean()),
        low=low,
        high=high,
        first_wins=int((difference > 0.0).sum()),
        second_wins=int((difference < 0.0).sum()),
    )


def bootstrap_intervals(values: Array) -> Array:
    """Compute the 95 % percentile bootstrap intervals of the means of values on the same walks.

    Walks are drawn with replacement, `RESAMPLES` times, the same for all rows. With few walks the interval is too
    narrow: with 5 walks it contains the true mean in about 84 % of the cases instead of 95 %. With more than
    `MOST_RESAMPLED` walks the mean is distributed normally, and the interval is that of its standard error.

    Parameters
    ----------
    values : ndarray
        (k, n), n walks of each of k comparisons.

    Returns
    -------
    ndarray
        (k, 2) lower and upper bounds.
    """
    tail, walks = 0.5 * (1.0 - _CONFIDENCE), values.shape[1]
    if walks > MOST_RESAMPLED:
        reach = NormalDist().inv_cdf(1.0 - tail) * values.std(axis=1) / np.sqrt(walks)
        return np.column_stack([values.mean(axis=1) - reach, values.mean(axis=1) + reach])
    rng = np.random.default_rng(_SEED)
    rows = max(_BLOCK // walks, 1)
    means = [
        _times_drawn(rng, min(rows, RESAMPLES - begun), walks) @ values.T / walks
        for begun in range(0, RESAMPLES, rows)
    ]
    return np.ascontiguousarray(np.quantile(np.concatenate(means), [tail, 1.0 - tail], axis=0).T)


def _times_drawn(rng: np.random.Generator, resamples: int, walks: int) -> Array:
    """Draw walks with replacement, and return how often each of them was drawn, (resamples, walks)."""
    drawn = rng.integers(walks, size=(resamples, walks)) + walks * np.arange(resamples)[:, None]
    return np.bincount(drawn.ravel(), minlength=resamples * walks).reshape(resamples, walks).astype(np.float64)
