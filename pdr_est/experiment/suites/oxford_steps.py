"""Oxford step counting: phones with an accelerometer only, in many positions, with annotated foot contacts.

A folder `PHONE_PERSON_FLOOR_POSITION_NUMBER` is one walk.
"""

from pathlib import Path

from pdr_est.errors import RecordingError
from pdr_est.evaluate.step_detection import STEP_METRICS
from pdr_est.experiment.analysed_walk import AnalysedWalk
from pdr_est.experiment.recording_files import recordings
from pdr_est.experiment.scoring.annotated_steps import step_part
from pdr_est.experiment.scoring.track_scores import device_scores, step_times_s
from pdr_est.experiment.suite import Suite, TrackScores, WalkFile

_SAMPLES, _STEPS = "accelerometer.csv", "stepcounter.csv"
_LABELS = ("phone", "person", "floor", "position")


def _find(folder: Path) -> list[WalkFile]:
    """List the folders with an accelerometer.csv. Raises RecordingError if there are only annotated steps."""
    walks = [_walk(Path(name).parent.as_posix(), path.parent) for name, path in recordings(folder, _SAMPLES)]
    steps = recordings(folder, _STEPS)
    if steps and not walks:
        raise RecordingError(
            f"{steps[0][1].parent}: no {_SAMPLES} beside {_STEPS}: put the samples of the walk there"
        )
    return walks


def _score(walk: AnalysedWalk) -> list[TrackScores]:
    """Score the steps; without a gyroscope there are no headings, and no estimator runs."""
    return [device_scores(walk, device, step_part(walk, step_times_s(device))) for device in walk.devices]


def _walk(name: str, path: Path) -> WalkFile:
    labels = labels_of(path.name)
    return WalkFile(name=name, path=path, labels=labels, group=labels["position"])


def labels_of(folder_name: str) -> dict[str, str | None]:
    """Read phone, person, floor and position from the folder name of a walk; None for other names."""
    *words, _number = folder_name.split("_")
    if len(words) != len(_LABELS):
        return dict.fromkeys(_LABELS)
    return dict(zip(_LABELS, words, strict=True))


SUITE = Suite(
    name="oxford-steps",
    folder="oxford-steps",
    metrics=STEP_METRICS,
    find=_find,
    score=_score,
)
