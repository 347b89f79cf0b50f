"""Run of an experiment: walks without a result, then the tables and the report."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pdr_est.errors import ConfigError, FloorPlanError
from pdr_est.evaluate.paired_comparison import PairedComparison
from pdr_est.experiment.loader import Experiment
from pdr_est.experiment.results.comparison import compare_variants, read_values
from pdr_est.experiment.results.provenance import provenance
from pdr_est.experiment.results.result_folder import REPORT, open_result_folder
from pdr_est.experiment.results.tables import ordered, write_tables
from pdr_est.experiment.results.walk_result import WalkResult, decode, encode, store, stored
from pdr_est.experiment.runners.dask_cluster import connected, run_on_cluster
from pdr_est.experiment.runners.processes import FinishedWalk, run_in_processes
from pdr_est.experiment.runners.scoring_job import ScoringJob, experiment_job
from pdr_est.experiment.scoring.known_plan import PLAN_METRICS
from pdr_est.experiment.variants.alignment import aligned_variants
from pdr_est.experiment.walks import Walk
from pdr_est.output.own_files import OwnFiles
from pdr_est.types.floor_plan import FloorPlan

Progress = Callable[[int, int], None]
Run = Callable[[ScoringJob, Sequence[Walk]], Iterator[FinishedWalk]]

_MOST_PAIRED = 4  # variants that the report compares each with each; of more, the first one with every other


@dataclass(frozen=True)
class FinishedExperiment:
    """Results of a complete run.

    Attributes
    ----------
    results : tuple of WalkResult
        One for each walk, in the order of the experiment.
    resumed : int
        Number of walks whose results existed from an earlier run.
    """

    results: tuple[WalkResult, ...]
    resumed: int

    @property
    def failed(self) -> int:
        """Number of walks without a scored track."""
        return sum(not result.tracks for result in self.results)


def run_experiment(
    experiment: Experiment,
    output: Path,
    workers: int = 1,
    cluster: str | None = None,
    overwrite: bool = False,
    on_progress: Progress | None = None,
) -> FinishedExperiment:
    """Score every walk that has no result in `output` yet, and write the tables and the report there.

    A run that is killed can be started again with the same arguments. The results do not depend on where or in which
    order the walks are scored.

    Parameters
    ----------
    experiment : Experiment
        The experiment, from `load_experiment`.
    output : Path
        Folder of the results.
    workers : int
        Number of processes of this computer.
    cluster : str, optional
        Address of a Dask scheduler that is used instead.
    overwrite : bool
        True if results of another configuration, other data or other code may be replaced; then every walk is scored.
    on_progress : Callable, optional
        Called with the number of finished walks and of all walks.

    Raises
    ------
    ConfigError
        For a number out of range, or a cluster that cannot be reached.
    OutputError
        If the folder contains something else.
    """
    if workers < 1:
        raise ConfigError(f"workers = {workers}: must be at least 1")
    with _runner(workers, cluster) as run:  # before the folder: a cluster that cannot be reached leaves no files
        return _run(experiment, output, run, overwrite, on_progress or _no_progress)


def _run(
    experiment: Experiment, output: Path, run: Run, overwrite: bool, on_progress: Progress
) -> FinishedExperiment:
    document = provenance(experiment)
    folder = open_result_folder(output, document, experiment.to_yaml(), overwrite, [experiment.path])
    results = stored(folder, (walk.name for walk in experiment.walks))
    resumed = len(results)
    missing = [walk for walk in experiment.walks if walk.name not in results]
    on_progress(resumed, len(experiment.walks))
    for done in run(experiment_job(experiment), missing) if missing else ():
        content = encode(done.result)
        if done.final:
            store(folder, done.walk.name, content)
        results[done.walk.name] = decode(content)  # rounded, as a resumed run would read it
        on_progress(len(results), len(experiment.walks))
    in_order = tuple(results[walk.name] for walk in experiment.walks)
    write_tables(output, experiment, in_order)
    finished = FinishedExperiment(in_order, resumed)
    _write_report(output, experiment, finished, document)
    return finished


def _no_progress(_done: int, _total: int) -> None:
    pass


@contextmanager
def _runner(workers: int, cluster: str | None) -> Iterator[Run]:
    """Give the function that scores walks: in processes of this computer, or on a cluster that has answered."""
    if cluster is None:
        yield lambda job, walks: run_in_processes(job, walks, min(workers, len(walks)))
        return
    with connected(cluster) as client:
        yield lambda job, walks: run_on_cluster(job, walks, client)


def _write_report(
    output: Path, experiment: Experiment, finished: FinishedExperiment, document: dict[str, Any]
) -> None:
    from pdr_est.report.comparison.page import ComparisonContent, render_comparison  # matplotlib is slow to load

    content = ComparisonContent(
        title=experiment.title,
        variants=tuple(variant.name for variant in experiment.variants),
        metrics=experiment.metrics,
        group_by=experiment.config.group_by,
        outcomes=tuple(ordered(experiment, finished.results)),
        pairs=_pairs(output),
        failed=finished.failed,
        failures=tuple((one.walk, one.reason) for result in finished.results for one in result.failures),
        config=experiment.to_yaml(),
        provenance=document,
        aligned=aligned_variants(experiment.variants),
        plans=_plans(experiment),
    )
    OwnFiles(output).write(REPORT, render_comparison(content))


def _plans(experiment: Experiment) -> dict[str, FloorPlan]:
    """Read the floor plans of the walks, if they are scored on them; a plan that cannot be used is left out."""
    found: dict[str, FloorPlan] = {}
    for walk in experiment.walks if set(PLAN_METRICS) & set(experiment.metrics) else ():
        with suppress(FloorPlanError):  # which is among the failures
            plan = walk.floor_plan(experiment.suite)
            found |= {} if plan is None else {walk.name: plan}
    return found


def _pairs(output: Path) -> tuple[PairedComparison, ...]:
    """Compare each variant with each; of many, the first one with every other."""
    values = read_values([output])
    variants = list(dict.fromkeys(name for of_metric in values.values() for name in of_metric))
    if len(variants) < 2:
        return ()
    return compare_variants(values, reference=variants[0] if len(variants) > _MOST_PAIRED else None)
