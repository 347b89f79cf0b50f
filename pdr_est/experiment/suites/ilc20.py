"""Indoor Location Competition 2.0: phones held flat, waypoints clicked on the floor map about every 10 m."""

from pathlib import Path

from pdr_est.evaluate.position_errors import LEG_METRICS, OPEN_METRICS
from pdr_est.experiment.analysed_walk import AnalysedWalk
from pdr_est.experiment.recording_files import recordings
from pdr_est.experiment.scoring.known_plan import PLAN_METRICS, plan_part
from pdr_est.experiment.scoring.known_start import START_METRICS, start_part
from pdr_est.experiment.scoring.positions import HELDOUT_METRICS, leg_part, position_parts, true_positions
from pdr_est.experiment.scoring.profiles import PROFILE_METRICS, uppermost_folder
from pdr_est.experiment.scoring.track_scores import MODE_METRIC, MetricPart, mode_truth, score_tracks
from pdr_est.experiment.suite import Suite, TrackScores, WalkFile
from pdr_est.frames import Array
from pdr_est.io.floor_plans.competition_map import MAP
from pdr_est.io.floor_plans.reading import read_floor_plan
from pdr_est.types.floor_plan import FloorPlan
from pdr_est.types.steps import CarryingMode
from pdr_est.types.track import Track


def _find(folder: Path) -> list[WalkFile]:
    """List the logs `SITE/FLOOR/*.txt`."""
    held = mode_truth(CarryingMode.HOLDING)
    return [WalkFile(name, path, truth=held) for name, path in recordings(folder, "*.txt")]


def _score(walk: AnalysedWalk) -> list[TrackScores]:
    """Score the track at the waypoints, without fixes, with some as fixes, with its start, and on the plan."""
    truth = true_positions(walk.recording)

    def parts(name: str, _step_s: Array, track: Track) -> list[MetricPart]:
        positions = position_parts(walk, name, track, truth)
        legs = leg_part(walk, name, track, truth)
        return [*positions, legs, start_part(walk, name, truth), plan_part(walk, name, truth)]

    return score_tracks(walk, parts)


def _plan(path: Path) -> FloorPlan | None:
    """Read the map of the floor that a recording lies beside; None if it is not there."""
    maps = [path.parent / f"{MAP}{ending}" for ending in ("", ".gz")]
    return next((read_floor_plan(one) for one in maps if one.is_file()), None)


SUITE = Suite(
    name="ilc20",
    folder="ilc20",
    metrics=(
        *OPEN_METRICS,
        *LEG_METRICS,
        *HELDOUT_METRICS,
        *PROFILE_METRICS,
        *START_METRICS,
        *PLAN_METRICS,
        MODE_METRIC,
    ),
    find=_find,
    score=_score,
    plan_beside=_plan,
    fixes="heldout",
    calibrated=PROFILE_METRICS,
    profile_group=uppermost_folder,
)
