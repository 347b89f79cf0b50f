"""Indoor Location Competition 2.0: phones held flat, waypoints clicked on the floor map about every 10 m."""

from pathlib import Path

from pdr_est.evaluate.position_errors import LEG_METRICS, OPEN_METRICS
from pdr_est.experiment.analysed_walk import AnalysedWalk
from pdr_est.experiment.recording_files import recordings
from pdr_est.experiment.scoring.known_start import START_METRICS, start_part
from pdr_est.experiment.scoring.positions import HELDOUT_METRICS, leg_part, position_parts, true_positions
from pdr_est.experiment.scoring.profiles import PROFILE_METRICS, uppermost_folder
from pdr_est.experiment.scoring.track_scores import MODE_METRIC, MetricPart, mode_truth, score_tracks
from pdr_est.experiment.suite import Suite, TrackScores, WalkFile
from pdr_est.frames import Array
from pdr_est.types.steps import CarryingMode
from pdr_est.types.track import Track


def _find(folder: Path) -> list[WalkFile]:
    """List the logs `SITE/FLOOR/*.txt`."""
    held = mode_truth(CarryingMode.HOLDING)
    return [WalkFile(name, path, truth=held) for name, path in recordings(folder, "*.txt")]


def _score(walk: AnalysedWalk) -> list[TrackScores]:
    """Score the track at the waypoints, without fixes, with some of the waypoints as fixes, and with its start."""
    truth = true_positions(walk.recording)

    def parts(name: str, _step_s: Array, track: Track) -> list[MetricPart]:
        positions = position_parts(walk, name, track, truth)
        return [*positions, leg_part(walk, name, track, truth), start_part(walk, name, truth)]

    return score_tracks(walk, parts)


SUITE = Suite(
    name="ilc20",
    folder="ilc20",
    metrics=(*OPEN_METRICS, *LEG_METRICS, *HELDOUT_METRICS, *PROFILE_METRICS, *START_METRICS, MODE_METRIC),
    find=_find,
    score=_score,
    fixes="heldout",
    calibrated=PROFILE_METRICS,
    profile_group=uppermost_folder,
)
