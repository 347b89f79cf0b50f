"""Two variants on the same walks: differences walk by walk, how sure they are, and who wins how often."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from pdr_est.evaluate.metric_definitions import DEFINITIONS
from pdr_est.frames import Array

RESAMPLES = 10_000
_SEED = 20_160_401  # fixed: the same results, the same intervals
ROUNDING = 1e-6  # no metric is known better than this: such differences are ties
_BLOCK = 1_000_000  # numbers drawn at once


@dataclass(frozen=True)
class Paired:
    """One metric of two variants over the walks that have it with both.

    mean_first, mean_second: of the metric. difference: mean over walks of how much farther the second is from the
    metric's ideal value than the first; negative: the second is better. low, high: its 95 % interval, None for a
    single walk. first_wins, second_wins: walks on which each is nearer to the ideal; the others are ties.
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
        """Walks on which none is better."""
        return self.n - self.first_wins - self.second_wins

    @property
    def better(self) -> str | None:
        """The variant that is better beyond doubt: the interval of the difference does not hold zero."""
        if self.low is None or self.high is None or self.low <= 0.0 <= self.high:
            return None
        return self.second if self.high < 0.0 else self.first


def paired(
    metric: str, first: str, second: str, by_first: Mapping[str, float], by_second: Mapping[str, float]
) -> Paired | None:
    """The comparison over the walks that both have; None without any. by_first, by_second: walk -> value.

    A walk counts once: of several tracks give the mean. Unknown metrics are taken for errors, whose ideal is zero.
    """
    walks = [walk for walk in by_first if walk in by_second]
    if not walks:
        return None
    a, b = (np.array([values[walk] for walk in walks]) for values in (by_first, by_second))
    ideal = DEFINITIONS[metric].ideal if metric in DEFINITIONS else 0.0
    difference = np.abs(b - ideal) - np.abs(a - ideal)
    difference[np.abs(difference) < ROUNDING] = 0.0
    low, high = interval(difference) if len(walks) > 1 else (None, None)
    return Paired(
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


def interval(values: Array, confidence: float = 0.95) -> tuple[float, float]:
    """Percentile bootstrap interval of the mean of values (n,): walks are drawn with replacement, `RESAMPLES` times.

    With few walks it is too narrow: of 5 walks it holds the true mean in about 84 % of the cases and not in 95 %.
    """
    rng = np.random.default_rng(_SEED)
    rows = max(_BLOCK // len(values), 1)
    means = [
        values[rng.integers(len(values), size=(min(rows, RESAMPLES - begun), len(values)))].mean(axis=1)
        for begun in range(0, RESAMPLES, rows)
    ]
    low, high = np.quantile(np.concatenate(means), [0.5 - confidence / 2.0, 0.5 + confidence / 2.0])
    return float(low), float(high)
