"""Work on one walk: read or simulate it, score every variant, and keep what the results need."""

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace

from threadpoolctl import threadpool_limits

from pdr_est.config import import_folders
from pdr_est.errors import ConfigError, FloorPlanError, PdrError
from pdr_est.experiment.analysed_walk import NO_PLAN
from pdr_est.experiment.held_out import HeldOutProtocol
from pdr_est.experiment.loader import Experiment
from pdr_est.experiment.results.walk_result import Failure, WalkResult
from pdr_est.experiment.runners.score_variants import score_variants
from pdr_est.experiment.runners.track_outcome import track_outcomes
from pdr_est.experiment.scoring.known_plan import PLAN_METRICS
from pdr_est.experiment.suite import CalibrationCase, Suite
from pdr_est.experiment.variants.axes import Variant, same_front_end
from pdr_est.experiment.walks import Walk
from pdr_est.parts import importable
from pdr_est.types.floor_plan import FloorPlan
from pdr_est.types.outcome import TrackOutcome


@dataclass(frozen=True)
class ScoringJob:
    """Work to do on every walk; it is sent to other processes and machines.

    Attributes
    ----------
    suite : Suite
        Rules of scoring, with the metrics that are wanted.
    protocol : HeldOutProtocol
        Rule that selects the fixes.
    variants : tuple of Variant
        Settings to compare; those that share a front end should be adjacent, so that it runs once.
    import_folders : tuple of str
        Folders of the modules that the variants name for parts from outside the package.
    stop_on_fault : bool
        True if settings that cannot be used and programming errors stop the run instead of failing one walk.
    """

    suite: Suite
    protocol: HeldOutProtocol
    variants: tuple[Variant, ...]
    import_folders: tuple[str, ...]
    stop_on_fault: bool = False


def scoring_job(
    suite: Suite, protocol: HeldOutProtocol, variants: tuple[Variant, ...], stop_on_fault: bool = False
) -> ScoringJob:
    """Make a job in the process that has imported the user's own modules: others do not know their folders."""
    folders = dict.fromkeys(folder for variant in variants for folder in import_folders(variant.config))
    return ScoringJob(suite, protocol, variants, tuple(folders), stop_on_fault)


def experiment_job(experiment: Experiment) -> ScoringJob:
    """Make the job of an experiment."""
    config = experiment.config
    protocol = HeldOutProtocol(config.fixes, config.seed)
    suite = replace(experiment.suite, metrics=experiment.metrics)
    return scoring_job(suite, protocol, _grouped_by_front_end(experiment.variants))


def preload(job: ScoringJob) -> None:
    """Import what is imported at first use, so that the first walk's CPU time does not include it."""
    with importable(job.import_folders):
        if any(
            variant.config.estimator.make().spec.needs_gtsam
            for variant in job.variants
            if variant.track_files is None
        ):
            from pdr_est.estimators.factor_graph import smoother as factor_graph  # noqa: F401


def score_walk(job: ScoringJob, walk: Walk) -> WalkResult:
    """Score one walk; whatever goes wrong with it is a failure in the result, unless `stop_on_fault` is set.

    It runs in one thread: parallel sums are rounded differently from machine to machine, and processes share cores.
    """
    with threadpool_limits(1), importable(job.import_folders):
        started = time.process_time()
        try:
            result = _score(job, walk)
        except Exception as error:  # a programming error must not cost the other walks of an experiment
            if job.stop_on_fault and (isinstance(error, ConfigError) or not isinstance(error, PdrError)):
                error.add_note(f"in the walk {walk.name}")
                raise
            reason = str(error) if isinstance(error, PdrError) else f"{type(error).__name__}: {error}"
            result = WalkResult.failed(walk.name, reason)
        return replace(result, work_s=time.process_time() - started)


def _score(job: ScoringJob, walk: Walk) -> WalkResult:
    tracks: list[TrackOutcome] = []
    cases: list[CalibrationCase | None] = []
    reasons: list[str] = []
    seconds: dict[str, float] = {}
    protocol = replace(job.protocol, walk=walk.name)
    variants = _for_walker(job.variants, walk.walker_height_m(job.suite))
    for scored in score_variants(job.suite, walk.recording(job.suite), variants, protocol, _plan(job, walk)):
        tracks += track_outcomes(scored, walk.name, walk.labels, job.suite.metrics)
        cases += [of_track.calibration for of_track in scored.scores]
        reasons += scored.reasons
        seconds[scored.variant.name] = scored.walk.seconds
    # A reason that depends neither on the variant nor on the track is given once.
    failures = tuple(Failure(walk.name, reason, whole=not tracks) for reason in dict.fromkeys(reasons))
    return WalkResult(walk.name, tuple(tracks), failures, seconds, calibration_cases=tuple(cases))


def _plan(job: ScoringJob, walk: Walk) -> FloorPlan | str:
    """Read the floor plan of a walk; return the reason why there is none if it cannot be used."""
    if not set(PLAN_METRICS) & set(job.suite.metrics):
        return NO_PLAN
    try:
        return walk.floor_plan(job.suite) or NO_PLAN
    except FloorPlanError as error:
        return str(error)


def _for_walker(variants: Sequence[Variant], height_m: float | None) -> Sequence[Variant]:
    """Give the walker of all variants a height, where it is known."""
    if height_m is None:
        return variants
    return [
        replace(variant, config=replace(variant.config, walker=replace(variant.config.walker, height_m=height_m)))
        for variant in variants
    ]


def _grouped_by_front_end(variants: Sequence[Variant]) -> tuple[Variant, ...]:
    groups: list[list[Variant]] = []
    for variant in variants:
        group = next((group for group in groups if same_front_end(group[0].config, variant.config)), None)
        if group is None:
            groups.append([variant])
        else:
            group.append(variant)
    return tuple(variant for group in groups for variant in group)
