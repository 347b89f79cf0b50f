"""Result rows of made-up walks for the tests."""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from pdr_est.config import Config
from pdr_est.experiment import BenchmarkResult
from pdr_est.experiment.results.walk_result import Failure
from pdr_est.experiment.suite import WalkFile
from pdr_est.experiment.suites import suite_named
from pdr_est.experiment.variants.axes import Comparison, Variant, axis_named
from pdr_est.types.outcome import TrackOutcome

SECONDS = 0.125
_NOTHING = np.empty(0)


def result_row(
    walk: str,
    variant: str,
    metrics: Mapping[str, float | None],
    track: str = "device",
    labels: Mapping[str, str] | None = None,
    counts: Mapping[str, int] | None = None,
) -> TrackOutcome:
    """Make a row without anything to plot."""
    return TrackOutcome(
        walk=walk,
        track=track,
        variant=variant,
        labels=labels or {},
        mode="HOLDING",
        metrics=metrics,
        steps=0,
        true_steps=None,
        mode_shares={},
        with_fixes=False,
        position_m=np.empty((0, 2)),
        truth_m=np.empty((0, 2)),
        way_m=_NOTHING,
        error_m=_NOTHING,
        squared=_NOTHING,
        counts=counts or {},
    )


def benchmark_result(
    suite: str,
    axis: str,
    names: Iterable[str],
    metrics: tuple[str, ...],
    rows: Iterable[TrackOutcome],
    files: Iterable[WalkFile] = (),
    failures: Iterable[Failure] = (),
) -> BenchmarkResult:
    """Make a benchmark result whose main variant is the first one; walks without a file have no labels."""
    variants = tuple(Variant(name, axis_named(axis).with_value(Config(), name)) for name in names)
    known = {file.name: file for file in files}
    rows = tuple(rows)
    return BenchmarkResult(
        suite=replace(suite_named(suite), metrics=metrics),
        comparison=Comparison(axis, variants, variants[0]),
        files={row.walk: known.get(row.walk, WalkFile(row.walk, Path(row.walk))) for row in rows},
        rows=rows,
        failures=tuple(failures),
        seconds={(row.walk, row.variant): SECONDS for row in rows},
    )
