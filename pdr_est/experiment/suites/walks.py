"""Surveyed walks of anybody: recordings `NAME.csv` with the ground truth in files beside them.

`io.side_tables.surveyed_walks` says what `NAME.truth.csv` and `NAME.json` may hold. A walk is scored by whatever
there is: positions, steps, the carrying mode, the speed of a treadmill. Walks of one subfolder are one group.

* With true positions: the errors of the track from the sensors alone, `heading_rms_deg` where the positions are dense
  enough for directions of travel, and the held-out metrics. Of recorded poses, one for every 5 m of way stands for a
  waypoint (`held_out.POSES_APART_M`); as they have no error, the fixes get one of 0.7 m.
  `PROFILE_METRICS` say what the other walks of the person teach about the length of these.
* With `step_ends_s`: `count_error`, `steps_missed` and `steps_extra` within the annotated spans; with `steps_true`
  alone, `count_error` of the whole recording.
* With `speed_mps`: `speed_ratio`, the length of the track per duration of the recording over that speed.

A walker whose `height_m` is given gets it in all variants, in place of `walker.height_m`.
"""

from functools import partial
from pathlib import Path

from pdr_est.errors import RecordingError
from pdr_est.evaluate.heading_errors import LEAST_TRAVEL_LEGS, TRAVEL_METRIC, travel_direction_rms_deg
from pdr_est.evaluate.position_errors import OPEN_METRICS, length_between
from pdr_est.evaluate.step_detection import SPAN_METRICS, TOLERANCE_S, count_error, score_annotated_spans
from pdr_est.evaluate.time_association import associate
from pdr_est.experiment.analysed_walk import AnalysedWalk
from pdr_est.experiment.recording_files import recordings
from pdr_est.experiment.scoring.positions import HELDOUT_METRICS, position_parts
from pdr_est.experiment.scoring.profiles import PROFILE_METRICS, person_or_folder
from pdr_est.experiment.scoring.track_scores import (
    MODE_METRIC,
    MetricPart,
    device_scores,
    mode_part,
    score_tracks,
    step_times_s,
)
from pdr_est.experiment.suite import Suite, TrackScores, WalkFile
from pdr_est.frames import Array
from pdr_est.io.side_tables.surveyed_walks import (
    TRUTH_SUFFIX,
    read_truth_beside,
    walk_description,
    walker_height_beside,
)
from pdr_est.pipeline import DeviceWalk
from pdr_est.types.ground_truth import TruePositions, Truth
from pdr_est.types.steps import CarryingMode
from pdr_est.types.track import Track

SPEED_METRIC = "speed_ratio"

_LABELS = ("carrying", "person")
_POSITION_METRICS = (*OPEN_METRICS, TRAVEL_METRIC, *HELDOUT_METRICS)
_NO_GYROSCOPE = "no gyroscope, so that the steps have no direction"


def _find(folder: Path) -> list[WalkFile]:
    """List the recordings `*.csv` and `*.zip` at any depth."""
    found = dict(recordings(folder, "*.zip")) | dict(recordings(folder, "*.csv"))
    truth = TRUTH_SUFFIX.removesuffix(".csv")
    return [_walk(name, path) for name, path in sorted(found.items()) if not name.endswith(truth)]


def _walk(name: str, path: Path) -> WalkFile:
    described = walk_description(path)
    labels = {label: described.get(label) for label in _LABELS}
    return WalkFile(name, path, labels, group=name.rpartition("/")[0] or None)


def _score(walk: AnalysedWalk) -> list[TrackScores]:
    """Score the walk by the ground truth that there is; the estimator runs where that needs a track.

    Raises
    ------
    RecordingError
        If there is none.
    """
    truth = walk.recording.truth
    if all(part is None for part in (truth.positions, truth.steps, truth.step_count, truth.modes, truth.speed_mps)):
        raise RecordingError(
            f"{walk.recording.name}: no ground truth beside it: put NAME{TRUTH_SUFFIX} with time_s,x_m,y_m there, or "
            "NAME.json with steps_true, step_ends_s, mode_true or speed_mps"
        )
    has_heading = all(device.has_heading for device in walk.devices)
    if has_heading and (truth.positions is not None or truth.speed_mps is not None):
        return score_tracks(walk, partial(_parts, walk), with_modes=truth.modes is not None)
    without_track = MetricPart(missing=dict.fromkeys(_track_metrics(truth), _NO_GYROSCOPE))
    return [
        device_scores(
            walk,
            device,
            without_track,
            _step_part(walk, device.device, step_times_s(device)),
            _mode_part(walk, device),
        )
        for device in walk.devices
    ]


def _mode_part(walk: AnalysedWalk, device: DeviceWalk) -> MetricPart:
    """Compute `mode_accuracy` where the true mode is known; modes are recognised by rotation."""
    if walk.recording.truth.modes is None:
        return MetricPart()
    if all(step.event.mode is CarryingMode.UNKNOWN for step in device.steps) and not device.has_heading:
        return MetricPart(missing={MODE_METRIC: "no gyroscope, so that the carrying mode is not recognised"})
    return mode_part(walk, device)


def _track_metrics(truth: Truth) -> tuple[str, ...]:
    """List the metrics of a track that the ground truth allows."""
    of_positions = () if truth.positions is None else _POSITION_METRICS
    return of_positions if truth.speed_mps is None else (*of_positions, SPEED_METRIC)


def _parts(walk: AnalysedWalk, name: str, step_s: Array, track: Track) -> list[MetricPart]:
    """Score one device, or the person, with steps at step_s (n,); track: all devices, from the sensors alone."""
    truth = walk.recording.truth
    parts = [_step_part(walk, name, step_s)]
    if truth.positions is not None:
        parts += _position_parts(walk, name, track, truth.positions)
    if truth.speed_mps is not None:
        begin_s, end_s = walk.span_of(name)
        length_m = length_between(track.of_device(name), begin_s, end_s)
        parts.append(MetricPart({SPEED_METRIC: length_m / (end_s - begin_s) / truth.speed_mps}))
    return parts


def _position_parts(walk: AnalysedWalk, name: str, track: Track, truth: TruePositions) -> list[MetricPart]:
    """Compute the metrics at the true positions; too few of them leave the other metrics of the walk as they are."""
    try:
        parts = position_parts(walk, name, track, truth)
    except RecordingError as error:
        return [MetricPart(missing=dict.fromkeys(_POSITION_METRICS, str(error)))]
    pairs = associate(track.of_device(name), truth.time_s, truth.position_m, walk.span_of(name))
    rms_deg, legs = travel_direction_rms_deg(pairs.track_m, pairs.truth_m, truth.sigma_m)
    if legs < LEAST_TRAVEL_LEGS:
        reason = f"the true positions give {legs} directions of travel of the {LEAST_TRAVEL_LEGS} that are needed"
        return [*parts, MetricPart(missing={TRAVEL_METRIC: reason})]
    return [*parts, MetricPart({TRAVEL_METRIC: rms_deg}, {"travel_legs": legs})]


def _step_part(walk: AnalysedWalk, name: str, step_s: Array) -> MetricPart:
    """Compare the times (n,), s, of the detected steps with the annotated ones, or their number with the true one.

    Annotations of which most lie outside the recording are on another clock, and are not compared.
    """
    truth = walk.recording.truth
    if truth.steps is not None:
        begin_s, end_s = walk.span_of(name)
        true_s = truth.steps.time_s
        inside = int(((true_s >= begin_s - TOLERANCE_S) & (true_s <= end_s + TOLERANCE_S)).sum())
        if 2 * inside < len(true_s):
            reason = (
                f"{inside} of {len(true_s)} times in step_ends_s lie within the recording of {name}, "
                f"{begin_s:.1f} to {end_s:.1f} s: give them on its clock"
            )
            return MetricPart(missing=dict.fromkeys(SPAN_METRICS, reason))
        score = score_annotated_spans(step_s, truth.steps.time_s)
        counts = {"true_steps": score.true, "detected_steps": score.detected, "matched_steps": score.matched}
        return MetricPart(score.span_values(), counts)
    if truth.step_count is not None:
        counts = {"true_steps": truth.step_count, "detected_steps": len(step_s)}
        return MetricPart({"count_error": count_error(len(step_s), truth.step_count)}, counts)
    return MetricPart()


SUITE = Suite(
    name="walks",
    folder="walks",
    metrics=(*_POSITION_METRICS, *PROFILE_METRICS, *SPAN_METRICS, MODE_METRIC, SPEED_METRIC),
    find=_find,
    score=_score,
    truth_beside=read_truth_beside,
    walker_height=walker_height_beside,
    fixes="heldout",
    calibrated=PROFILE_METRICS,
    profile_group=person_or_folder,
)
