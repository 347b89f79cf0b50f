"""Runs an experiment: what is missing of its walks, then the tables and the report."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pdr_est.errors import ConfigError
from pdr_est.evaluate.paired_comparison import Paired
from pdr_est.experiment.loader import Experiment
from pdr_est.experiment.results.comparison import compare_variants, read_values
from pdr_est.experiment.results.provenance import provenance
from pdr_est.experiment.results.result_folder import REPORT, begin, write
from pdr_est.experiment.results.tables import ordered, write_tables
from pdr_est.experiment.runners.dask_cluster import connected, run_on_cluster
from pdr_est.experiment.runners.processes import Done, run_locally
from pdr_est.experiment.runners.walk_job import Work, work_of
from pdr_est.experiment.runners.walk_result import WalkResult, decode, store, stored
from pdr_est.experiment.walks import Walk

Progress = Callable[[int, int], None]
Run = Callable[[Work, Sequence[Walk]], Iterator[Done]]

_MOST_PAIRED = 4  # variants that the page compares each with each; of more, the first one with every other


@dataclass(frozen=True)
class Finished:
    """A run that came to its end. parts: in the order of the experiment's walks. resumed: how many were there."""

    parts: tuple[WalkResult, ...]
    resumed: int

    @property
    def failed(self) -> int:
        """Number of walks of which nothing could be told."""
        return sum(not part.tracks for part in self.parts)


def run_experiment(
    experiment: Experiment,
    output: Path,
    workers: int = 1,
    cluster: str | None = None,
    overwrite: bool = False,
    on_progress: Progress | None = None,
) -> Finished:
    """Work on every walk that `output` has no part of yet, and write the results there.

    workers: processes of this computer. cluster: address of a Dask scheduler, which is used instead. overwrite:
    whether results of another configuration, other data or other code may be replaced; then all is done anew.
    on_progress: called with the number of finished walks and of all.

    A run that is killed can be started again with the same arguments. The results do not depend on where or in which
    order the walks are done. Raises ConfigError for a number out of range or a cluster that cannot be reached,
    OutputError when the folder holds something else.
    """
    if workers < 1:
        raise ConfigError(f"workers = {workers}: must be at least 1")
    with _runner(workers, cluster) as run:  # before the folder: who cannot be reached leaves nothing behind
        return _run(experiment, output, run, overwrite, on_progress or _unheard)


def _run(experiment: Experiment, output: Path, run: Run, overwrite: bool, on_progress: Progress) -> Finished:
    document = provenance(experiment)
    folder = begin(output, document, experiment.to_yaml(), overwrite)
    parts = stored(folder, (walk.name for walk in experiment.walks))
    resumed = len(parts)
    missing = [walk for walk in experiment.walks if walk.name not in parts]
    on_progress(resumed, len(experiment.walks))
    for done in run(work_of(experiment), missing) if missing else ():
        if done.keep:
            store(folder, done.walk.name, done.content)
        parts[done.walk.name] = decode(done.content)
        on_progress(len(parts), len(experiment.walks))
    in_order = tuple(parts[walk.name] for walk in experiment.walks)
    write_tables(output, experiment, in_order)
    _write_report(output, experiment, in_order, document)
    return Finished(in_order, resumed)


def _unheard(_done: int, _total: int) -> None:
    """Progress that nobody asked for."""


@contextmanager
def _runner(workers: int, cluster: str | None) -> Iterator[Run]:
    """What does the work: processes of this computer, or a cluster that has answered."""
    if cluster is None:
        yield lambda work, walks: run_locally(work, walks, min(workers, len(walks)))
        return
    with connected(cluster) as client:
        yield lambda work, walks: run_on_cluster(work, walks, client)


def _write_report(
    output: Path, experiment: Experiment, parts: tuple[WalkResult, ...], document: dict[str, Any]
) -> None:
    from pdr_est.report.comparison.page import ComparisonContent, render_comparison  # matplotlib is slow to load

    names = tuple(variant.name for variant in experiment.variants)
    content = ComparisonContent(
        title=experiment.title,
        variants=names,
        metrics=experiment.metrics,
        group_by=experiment.config.group_by,
        outcomes=tuple(ordered(experiment, parts)),
        pairs=_pairs(output),
        failed=sum(not part.tracks for part in parts),
        failures=tuple((failure.walk, failure.reason) for part in parts for failure in part.failures),
        config=experiment.to_yaml(),
        provenance=document,
    )
    write(output / REPORT, render_comparison(content))


def _pairs(output: Path) -> tuple[Paired, ...]:
    """Each variant with each; of many, the first one with every other."""
    values = read_values([output])
    variants = list(dict.fromkeys(name for of_metric in values.values() for name in of_metric))
    if len(variants) < 2:
        return ()
    return compare_variants(values, reference=variants[0] if len(variants) > _MOST_PAIRED else None)
