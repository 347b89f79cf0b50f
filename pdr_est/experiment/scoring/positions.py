"""Scores of tracks against true positions."""

import numpy as np

from pdr_est.errors import RecordingError
from pdr_est.evaluate.held_out_fixes import LEAST_POINTS as LEAST_WAYPOINTS
from pdr_est.evaluate.position_errors import LEAST_POINTS, LEG_METRICS, leg_metrics, open_metrics, point_errors
from pdr_est.evaluate.time_association import Association, associate
from pdr_est.evaluate.trajectories.scores import consistency_metrics
from pdr_est.experiment.analysed_walk import AnalysedWalk
from pdr_est.experiment.held_out import HeldOut
from pdr_est.experiment.scoring.profiles import profile_part
from pdr_est.experiment.scoring.track_scores import MetricPart, score_tracks
from pdr_est.experiment.suite import TrackScores
from pdr_est.types.ground_truth import TruePositions
from pdr_est.types.recording import Recording
from pdr_est.types.track import Track

HELDOUT_METRICS = ("error_heldout_m", "coverage95", "nees_mean")

_NO_COVARIANCE = "the track has no covariance: it was read from a file, and at most moved and turned to fit the fixes"


def score_positions(walk: AnalysedWalk) -> list[TrackScores]:
    """Score each device, and the person who carries several, at the true positions.

    Each gets `OPEN_METRICS` from the sensors alone, `HELDOUT_METRICS` if fixes are given, and each device
    `mode_accuracy`. With fewer than five true positions the held-out metrics are missing.

    Raises
    ------
    RecordingError
        If fewer than two true positions lie within the recording.
    """
    truth = true_positions(walk.recording)
    return score_tracks(walk, lambda name, _, track: position_parts(walk, name, track, truth))


def true_positions(recording: Recording) -> TruePositions:
    """Return the true positions of a recording.

    Raises
    ------
    RecordingError
        If there is none.
    """
    truth = recording.truth.positions
    if truth is None or not len(truth.time_s):
        raise RecordingError(f"{recording.name}: no true positions: nothing to score the track against")
    return truth


def position_parts(walk: AnalysedWalk, name: str, track: Track, truth: TruePositions) -> list[MetricPart]:
    """Compute the metrics of one device, or of the person, at the true positions.

    Parameters
    ----------
    walk : AnalysedWalk
        The walk.
    name : str
        The device, or "fused".
    track : Track
        Track of all devices from the sensors alone.
    truth : TruePositions
        At least one true position.

    Raises
    ------
    RecordingError
        If fewer than two true positions lie within the recording.
    """
    own, held_out = track.of_device(name), walk.held_out
    pairs = associate(own, truth.time_s, truth.position_m, walk.span_of(name))
    if len(pairs) < LEAST_POINTS:
        raise RecordingError(
            f"{walk.recording.name}: {len(pairs)} of {len(truth.time_s)} truth points within the recording of "
            f"{name}: at least {LEAST_POINTS} are needed, on the clock of the recording"
        )
    counts = {"truth_points": len(pairs), "truth_points_not_scored": pairs.not_scored}
    open_part = MetricPart(open_metrics(own, pairs, truth.source), counts)
    if held_out is None:
        return [open_part]
    learning = [profile_part(walk, name, pairs, held_out, open_part.values["length_ratio"])] if walk.learns else []
    return [open_part, _held_out_part(walk, name, pairs, held_out), *learning]


def leg_part(walk: AnalysedWalk, name: str, track: Track, truth: TruePositions) -> MetricPart:
    """Compute `LEG_METRICS` of one device, or of the person, between successive true positions.

    The parameters are those of `position_parts`, which refuses a walk with fewer than two true positions.
    """
    pairs = associate(track.of_device(name), truth.time_s, truth.position_m, walk.span_of(name))
    in_order = np.argsort(pairs.time_s, kind="stable")
    values, counts = leg_metrics(pairs.track_m[in_order], pairs.truth_m[in_order])
    missing = {name: "no leg long enough for the turn of the next one" for name in LEG_METRICS if name not in values}
    return MetricPart(values, counts, missing)


def _held_out_part(walk: AnalysedWalk, name: str, pairs: Association, held_out: HeldOut) -> MetricPart:
    """Compute the metrics at the held-out points of the track that was given the others as fixes."""
    given = held_out.given(pairs)
    if len(held_out.waypoints(pairs)) < LEAST_WAYPOINTS or given.all():
        return MetricPart(missing=dict.fromkeys(HELDOUT_METRICS, f"fewer than {LEAST_WAYPOINTS} truth points"))
    track = walk.track_with_fixes(name, held_out.fixes(pairs))
    held = associate(track, pairs.time_s[~given], pairs.truth_m[~given], walk.span_of(name))
    error_m = float(point_errors(held.track_m, held.truth_m).mean())
    consistency, reason = consistency_metrics(held, held_out.truth_sigma_m)
    missing = dict.fromkeys(HELDOUT_METRICS[1:], _NO_COVARIANCE) if reason else {}
    return MetricPart({"error_heldout_m": error_m, **consistency}, missing=missing)
