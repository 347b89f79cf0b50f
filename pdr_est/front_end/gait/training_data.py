"""Steps of known gait, as the tables that training and evaluation work on."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pdr_est.errors import ConfigError
from pdr_est.frames import Array
from pdr_est.front_end.gait.features import FeatureSet, step_features
from pdr_est.front_end.gait.model import TrainingDataSet
from pdr_est.front_end.gait.svm_scorer import SCORE_LIMIT, gait_changes
from pdr_est.types.steps import Gait, Step, walks_begun

KNOWN_GAITS = (Gait.WALKING, Gait.JOGGING, Gait.RUNNING)

_DECIMALS = 6  # of a feature; finer differences come from the arithmetic and not from the walker


@dataclass(frozen=True)
class LabelledSteps:
    """Steps of one recording, all of one gait.

    Attributes
    ----------
    person, data_set : str
        Names.
    gait : Gait
        Gait of all steps.
    features : ndarray, shape (n, k)
        Features of the steps.
    begins : ndarray of bool, shape (n,)
        True for a step that begins a walk.
    """

    person: str
    data_set: str
    gait: Gait
    features: Array
    begins: NDArray[np.bool_]


@dataclass(frozen=True)
class StepTable:
    """Steps of many recordings in order.

    Attributes
    ----------
    features : ndarray, shape (n, k)
        Features of the steps.
    begins : ndarray of bool, shape (n,)
        True for a step that begins a walk.
    gait : ndarray of int8, shape (n,)
        Values of `Gait`.
    person, data_set : ndarray of str, shape (n,)
        Names.
    recording : ndarray of int, shape (n,)
        Number of the recording.
    has_both_gaits : ndarray of bool, shape (n,)
        True if the person was recorded both jogging and running.
    """

    features: Array
    begins: NDArray[np.bool_]
    gait: NDArray[np.int8]
    person: NDArray[np.str_]
    data_set: NDArray[np.str_]
    recording: NDArray[np.int64]
    has_both_gaits: NDArray[np.bool_]

    def __len__(self) -> int:
        return len(self.gait)

    @property
    def faster(self) -> NDArray[np.bool_]:
        """Return (n,) True for the steps that are not walked."""
        faster: NDArray[np.bool_] = self.gait != Gait.WALKING
        return faster

    def pooled(self, scores: Array) -> Array:
        """Clip scores (n, 2) at the limit and average them with those of the step before, as the classifier does."""
        cut = np.clip(scores, -SCORE_LIMIT, SCORE_LIMIT)
        before = np.concatenate([cut[:1], cut[:-1]])
        alone = self.begins | gait_changes(cut[:, 0], before[:, 0])
        return np.where(alone[:, None], cut, 0.5 * (cut + before))


def labelled_steps(
    steps: Iterable[Step], features: FeatureSet, *, person: str, data_set: str, gait: Gait
) -> LabelledSteps:
    """Compute the features of one recording's steps, given in time order.

    Raises
    ------
    ConfigError
        If there is no step.
    """
    given = tuple(steps)
    if not given:
        raise ConfigError(f"{person}, {gait.name.lower()}: a recording without a step: take it out")
    rounded: Array = step_features(features).push_all(given).round(_DECIMALS)
    return LabelledSteps(person, data_set, gait, rounded, np.array(walks_begun(given, None)))


def step_table(walks: Sequence[LabelledSteps]) -> StepTable:
    """Join the steps of all recordings, ordered by data set and person.

    Raises
    ------
    ConfigError
        If there is no recording.
    """
    if not walks:
        raise ConfigError("no labelled recording: there is nothing to train on")
    ordered = sorted(walks, key=lambda walk: (walk.data_set, walk.person))
    counts = [len(walk.begins) for walk in ordered]
    gaits: dict[str, set[Gait]] = {}
    for walk in ordered:
        gaits.setdefault(walk.person, set()).add(walk.gait)
    both = {Gait.JOGGING, Gait.RUNNING}
    return StepTable(
        features=np.concatenate([walk.features for walk in ordered]),
        begins=np.concatenate([walk.begins for walk in ordered]),
        gait=np.repeat(np.array([walk.gait for walk in ordered], dtype=np.int8), counts),
        person=np.repeat([walk.person for walk in ordered], counts),
        data_set=np.repeat([walk.data_set for walk in ordered], counts),
        recording=np.repeat(np.arange(len(ordered)), counts),
        has_both_gaits=np.repeat([both <= gaits[walk.person] for walk in ordered], counts),
    )


def data_sets(table: StepTable, chosen: NDArray[np.bool_]) -> tuple[TrainingDataSet, ...]:
    """Summarise the data sets that the chosen steps (n,) of a table come from."""
    found = []
    for name in np.unique(table.data_set[chosen]).tolist():
        here = chosen & (table.data_set == name)
        walking, jogging, running = (int(np.sum(table.gait[here] == gait)) for gait in KNOWN_GAITS)
        found.append(
            TrainingDataSet(
                name=name,
                people=len(np.unique(table.person[here])),
                recordings=len(np.unique(table.recording[here])),
                steps=(walking, jogging, running),
            )
        )
    return tuple(found)
