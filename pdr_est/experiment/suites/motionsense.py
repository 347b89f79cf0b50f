"""MotionSense: an iPhone in the front trouser pocket, one activity a file, no step annotated.

The carrying mode is scored where people walk, jog or climb stairs, false steps where they stand or sit. The summary
averages walking and jogging; stairs are averaged apart.
"""

import re
from pathlib import Path

from pdr_est.evaluate.step_detection import FALSE_STEPS_METRIC, steps_per_minute
from pdr_est.experiment.analysed_walk import AnalysedWalk
from pdr_est.experiment.recording_files import recordings
from pdr_est.experiment.scoring.track_scores import MODE_METRIC, MetricPart, device_scores, mode_part, mode_truth
from pdr_est.experiment.suite import Suite, TrackScores, WalkFile
from pdr_est.pipeline import DeviceWalk
from pdr_est.types.steps import CarryingMode

_ACTIVITY = re.compile(r"(wlk|jog|ups|dws|std|sit)_\d+")
_APART = ("ups", "dws")
_RESTING = ("standing", "sitting")


def _find(folder: Path) -> list[WalkFile]:
    """List the tables `ACTIVITY_N/sub_S.csv` of the six activities."""
    walks = []
    for name, path in recordings(folder, "sub_*.csv"):
        match = _ACTIVITY.fullmatch(path.parent.name)
        if match is not None:
            walks.append(_walk(name, path, match.group(1)))
    return walks


def _score(walk: AnalysedWalk) -> list[TrackScores]:
    """Score the mode of people who move and the false steps of people who rest; no estimator runs."""
    resting = walk.recording.truth.activity in _RESTING
    parts = [_false_steps_part(device) if resting else mode_part(walk, device) for device in walk.devices]
    return [device_scores(walk, device, part) for device, part in zip(walk.devices, parts, strict=True)]


def _false_steps_part(device: DeviceWalk) -> MetricPart:
    return MetricPart({FALSE_STEPS_METRIC: steps_per_minute(len(device.steps), device.span_s)})


def _walk(name: str, path: Path, activity: str) -> WalkFile:
    return WalkFile(
        name=name,
        path=path,
        labels={"activity": activity},
        group=activity,
        headline=activity not in _APART,
        truth=mode_truth(CarryingMode.POCKET),
    )


SUITE = Suite(
    name="motionsense",
    folder="motionsense",
    metrics=(MODE_METRIC, FALSE_STEPS_METRIC),
    find=_find,
    score=_score,
)
