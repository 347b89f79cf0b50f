"""The tables of an experiment, from the parts of its walks: the same parts, the same bytes."""

import csv
import io
from collections.abc import Sequence
from pathlib import Path

from pdr_est.experiment.loader import Experiment
from pdr_est.experiment.results.result_folder import FAILED, RESULTS, TIMINGS, write
from pdr_est.experiment.runners.walk_result import WalkResult
from pdr_est.io.writers.parquet import write_parquet
from pdr_est.types.outcome import TrackOutcome


def write_tables(folder: Path, experiment: Experiment, parts: Sequence[WalkResult]) -> None:
    """Write results.parquet, timings.parquet and failed.csv. parts: in the order of the experiment's walks.

    results.parquet is long: walk, track, variant, the keys to group by, mode, metric, value. CPU times are never the
    same twice and have a table of their own.
    """
    outcomes = ordered(experiment, parts)
    keys = list(dict.fromkeys(key for outcome in outcomes for key in outcome.labels))
    rows = [(outcome, metric) for outcome in outcomes for metric in experiment.metrics]
    _table(
        folder / RESULTS,
        {
            "walk": [outcome.walk for outcome, _ in rows],
            "track": [outcome.track for outcome, _ in rows],
            "variant": [outcome.variant for outcome, _ in rows],
            **{key: [outcome.labels.get(key) for outcome, _ in rows] for key in keys},
            "mode": [outcome.mode for outcome, _ in rows],
            "metric": [metric for _, metric in rows],
        },
        {"value": [outcome.metrics[metric] for outcome, metric in rows]},
    )
    timed = [
        (part, variant.name) for part in parts for variant in experiment.variants if variant.name in part.seconds
    ]
    _table(
        folder / TIMINGS,
        {"walk": [part.walk for part, _ in timed], "variant": [name for _, name in timed]},
        {"chain_s": [part.seconds[name] for part, name in timed], "walk_s": [part.work_s for part, _ in timed]},
    )
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(("walk", "what", "reason"))
    for part in parts:
        for failure in part.failures:
            writer.writerow((failure.walk, "walk" if failure.whole else "metric", failure.reason))
    write(folder / FAILED, text.getvalue())


def ordered(experiment: Experiment, parts: Sequence[WalkResult]) -> list[TrackOutcome]:
    """All tracks: by walk, then by track, then by variant in the order of the experiment."""
    place = {variant.name: number for number, variant in enumerate(experiment.variants)}
    outcomes = []
    for part in parts:
        tracks = list(dict.fromkeys(track.track for track in part.tracks))
        outcomes += sorted(part.tracks, key=lambda one: (tracks.index(one.track), place[one.variant]))
    return outcomes


def _table(
    path: Path, texts: dict[str, list[str] | list[str | None]], numbers: dict[str, list[float] | list[float | None]]
) -> None:
    half = path.with_name(f".{path.name}.half")
    write_parquet(half, texts, numbers)
    half.replace(path)
