"""The work on one walk: read or simulate it, run every variant, score, and keep what the results need."""

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace

from threadpoolctl import threadpool_limits

from pdr_est.config import import_folders
from pdr_est.errors import PdrError
from pdr_est.experiment.loader import Experiment
from pdr_est.experiment.runners.score_walk import score_variants, warm_up
from pdr_est.experiment.runners.track_outcome import outcomes_of
from pdr_est.experiment.runners.walk_result import Failure, WalkResult, encode
from pdr_est.experiment.scoring.any_recording import HeldOutProtocol, judged
from pdr_est.experiment.suite import Suite
from pdr_est.experiment.suites import suite_named
from pdr_est.experiment.variants.axes import Variant, same_front_end
from pdr_est.experiment.walks import Walk
from pdr_est.parts import importable
from pdr_est.types.outcome import TrackOutcome


@dataclass(frozen=True)
class Work:
    """What has to be done with every walk; goes to other processes and machines. Variants that share a front end
    stand in a row. import_folders: of the modules that the variants name for parts from outside the package."""

    suite: str | None
    judge: HeldOutProtocol
    variants: tuple[Variant, ...]
    metrics: tuple[str, ...]
    import_folders: tuple[str, ...] = ()


def work_of(experiment: Experiment) -> Work:
    """The work of an experiment."""
    config = experiment.config
    variants = _front_ends_in_a_row(experiment.variants)
    folders = dict.fromkeys(folder for variant in variants for folder in import_folders(variant.config))
    judge = HeldOutProtocol(config.fixes, config.seed)
    return Work(config.data.suite, judge, variants, experiment.metrics, tuple(folders))


def prepare(work: Work) -> None:
    """Load what is loaded at first use, so that the first walk's time does not hold it."""
    with importable(work.import_folders):
        warm_up(any(variant.config.estimator.make().spec.needs_gtsam for variant in work.variants))


def do(work: Work, walk: Walk) -> bytes:
    """The encoded part of one walk. Whatever goes wrong with the walk is a failure in there.

    One thread only: parallel sums would round differently from machine to machine, and the processes share the cores.
    """
    with threadpool_limits(1), importable(work.import_folders):
        started = time.process_time()
        try:
            part = _part(work, walk)
            return encode(replace(part, work_s=time.process_time() - started))
        except PdrError as error:
            reason = str(error)
        except Exception as error:  # a fault of ours in one walk must not cost the others
            reason = f"{type(error).__name__}: {error}"
        failure = Failure(walk.name, reason, whole=True)
        return encode(WalkResult(walk.name, failures=(failure,), work_s=time.process_time() - started))


def _part(work: Work, walk: Walk) -> WalkResult:
    judge = replace(work.judge, walk=walk.name)
    suite: Suite = judged(None if work.suite is None else suite_named(work.suite), judge)
    suite = replace(suite, metrics=work.metrics)
    tracks: list[TrackOutcome] = []
    reasons: list[str] = []
    seconds: dict[str, float] = {}
    for scored in score_variants(suite, walk.recording(suite), work.variants):
        tracks += list(outcomes_of(scored, walk.name, walk.labels, work.metrics, judge)) if scored.scores else []
        reasons += scored.reasons
        seconds[scored.variant.name] = scored.walk.seconds
    return WalkResult(
        walk=walk.name,
        tracks=tuple(tracks),
        failures=tuple(Failure(walk.name, reason, whole=not tracks) for reason in dict.fromkeys(reasons)),
        seconds=seconds,
    )


def _front_ends_in_a_row(variants: Sequence[Variant]) -> tuple[Variant, ...]:
    rows: list[list[Variant]] = []
    for variant in variants:
        row = next((row for row in rows if same_front_end(row[0].config, variant.config)), None)
        if row is None:
            rows.append([variant])
        else:
            row.append(variant)
    return tuple(variant for row in rows for variant in row)
