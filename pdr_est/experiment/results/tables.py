"""Tables of an experiment: results.parquet, timings.parquet and failed.csv."""

import csv
import io
from collections.abc import Sequence
from pathlib import Path

from pdr_est.experiment.loader import Experiment
from pdr_est.experiment.results.result_folder import FAILED, RESULTS, TIMINGS
from pdr_est.experiment.results.walk_result import WalkResult
from pdr_est.io.writers.parquet import write_parquet
from pdr_est.output.csv_cells import harmless_cell
from pdr_est.output.own_files import OwnFiles
from pdr_est.types.outcome import TrackOutcome


def write_tables(folder: Path, experiment: Experiment, results: Sequence[WalkResult]) -> None:
    """Write the tables; equal results give equal bytes.

    results.parquet is long: walk, track, variant, the keys to group by, mode, metric, value. CPU times are never the
    same twice and have a table of their own.

    Parameters
    ----------
    folder : Path
        Folder of the results.
    experiment : Experiment
        The experiment.
    results : sequence of WalkResult
        One for each walk, in the order of the experiment.
    """
    own, outcomes = OwnFiles(folder), ordered(experiment, results)
    keys = list(dict.fromkeys(key for outcome in outcomes for key in outcome.labels))
    rows = [(outcome, metric) for outcome in outcomes for metric in experiment.metrics]
    _write_table(
        own,
        RESULTS,
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
        (result, variant.name)
        for result in results
        for variant in experiment.variants
        if variant.name in result.seconds
    ]
    _write_table(
        own,
        TIMINGS,
        {"walk": [result.walk for result, _ in timed], "variant": [name for _, name in timed]},
        {
            "chain_s": [result.seconds[name] for result, name in timed],
            "walk_s": [result.work_s for result, _ in timed],
        },
    )
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(("walk", "what", "reason"))
    for result in results:
        for failure in result.failures:
            cells = (failure.walk, "walk" if failure.whole else "metric", failure.reason)
            writer.writerow(map(harmless_cell, cells))
    own.write(FAILED, text.getvalue())


def ordered(experiment: Experiment, results: Sequence[WalkResult]) -> list[TrackOutcome]:
    """Sort all tracks by walk, then by track, then by variant in the order of the experiment."""
    place = {variant.name: number for number, variant in enumerate(experiment.variants)}
    outcomes = []
    for result in results:
        tracks = list(dict.fromkeys(track.track for track in result.tracks))
        outcomes += sorted(result.tracks, key=lambda one: (tracks.index(one.track), place[one.variant]))
    return outcomes


def _write_table(
    own: OwnFiles,
    name: str,
    texts: dict[str, list[str] | list[str | None]],
    numbers: dict[str, list[float] | list[float | None]],
) -> None:
    with own.staged(name) as staging:
        write_parquet(staging, texts, numbers)
