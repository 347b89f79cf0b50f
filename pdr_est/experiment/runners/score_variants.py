"""Analysis, estimation and scoring of one recording with several variants."""

import math
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from pdr_est import pipeline
from pdr_est.config import Config
from pdr_est.errors import EstimationError, RecordingError
from pdr_est.experiment.analysed_walk import NO_PLAN, AnalysedWalk
from pdr_est.experiment.held_out import HeldOutProtocol
from pdr_est.experiment.scoring.foreign_tracks import foreign_walk, score_foreign
from pdr_est.experiment.suite import Suite, TrackScores
from pdr_est.experiment.variants.axes import Variant, same_front_end
from pdr_est.pipeline import DeviceWalk
from pdr_est.types.floor_plan import FloorPlan
from pdr_est.types.recording import Recording


@dataclass(frozen=True)
class ScoredVariant:
    """A walk after one variant.

    Attributes
    ----------
    variant : Variant
        The settings.
    walk : AnalysedWalk
        The analysed walk with its tracks.
    scores : tuple of TrackScores
        Scores of each track; none if the front end or the estimator failed.
    reasons : tuple of str
        Missing metrics and why they are missing.
    """

    variant: Variant
    walk: AnalysedWalk
    scores: tuple[TrackScores, ...]
    reasons: tuple[str, ...]


def score_variants(
    suite: Suite,
    recording: Recording,
    variants: Sequence[Variant],
    protocol: HeldOutProtocol,
    plan: FloorPlan | str = NO_PLAN,
) -> Iterator[ScoredVariant]:
    """Analyse, estimate and score a recording with one variant after the other.

    If only one of several front ends cannot use the recording (a heading by a magnetometer that does not exist), or
    an estimator fails, that is a reason in the result. plan: floor plan of the walk, or the reason why there is none.

    Raises
    ------
    RecordingError
        If the recording cannot be used by a front end that all variants share, or cannot be scored.
    """
    estimated = [variant for variant in variants if variant.track_files is None]
    for variant, devices, seconds in _analysed(recording, estimated):
        if isinstance(devices, RecordingError):
            if all(same_front_end(variant.config, other.config) for other in estimated):
                raise devices
            walk = AnalysedWalk(recording, (), variant.config)
            yield ScoredVariant(variant, walk, (), (f"{variant.name}: {devices}",))
            continue
        learns = suite.profile_group is not None
        walk = AnalysedWalk(recording, devices, variant.config, seconds, protocol, learns, plan)
        try:
            scores = suite.score(walk)
        except EstimationError as error:
            yield ScoredVariant(variant, walk, (), (f"{variant.name}: {error}",))
            continue
        reasons = tuple(reason for of_track in scores for reason in missing_reasons(suite, of_track))
        yield ScoredVariant(variant, walk, tuple(scores), reasons)
    for variant in variants:
        if variant.track_files is not None:
            yield _score_file(suite, recording, variant, protocol)


def _score_file(suite: Suite, recording: Recording, variant: Variant, protocol: HeldOutProtocol) -> ScoredVariant:
    """Score the track of another program; a file that is missing or does not fit is a reason in the result."""
    try:
        walk = foreign_walk(variant.track_file(protocol.walk), recording, protocol)
        scores = score_foreign(walk, suite)
    except RecordingError as error:
        none = AnalysedWalk(recording, (), variant.config)
        return ScoredVariant(variant, none, (), (f"{variant.name}: {error}",))
    found = [f"{variant.name}: {reason}" for of_track in scores for reason in missing_reasons(suite, of_track)]
    return ScoredVariant(variant, walk, tuple(scores), tuple(dict.fromkeys(found)))


def missing_reasons(suite: Suite, scores: TrackScores) -> list[str]:
    """Say why metrics of a track are missing, with one sentence for all metrics of the same reason."""
    by_reason: dict[str, list[str]] = {}
    for metric in suite.metrics:
        applies = metric in scores.values or metric in scores.missing
        if applies and not math.isfinite(scores.values.get(metric, math.nan)):
            by_reason.setdefault(scores.missing.get(metric, "not a finite number"), []).append(metric)
    return [f"{', '.join(metrics)}: {reason}" for reason, metrics in by_reason.items()]


def _analysed(
    recording: Recording, variants: Sequence[Variant]
) -> Iterator[tuple[Variant, tuple[DeviceWalk, ...] | RecordingError, float]]:
    """Yield each variant with the result of its front end and the CPU time; adjacent equal front ends run once."""
    before: Config | None = None
    for variant in variants:
        if before is None or not same_front_end(before, variant.config):
            before, started = variant.config, time.process_time()
            devices = _analyse(recording, variant.config)
            seconds = time.process_time() - started
        yield variant, devices, seconds


def _analyse(recording: Recording, config: Config) -> tuple[DeviceWalk, ...] | RecordingError:
    try:
        return pipeline.analyse_recording(recording, config)
    except RecordingError as error:
        return error
