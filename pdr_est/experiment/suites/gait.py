"""MotionSense (phone in the front trouser pocket) and SisFall (box at the belt): the gait of each step.

* `gait_accuracy`: share of steps with the right gait of walking, jogging and running.
* `walking_accuracy`: the same with jogging and running as one gait, on which the labels of both data sets agree: the
  persons of SisFall jogged slowly and quickly as they understood it, MotionSense has jogging of any speed.
* `false_steps_per_min`: detected steps of people who stand or sit.
* `count_plausibility`: detected steps over the number that the spectrum shows (`evaluate.cadence_check`); no step is
  annotated.

Every step of a file has the gait of the file, also when people start, turn or stop. Stairs have no true class; their
rows list the labels. People in the training data of the shipped model are labelled by a model that was trained in
the same way without them (`shipped_folds`), all others by the shipped model. A user's own model labels the people
that are not in its training data; the others have no accuracy. Without any model every gait is unknown.
"""

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pdr_est.evaluate import gait_recognition as gaits
from pdr_est.evaluate.cadence_check import PLAUSIBILITY_METRIC, count_plausibility
from pdr_est.evaluate.step_detection import FALSE_STEPS_METRIC, steps_per_minute
from pdr_est.experiment.analysed_walk import AnalysedWalk
from pdr_est.experiment.recording_files import recordings
from pdr_est.experiment.scoring.track_scores import MetricPart, device_scores
from pdr_est.experiment.suite import ConfusionMatrix, Suite, TrackScores, WalkFile
from pdr_est.front_end.gait import GaitClassifier, gait_model, is_shipped, shipped_folds
from pdr_est.io.formats.datasets import motionsense, sisfall
from pdr_est.pipeline import DeviceWalk
from pdr_est.types.ground_truth import Truth
from pdr_est.types.outcome import TrackOutcome
from pdr_est.types.recording import Recording
from pdr_est.types.steps import Gait, Step

METRICS = (gaits.GAIT_METRIC, gaits.WALKING_METRIC, FALSE_STEPS_METRIC, PLAUSIBILITY_METRIC)
TRUE_CLASS = "true_class"
EVERYWHERE = "all"
"""Name of the confusion matrix over all data sets, beside that of each."""

_MOTIONSENSE, _SISFALL = "motionsense", "sisfall"
_MOTIONSENSE_FILE = re.compile(r"(?P<code>wlk|jog|ups|dws|std|sit)_\d+/sub_(?P<person>\d+)")
_SISFALL_FILE = re.compile(r"(?:.*/)?(?P<code>D0[1-6])_(?P<person>S[AE]\d\d)_R\d\d")
_ACTIVITIES = motionsense.ACTIVITIES | sisfall.ACTIVITIES
_SEEN = "the model of gait.model was trained on this person: train one without the person"
_RESTING = ("standing", "sitting")
_LABELS = {**gaits.KNOWN_BY_NAME, "unknown": Gait.UNKNOWN}


def _find(folder: Path) -> list[WalkFile]:
    """List the tables `motionsense/ACTIVITY_N/sub_S.csv` and `sisfall/PERSON/D0x_PERSON_Rnn.txt`."""
    walks = []
    for data_set, pattern, name_of in (
        (_MOTIONSENSE, "sub_*.csv", _MOTIONSENSE_FILE),
        (_SISFALL, "D0?_S???_R??.txt", _SISFALL_FILE),
    ):
        for name, path in recordings(folder / data_set, pattern):
            match = name_of.fullmatch(name)
            if match is not None:
                walks.append(_walk(f"{data_set}/{name}", path, data_set, match["person"], match["code"]))
    return walks


def _score(walk: AnalysedWalk) -> list[TrackScores]:
    """Score gaits and step counts of people who move, false steps of people who rest; no estimator runs."""
    return [device_scores(walk, device, _part(walk, device)) for device in walk.devices]


def _confusions(rows: Sequence[TrackOutcome]) -> dict[str, ConfusionMatrix]:
    """Count the steps by true and recognised gait, over all rows and over each data set."""
    true = [row for row in rows if row.labels[TRUE_CLASS] in gaits.KNOWN_BY_NAME]
    chosen = {EVERYWHERE: true}
    for row in true:
        chosen.setdefault(row.labels["data_set"], []).append(row)
    return {name: _confusion(of_these) for name, of_these in chosen.items() if of_these}


def person_of(recording: Recording) -> str:
    """Return the name of the person who walks, as in the training data of the models."""
    if recording.format == sisfall.NAME:
        return f"{_SISFALL}/{recording.name.split('_')[1]}"
    return f"{_MOTIONSENSE}/{recording.name.removeprefix('sub_')}"


def _walk(name: str, path: Path, data_set: str, person: str, code: str) -> WalkFile:
    activity = _ACTIVITIES[code]
    return WalkFile(
        name=name,
        path=path,
        labels={
            "data_set": data_set,
            "person": f"{data_set}/{person}",
            "activity": code,
            TRUE_CLASS: activity if activity in gaits.KNOWN_BY_NAME else None,
        },
        group=f"{data_set}/{activity}",
        truth=Truth(activity=activity),
    )


def _part(walk: AnalysedWalk, device: DeviceWalk) -> MetricPart:
    activity = walk.recording.truth.activity
    if activity in _RESTING:
        return MetricPart({FALSE_STEPS_METRIC: steps_per_minute(len(device.steps), device.span_s)})
    labelled = _labelled(device.steps, walk)
    if labelled is None:
        return MetricPart(missing=dict.fromkeys((gaits.GAIT_METRIC, gaits.WALKING_METRIC), _SEEN))
    labels = [step.gait for step in labelled]
    true = gaits.KNOWN_BY_NAME.get(activity or "", Gait.UNKNOWN)
    counts = gaits.counts_of(true, labels)
    predicted = _by_label(counts[true])
    if true is Gait.UNKNOWN:
        return MetricPart(predicted=predicted)
    accuracies = gaits.accuracies(counts)
    plausibility = count_plausibility(device.level, np.array([step.event.time_s for step in device.steps]))
    of_labels = {name: accuracies[name] for name in (gaits.GAIT_METRIC, gaits.WALKING_METRIC)}
    return MetricPart(
        {**of_labels, PLAUSIBILITY_METRIC: plausibility.ratio},
        missing={
            **({} if labels else dict.fromkeys(of_labels, "no step found")),
            **({} if plausibility.expected else {PLAUSIBILITY_METRIC: "nobody moves enough for a step"}),
        },
        predicted=predicted,
    )


def _labelled(steps: Sequence[Step], walk: AnalysedWalk) -> Sequence[Step] | None:
    """Label the steps by a model without this person in its training data; None if there is no such model."""
    configured, person = gait_model(walk.config.gait), person_of(walk.recording)
    if configured is None:
        return steps
    if not is_shipped(configured):
        return None if person in configured.people else steps
    model = shipped_folds(configured.features).model_for(person)
    if model is None:
        return steps
    classifier = GaitClassifier(model)
    return [labelled for step in steps for labelled in classifier.push(step)] + classifier.flush()


def _by_label(row: NDArray[np.int64]) -> dict[str, int]:
    """Return the steps by label, from a row of a matrix."""
    return {label: int(row[gait]) for label, gait in _LABELS.items()}


def _confusion(rows: Sequence[TrackOutcome]) -> ConfusionMatrix:
    counts = np.zeros((len(Gait), len(Gait)), dtype=np.int64)
    for row in rows:
        true = gaits.KNOWN_BY_NAME[row.labels[TRUE_CLASS]]
        for label, steps in row.predicted.items():
            counts[true, _LABELS[label]] += steps
    recalls = {f"recall_{gait.name.lower()}": share for gait, share in gaits.recalls(counts).items()}
    return ConfusionMatrix(
        counts={true: _by_label(counts[gait]) for true, gait in gaits.KNOWN_BY_NAME.items()},
        shares={**gaits.accuracies(counts), **recalls},
    )


SUITE = Suite(
    name="gait",
    folder=".",
    metrics=METRICS,
    find=_find,
    score=_score,
    confusions=_confusions,
)
