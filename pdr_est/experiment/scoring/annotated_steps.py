"""Scores of steps and headings against annotated steps and turns."""

from pdr_est.errors import RecordingError
from pdr_est.evaluate.heading_errors import HEADING_METRICS, heading_net_error_deg, turn_error_deg
from pdr_est.evaluate.step_detection import score_steps
from pdr_est.experiment.analysed_walk import AnalysedWalk
from pdr_est.experiment.scoring.track_scores import MetricPart
from pdr_est.frames import Array
from pdr_est.types.ground_truth import TrueSteps
from pdr_est.types.track import Track


def step_part(walk: AnalysedWalk, step_s: Array) -> MetricPart:
    """Compute `STEP_METRICS` over the annotated time span.

    Parameters
    ----------
    walk : AnalysedWalk
        The walk.
    step_s : ndarray
        Times (n,) of the detected steps, s.

    Raises
    ------
    RecordingError
        If no step is annotated.
    """
    score = score_steps(step_s, _true_steps(walk).time_s)
    return MetricPart(
        values=score.values(),
        counts={"true_steps": score.true, "detected_steps": score.detected, "matched_steps": score.matched},
        missing={} if score.detected else {"step_precision": "no step found"},
    )


def heading_part(walk: AnalysedWalk, track: Track) -> MetricPart:
    """Compute `HEADING_METRICS` of the track of one device; they are missing if no turn is annotated."""
    turns, steps_s = walk.recording.truth.turns, _true_steps(walk).time_s
    if turns is None or not len(turns.time_s):
        return MetricPart(missing=dict.fromkeys(HEADING_METRICS, "no annotated turn"))
    values = (
        turn_error_deg(track, turns.time_s, turns.angle_rad),
        heading_net_error_deg(track, float(steps_s[0]), float(steps_s[-1]), turns.angle_rad),
    )
    return MetricPart(dict(zip(HEADING_METRICS, values, strict=True)), {"true_turns": len(turns.time_s)})


def _true_steps(walk: AnalysedWalk) -> TrueSteps:
    steps = walk.recording.truth.steps
    if steps is None or not len(steps.time_s):
        raise RecordingError(f"{walk.recording.name}: no annotated step: nothing to compare the detected ones with")
    return steps
