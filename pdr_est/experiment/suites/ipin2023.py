"""IPIN 2023 competition, track 3, training logs: held phones, surveyed points marked while walking over them.

Errors are 2-D also where a walk changes floors.
"""

from pathlib import Path

from pdr_est.errors import RecordingError
from pdr_est.evaluate.position_errors import OPEN_METRICS
from pdr_est.experiment.analysed_walk import AnalysedWalk
from pdr_est.experiment.recording_files import recordings
from pdr_est.experiment.scoring.gps_positions import GPS_METRICS, gps_part
from pdr_est.experiment.scoring.known_start import START_METRICS, start_part
from pdr_est.experiment.scoring.positions import HELDOUT_METRICS, position_parts
from pdr_est.experiment.scoring.track_scores import MODE_METRIC, mode_truth, score_tracks
from pdr_est.experiment.suite import Suite, TrackScores, WalkFile
from pdr_est.preprocessing.trim import trim_recording
from pdr_est.types.ground_truth import TruePositions
from pdr_est.types.recording import Recording
from pdr_est.types.steps import CarryingMode


def _find(folder: Path) -> list[WalkFile]:
    """List the logs `*.txt`."""
    held = mode_truth(CarryingMode.HOLDING)
    return [WalkFile(name, path, truth=held) for name, path in recordings(folder, "*.txt")]


def _score(walk: AnalysedWalk) -> list[TrackScores]:
    """Score the track at the surveyed points: without fixes, with some points as fixes, with GPS, with its start."""
    truth = surveyed_points(walk.recording)
    return score_tracks(
        walk,
        lambda name, _, track: [
            *position_parts(walk, name, track, truth),
            gps_part(walk, name, truth),
            start_part(walk, name, truth),
        ],
    )


def surveyed_points(recording: Recording) -> TruePositions:
    """Return the surveyed points.

    Raises
    ------
    RecordingError
        If there is none.
    """
    positions = recording.truth.positions
    if positions is None or not len(positions.time_s):
        raise RecordingError(f"{recording.name}: no surveyed point (POSI): nothing to score the track against")
    return positions


def from_first_point(recording: Recording) -> Recording:
    """Cut off what is before the first surveyed point, where the phones are shaken for a minute to calibrate them.

    Raises
    ------
    RecordingError
        If there is no surveyed point.
    """
    return trim_recording(recording, float(surveyed_points(recording).time_s.min()))


SUITE = Suite(
    name="ipin2023",
    folder="ipin2023",
    metrics=(*OPEN_METRICS, *HELDOUT_METRICS, *GPS_METRICS, *START_METRICS, MODE_METRIC),
    find=_find,
    prepare=from_first_point,
    score=_score,
    fixes="heldout",
)
