"""Suite of an experiment: a benchmark suite with other fixes, or the ground truth that recordings bring along."""

from dataclasses import replace
from functools import partial
from pathlib import Path

from pdr_est.evaluate.heading_errors import HEADING_METRICS
from pdr_est.evaluate.position_errors import OPEN_METRICS
from pdr_est.evaluate.step_detection import STEP_METRICS
from pdr_est.experiment.analysed_walk import AnalysedWalk
from pdr_est.experiment.config import FixesProtocol
from pdr_est.experiment.scoring.annotated_steps import heading_part, step_part
from pdr_est.experiment.scoring.positions import HELDOUT_METRICS, position_parts
from pdr_est.experiment.scoring.track_scores import MODE_METRIC, MetricPart, score_tracks
from pdr_est.experiment.suite import Suite, TrackScores, WalkFile
from pdr_est.frames import Array
from pdr_est.types.track import Track

_NO_POSITIONS, _NO_STEPS = "the true positions are not known", "no annotated step"


def experiment_suite(suite: Suite | None, fixes: FixesProtocol) -> Suite:
    """Adapt a suite to the fixes of an experiment.

    Metrics after a calibration on other walks are left out, because an experiment works on each walk alone.

    Parameters
    ----------
    suite : Suite or None
        Benchmark suite; None for simulated walks and recordings that bring their own ground truth.
    fixes : "none", "heldout" or "every"
        Protocol of the experiment.
    """
    held_out = () if fixes == "none" else HELDOUT_METRICS
    if suite is None:
        metrics = (*OPEN_METRICS, *held_out, MODE_METRIC, *STEP_METRICS, *HEADING_METRICS)
        return Suite("recordings", ".", metrics, _no_walks, _score_known_truth)
    metrics = tuple(name for name in suite.metrics if name not in suite.calibrated)
    if suite.fixes is not None:
        open_metrics = tuple(name for name in metrics if name in OPEN_METRICS)
        others = tuple(name for name in metrics if name not in (*OPEN_METRICS, *HELDOUT_METRICS))
        metrics = (*open_metrics, *held_out, *others)
    return replace(suite, metrics=metrics, calibrated_on=0, calibrated=(), profile_group=None)


def _score_known_truth(walk: AnalysedWalk) -> list[TrackScores]:
    """Compute every metric that the ground truth allows, for each device and the person who carries several."""
    return score_tracks(walk, partial(_known_parts, walk))


def _known_parts(walk: AnalysedWalk, name: str, step_s: Array, track: Track) -> list[MetricPart]:
    """Score one device, or the person, with steps at step_s (n,); track: all devices, from the sensors alone."""
    truth = walk.recording.truth
    parts: list[MetricPart] = []
    if truth.positions is None or not len(truth.positions.time_s):
        parts.append(MetricPart(missing=dict.fromkeys((*OPEN_METRICS, *HELDOUT_METRICS), _NO_POSITIONS)))
    else:
        parts += position_parts(walk, name, track, truth.positions)
    if truth.steps is None or not len(truth.steps.time_s):
        parts.append(MetricPart(missing=dict.fromkeys((*STEP_METRICS, *HEADING_METRICS), _NO_STEPS)))
    else:
        parts += [step_part(walk, step_s), heading_part(walk, track.of_device(name))]
    return parts


def _no_walks(_folder: Path) -> list[WalkFile]:
    return []
