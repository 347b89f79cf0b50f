"""Numbers of the comparison's curves: distribution and growth of the errors, consistency of the covariance."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.stats import chi2

from pdr_est.frames import Array
from pdr_est.report.plots.legend import LegendEntry
from pdr_est.types.outcome import TrackOutcome

NOMINAL = np.linspace(0.0, 1.0, 101)
"""Stated probabilities at which the coverage is computed."""

_WIDE_RANGE = ((0.5, 3.0), (0.9, 5.0))  # of a quantile of the variants: above it, a logarithmic axis shows them all
_BINS = 12
_FEWEST = 5  # errors in a bin, for a percentile
_CURVE_POINTS = 301  # of a distribution
_FEW = 100  # errors of a variant, which are drawn one by one


@dataclass(frozen=True)
class ErrorGrowth:
    """Percentiles of the error over the distance walked.

    Attributes
    ----------
    middle_m : Array
        Middles of the bins of the distance, (k,), m.
    median_m, p90_m : tuple of Array
        Median and 90th percentile of each variant's errors in each bin, (k,), m; NaN where there are too few.
    farthest_m : float
        End of the last bin, m.
    few : bool
        True for so few errors that each is drawn.
    """

    middle_m: Array
    median_m: tuple[Array, ...]
    p90_m: tuple[Array, ...]
    farthest_m: float
    few: bool


def pooled_values(outcomes: Sequence[TrackOutcome], variant: str, name: str) -> Array:
    """Join a field (`error_m`, `way_m`, `squared`) of all results of a variant."""
    return np.concatenate([np.empty(0), *(getattr(one, name) for one in outcomes if one.variant == variant)])


def error_growth(outcomes: Sequence[TrackOutcome], variants: Sequence[str]) -> ErrorGrowth:
    """Compute the percentiles of each variant's errors in bins of the distance walked."""
    farthest_m = max((float(one.way_m.max()) for one in outcomes if len(one.way_m)), default=1.0) or 1.0
    pools = [pooled_values(outcomes, name, "error_m") for name in variants]
    most = max((len(pool) for pool in pools), default=0)
    bins = int(np.clip(most // (2 * _FEWEST), 1, _BINS))
    edges = np.linspace(0.0, farthest_m, bins + 1)
    high: tuple[list[Array], list[Array]] = ([], [])
    for name, error_m in zip(variants, pools, strict=True):
        way_m = pooled_values(outcomes, name, "way_m")
        place = np.clip(np.searchsorted(edges, way_m, side="right") - 1, 0, bins - 1)
        within = [error_m[place == i] for i in range(bins)]
        for found, share in zip(high, (0.5, 0.9), strict=True):
            found.append(np.array([np.quantile(part, share) if len(part) >= _FEWEST else np.nan for part in within]))
    return ErrorGrowth(0.5 * (edges[1:] + edges[:-1]), tuple(high[0]), tuple(high[1]), farthest_m, most < _FEW)


def coverage_shares(squared: Array) -> Array:
    """Compute the share of errors inside the confidence region of each probability in `NOMINAL`, (101,).

    Parameters
    ----------
    squared : Array
        Squared Mahalanobis distances of the errors, (n,).
    """
    shares: Array = np.searchsorted(np.sort(squared), chi2.ppf(NOMINAL, 2), side="right") / len(squared)
    return shares


def error_range(pools: Sequence[Array]) -> tuple[float, float]:
    """Find the range of errors to draw, m: without the smallest and the largest 2 % of any variant."""
    known = [pool for pool in pools if len(pool)]
    lowest = min((float(np.quantile(pool, 0.02)) for pool in known), default=0.0)
    highest = max((float(np.quantile(pool, 0.98)) for pool in known), default=0.0)
    return lowest, max(highest, 1.01 * lowest) or 1.0


def growth_range(growth: ErrorGrowth, pools: Sequence[Array]) -> tuple[float, float]:
    """Find the range of the errors over the distance, m; it begins at 0 unless a logarithmic axis helps.

    Parameters
    ----------
    growth : ErrorGrowth
        What is drawn.
    pools : sequence of Array
        Errors of each variant, m.
    """
    drawn = np.concatenate([*growth.median_m, *growth.p90_m, *(pools if growth.few else ()), np.empty(0)])
    heights = drawn[np.isfinite(drawn) & (drawn > 0.0)]
    if not len(heights):
        return 0.0, 1.0
    if differ_widely(pools):
        return 0.8 * float(heights.min()), 1.25 * float(heights.max())
    return 0.0, 1.05 * float(heights.max())


def differ_widely(pools: Sequence[Array]) -> bool:
    """Return true if the errors of some variants are many times those of others, so that a logarithmic axis helps."""
    known = [pool for pool in pools if len(pool)]
    for share, widest in _WIDE_RANGE if known else ():
        high = [float(np.quantile(pool, share)) for pool in known]
        if max(high) > widest * min(high) > 0.0:
            return True
    return False


def error_curves(outcomes: Sequence[TrackOutcome], variants: Sequence[LegendEntry]) -> dict[str, Any]:
    """Describe the curves that the data allow as JSON-serialisable data, by the name of their plot.

    Parameters
    ----------
    outcomes : sequence of TrackOutcome
        Results.
    variants : sequence of LegendEntry
        Line of each variant, labelled with its name.
    """
    names = [entry.label for entry in variants]
    pools = [pooled_values(outcomes, name, "error_m") for name in names]
    squared = [pooled_values(outcomes, name, "squared") for name in names]
    curves = {}
    if any(len(pool) for pool in pools):
        curves["cdf"] = _distribution_curve(pools, variants)
        growth = error_growth(outcomes, names)
        if not growth.few:
            curves["growth"] = _growth_curve(growth, pools, variants)
    if any(len(pool) for pool in squared):
        lines = [
            _curve(entry, coverage_shares(pool)) for entry, pool in zip(variants, squared, strict=True) if len(pool)
        ]
        ideal = _curve(LegendEntry("line", "muted", "ideal", (4.0, 2.5)), NOMINAL, 1.0)
        curves["coverage"] = _chart(NOMINAL, [*lines, ideal], "stated probability", "share inside", (0.0, 1.0)) | {
            "x_percent": True,
            "y_percent": True,
        }
    return curves


def _distribution_curve(pools: Sequence[Array], variants: Sequence[LegendEntry]) -> dict[str, Any]:
    lowest, highest = error_range(pools)
    logarithmic = differ_widely(pools) and lowest > 0.0
    error_m = (np.geomspace if logarithmic else np.linspace)(lowest if logarithmic else 0.0, highest, _CURVE_POINTS)
    lines = [
        _curve(entry, np.searchsorted(np.sort(pool), error_m, side="right") / len(pool))
        for entry, pool in zip(variants, pools, strict=True)
        if len(pool)
    ]
    chart = _chart(error_m, lines, "error (m)", "share below", (0.0, 1.0))
    return chart | {"x_log": logarithmic, "y_percent": True}


def _growth_curve(growth: ErrorGrowth, pools: Sequence[Array], variants: Sequence[LegendEntry]) -> dict[str, Any]:
    lines = []
    for entry, median_m, p90_m in zip(variants, growth.median_m, growth.p90_m, strict=True):
        lines += [
            _curve(entry, median_m, 2.5, "median"),
            _curve(entry, p90_m, 1.2, "90 %"),
        ]
    limits = growth_range(growth, pools)
    return _chart(growth.middle_m, lines, "distance walked (m)", "error (m)", limits) | {"y_log": limits[0] > 0.0}


def _chart(
    x: Array, lines: Sequence[Mapping[str, Any]], x_label: str, y_label: str, y_range: tuple[float, float]
) -> dict[str, Any]:
    return {"x": _rounded(x), "lines": lines, "x_label": x_label, "y_label": y_label, "y_range": y_range}


def _curve(entry: LegendEntry, y: Array, width: float = 2.0, part: str = "") -> dict[str, Any]:
    look = {"colour": f"--{entry.colour}", "dashes": entry.dashes, "width": width}
    return {"variant": entry.label, "part": part, **look, "y": _rounded(y)}


def _rounded(numbers: Array) -> list[float | None]:
    return [float(f"{number:.4g}") if np.isfinite(number) else None for number in numbers]
