"""Runs a suite: every walk through the chain, in as many processes as wanted."""

import math
import multiprocessing
import signal
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from pdr_est import __version__, pipeline
from pdr_est.config import Config, import_folders
from pdr_est.errors import ConfigError, EstimationError, PdrError, RecordingError
from pdr_est.experiment.recording_files import in_words, suite_folder
from pdr_est.experiment.results.score_rows import BenchmarkResult, SkippedWalk, WalkRow
from pdr_est.experiment.scoring.calibrated import CalibrationCase, with_calibrated
from pdr_est.experiment.suite import AnalysedWalk, Scores, Suite, WalkFile
from pdr_est.experiment.suites import suite_named
from pdr_est.experiment.variants.axes import Comparison, Variant, same_front_end
from pdr_est.experiment.walks import with_truth
from pdr_est.io import read
from pdr_est.parts import importable
from pdr_est.pipeline import DeviceWalk
from pdr_est.types.recording import Recording

Progress = Callable[[int, int], None]


def run_benchmark(
    suite: str,
    data: Path,
    comparison: Comparison,
    jobs: int = 1,
    limit: int | None = None,
    on_progress: Progress | None = None,
) -> BenchmarkResult:
    """Score the walks of a suite with each variant of a comparison (`variant.compare`).

    data: the folder that holds the suite's folder, or that folder itself. jobs: how many processes. limit: only the
    first so many walks. on_progress: called with the number of finished walks and of all walks. The walks come in
    order of name, whatever the number of jobs.

    Raises ConfigError for an unknown suite, a number out of range or settings that cannot be used, RecordingError
    when the folder holds no walk, EstimationError when a process dies. What goes wrong with a single walk is told in
    the result's `skipped`.
    """
    chosen = suite_named(suite)
    if jobs < 1 or (limit is not None and limit < 1):
        raise ConfigError(f"jobs = {jobs}, limit = {limit}: each must be at least 1")
    walks = chosen.find(suite_folder(data, chosen.folder))[:limit]
    if not walks:
        wanted = in_words(chosen.folder)
        raise RecordingError(f"{data}: no walk of the suite {suite}: give the folder that holds {wanted}")
    outcomes: list[Outcome] = []
    work = partial(run_walk, suite, variants=comparison.variants)
    with_graph = any(variant.config.estimator.make().spec.needs_gtsam for variant in comparison.variants)
    folders = [folder for variant in comparison.variants for folder in import_folders(variant.config)]
    with importable(folders):  # also in the processes, which start with this path
        for outcome in _map(work, walks, min(jobs, len(walks)), with_graph):
            outcomes.append(outcome)
            if on_progress is not None:
                on_progress(len(outcomes), len(walks))
    rows, too_few = with_calibrated(
        [row for outcome in outcomes for row in outcome.rows],
        [case for outcome in outcomes for case in outcome.cases],
        chosen.calibrated_on,
        chosen.calibrated,
    )
    return BenchmarkResult(
        suite=suite,
        version=__version__,
        axis=comparison.axis,
        names=comparison.names,
        settings=comparison.main.settings(),
        metrics=chosen.metrics,
        pool=chosen.pool,
        rows=rows,
        skipped=(*(walk for outcome in outcomes for walk in outcome.skipped), *too_few),
    )


@dataclass(frozen=True)
class Outcome:
    """Of one walk: a row for each variant and track, what each tells about its walker, and what could not be told."""

    rows: tuple[WalkRow, ...] = ()
    skipped: tuple[SkippedWalk, ...] = ()
    cases: tuple[CalibrationCase | None, ...] = ()


def run_walk(suite: str, file: WalkFile, variants: Sequence[Variant]) -> Outcome:
    """Read, analyse, estimate and score one walk; what is wrong with it makes it a skipped walk.

    Raises ConfigError, which is no fault of the walk. Errors that are none of this package's get its name.
    """
    try:
        return _run_walk(suite_named(suite), file, variants)
    except ConfigError:
        raise
    except PdrError as error:
        return Outcome(skipped=(SkippedWalk(file.name, without_name(str(error), file)),))
    except Exception as error:
        error.add_note(f"in the walk {file.name}")
        raise


def _run_walk(suite: Suite, file: WalkFile, variants: Sequence[Variant]) -> Outcome:
    recording = with_truth(suite.prepare(read(file.path)), file.truth)
    rows: list[WalkRow] = []
    cases: list[CalibrationCase | None] = []
    reasons: list[str] = []
    for scored in score_variants(suite, recording, variants):
        rows += [_row(suite, file, scored.variant, of_track, scored.walk.seconds) for of_track in scored.scores]
        cases += [of_track.calibration for of_track in scored.scores]
        reasons += scored.reasons
    # A reason that does not depend on the variant or the track is given once.
    skipped = tuple(SkippedWalk(file.name, reason) for reason in dict.fromkeys(reasons))
    return Outcome(tuple(rows), skipped, tuple(cases))


@dataclass(frozen=True)
class Scored:
    """A walk after one variant. scores: of each track, none when the estimator failed. reasons: what is missing and
    why."""

    variant: Variant
    walk: AnalysedWalk
    scores: tuple[Scores, ...]
    reasons: tuple[str, ...]


def score_variants(suite: Suite, recording: Recording, variants: Sequence[Variant]) -> Iterator[Scored]:
    """Analyse, estimate and score a recording with one variant after the other.

    Raises RecordingError when the recording cannot be used by a front end that all variants share, or cannot be
    scored. What one of several variants, or an estimator, cannot do is a reason: a heading by a magnetometer that is
    not there.
    """
    for variant, devices, seconds in _analysed(recording, variants):
        if isinstance(devices, RecordingError):
            if all(same_front_end(variant.config, other.config) for other in variants):
                raise devices
            yield Scored(variant, AnalysedWalk(recording, (), variant.config), (), (f"{variant.name}: {devices}",))
            continue
        walk = AnalysedWalk(recording, devices, variant.config, seconds)
        try:
            scores = suite.score(walk)
        except EstimationError as error:
            yield Scored(variant, walk, (), (f"{variant.name}: {error}",))
            continue
        reasons = tuple(reason for of_track in scores for reason in _missing(suite, of_track))
        yield Scored(variant, walk, tuple(scores), reasons)


def without_name(reason: str, file: WalkFile) -> str:
    """A reason without the name of the walk or its recording, which stands before it anyway."""
    for name in (file.name, file.name.rpartition("/")[2]):
        reason = reason.removeprefix(f"{name}: ")
    return reason


def _analysed(
    recording: Recording, variants: Sequence[Variant]
) -> Iterator[tuple[Variant, tuple[DeviceWalk, ...] | RecordingError, float]]:
    """Each variant with what its front end found, or why it found nothing, and the CPU time of that; equal front ends
    in a row run once."""
    before: Config | None = None
    for variant in variants:
        if before is None or not same_front_end(before, variant.config):
            before, started = variant.config, time.process_time()
            devices = _found(recording, variant.config)
            seconds = time.process_time() - started
        yield variant, devices, seconds


def _found(recording: Recording, config: Config) -> tuple[DeviceWalk, ...] | RecordingError:
    try:
        return pipeline.analyse(recording, config)
    except RecordingError as error:
        return error


def _row(suite: Suite, file: WalkFile, variant: Variant, scores: Scores, seconds: float) -> WalkRow:
    known = {metric: scores.values.get(metric, math.nan) for metric in suite.metrics}
    return WalkRow(
        walk=file.name,
        track=scores.track,
        settings=variant.settings(),
        mode=scores.mode,
        metrics={metric: value if math.isfinite(value) else None for metric, value in known.items()},
        seconds=seconds,
        labels=file.labels,
        counts=scores.counts,
        predicted=scores.predicted,
        group=file.group,
        headline=file.headline,
    )


def _missing(suite: Suite, scores: Scores) -> list[str]:
    """Why metrics of a row are None; metrics with the same reason in one sentence."""
    by_reason: dict[str, list[str]] = {}
    for metric in suite.metrics:
        applies = metric in scores.values or metric in scores.missing
        if applies and not math.isfinite(scores.values.get(metric, math.nan)):
            by_reason.setdefault(scores.missing.get(metric, "not a finite number"), []).append(metric)
    return [f"{', '.join(metrics)}: {reason}" for reason, metrics in by_reason.items()]


def _map(
    work: Callable[[WalkFile], Outcome], walks: Sequence[WalkFile], jobs: int, with_graph: bool
) -> Iterator[Outcome]:
    """The outcomes in order of the walks."""
    if jobs == 1:
        warm_up(with_graph)
        yield from map(work, walks)
        return
    # Spawned and not forked: the same on every platform, and safe with the threads of numpy and GTSAM.
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(jobs, mp_context=context, initializer=warm_up, initargs=(with_graph,)) as pool:
        with without_interrupts():
            outcomes = pool.map(work, walks)
        yield from _until_broken(outcomes)


@contextmanager
def without_interrupts() -> Iterator[None]:
    """Processes that start within ignore Ctrl-C, which reaches all of them: this one alone winds up the work."""
    if threading.current_thread() is not threading.main_thread():
        yield  # signals are the main thread's business
        return
    usual = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, usual)


def _until_broken(outcomes: Iterable[Outcome]) -> Iterator[Outcome]:
    try:
        yield from outcomes
    except BrokenProcessPool as error:
        raise EstimationError(
            "a worker process died: run with one job to see at which walk, and with more memory"
        ) from error


def warm_up(with_graph: bool) -> None:
    """Load what is loaded at first use, so that its time does not count as the first walk's."""
    if with_graph:
        from pdr_est.estimators.factor_graph import smoother as factor_graph  # noqa: F401
