"""Train the gait model on labelled steps; the only place that uses scikit-learn, which inference does without.

People are never split: a fold leaves out whole people, and every figure is of people whom the model had not seen,
neither its machines nor its sigmoids. The sigmoids are fitted to scores of people left out once more, among those
seen. The same steps give the same bytes: nothing is drawn at random, and numbers are rounded before and after the
fit, so that the last bits of another processor do not show.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from sklearn.linear_model import LogisticRegression
from sklearn.preprocessing import StandardScaler
from sklearn.svm import SVC, LinearSVC

from pdr_est.errors import ConfigError
from pdr_est.frames import Array
from pdr_est.front_end.gait.evaluation import gait_metrics, gait_probabilities
from pdr_est.front_end.gait.features import STRIDE_NAMES, UPTIME_NAMES, FeatureSet
from pdr_est.front_end.gait.folds import GaitFolds
from pdr_est.front_end.gait.model import GaitModel, SupportVectorMachine
from pdr_est.front_end.gait.training_data import LabelledSteps, StepTable, data_sets, step_table
from pdr_est.types.steps import Gait

MOST_FOLDS = 30
"""Up to so many people, each is left out in turn; more are left out in groups."""

_SIGMOID_FOLDS = 5  # groups of a model's people; its sigmoids fit the scores of each by the others

_DIGITS = 9  # significant digits of the numbers in a model

Mask = NDArray[np.bool_]
Index = NDArray[np.intp]


@dataclass(frozen=True)
class TrainingRecipe:
    """Settings of the training for a feature set.

    Attributes
    ----------
    names : tuple of str
        Names of all features.
    faster, running : tuple of str
        Features of the two levels.
    gamma : float
        Inverse squared width of the first level's kernel.
    faster_c, running_c : float
        Cost of errors of the two levels.
    most_steps : int
        Largest number of steps of one fit; more steps of the same people add support vectors and hardly anything
        else.
    """

    names: tuple[str, ...]
    faster: tuple[str, ...]
    running: tuple[str, ...]
    gamma: float
    faster_c: float
    most_steps: int
    running_c: float = 0.1

    def columns(self, level: tuple[str, ...]) -> tuple[int, ...]:
        """Return the columns of the features of a level."""
        return tuple(self.names.index(name) for name in level)


TRAINING_RECIPES: dict[FeatureSet, TrainingRecipe] = {
    "auto": TrainingRecipe(
        STRIDE_NAMES, STRIDE_NAMES[:3], STRIDE_NAMES[2:], gamma=0.25, faster_c=10.0, most_steps=4500
    ),
    "uptime": TrainingRecipe(UPTIME_NAMES, UPTIME_NAMES, UPTIME_NAMES, gamma=0.25, faster_c=1.0, most_steps=1000),
}


@dataclass(frozen=True)
class TrainedGait:
    """Result of the training.

    Attributes
    ----------
    model : GaitModel
        Model of all people, with the metrics of the folds.
    folds : GaitFolds
        Models of the folds.
    """

    model: GaitModel
    folds: GaitFolds


def train_gait_model(walks: Sequence[LabelledSteps], features: FeatureSet, folds: int = MOST_FOLDS) -> TrainedGait:
    """Train the two levels on all people, and once per fold without the people of the fold.

    The second level learns from people who were recorded jogging and running: the border between them is relative to
    the person, and the jogging of somebody who never ran does not tell where it lies.

    Parameters
    ----------
    walks : Sequence[LabelledSteps]
        Steps with features of the named set; the order of the recordings matters only within a person.
    features : FeatureSet
        Name of the feature set.
    folds : int
        Largest number of folds.

    Raises
    ------
    ConfigError
        If there are too few people for the folds.
    """
    table = step_table(walks)
    recipe = TRAINING_RECIPES[features]
    all_steps = np.ones(len(table), dtype=bool)
    fold_of = _assign_folds(table, all_steps, folds)
    left_out = []
    probability = np.empty((len(table), 3))
    for held_out in _fold_masks(table, fold_of):
        fit = _fit(table, ~held_out, recipe)
        left_out.append(fit.model(features, table, ~held_out, _held_out_scores(table, ~held_out, recipe)))
        scores = np.zeros((len(table), 2))
        scores[held_out] = fit.scores(table.features[held_out])
        probability[held_out] = gait_probabilities(left_out[-1], table.pooled(scores)[held_out])
    fit = _fit(table, all_steps, recipe)
    model = fit.model(features, table, all_steps, _held_out_scores(table, all_steps, recipe))
    return TrainedGait(
        model=replace(model, metrics=gait_metrics(table, probability)),
        folds=GaitFolds(models=tuple(left_out), fold_of=fold_of),
    )


@dataclass(frozen=True)
class _Level:
    """One fitted machine of scikit-learn on some columns."""

    columns: tuple[int, ...]
    scaler: StandardScaler
    machine: SVC | LinearSVC

    def scores(self, features: Array) -> Array:
        """Compute the scores (n,) of steps (n, k)."""
        scores: Array = self.machine.decision_function(self.scaler.transform(features[:, self.columns]))
        return scores

    def to_machine(self, sigmoid: tuple[float, float]) -> SupportVectorMachine:
        """Return the machine as plain numbers."""
        linear = isinstance(self.machine, LinearSVC)
        return SupportVectorMachine(
            columns=self.columns,
            mean=_rounded(self.scaler.mean_),
            scale=_rounded(self.scaler.scale_),
            kernel="linear" if linear else "rbf",
            gamma=0.0 if linear else float(self.machine.gamma),
            support=tuple(_rounded(row) for row in (self.machine.coef_ if linear else self.machine.support_vectors_)),
            dual=(1.0,) if linear else _rounded(self.machine.dual_coef_[0]),
            intercept=_rounded(self.machine.intercept_)[0],
            sigmoid=sigmoid,
        )


@dataclass(frozen=True)
class _Fit:
    """Fitted machines of both levels."""

    faster: _Level
    running: _Level

    def scores(self, features: Array) -> Array:
        """Compute the scores (n, 2) of each step alone."""
        return np.stack([self.faster.scores(features), self.running.scores(features)], axis=1)

    def model(self, features: FeatureSet, table: StepTable, seen: Mask, pooled: Array) -> GaitModel:
        """Make the model of the people seen; sigmoids are fitted to their scores (n, 2) when they were left out."""
        upper = table.gait == Gait.RUNNING
        teaching = seen & table.has_both_gaits & table.faster
        return GaitModel(
            features=features,
            faster=self.faster.to_machine(fit_platt_sigmoid(pooled[seen, 0], table.faster[seen], table.person[seen])),
            running=self.running.to_machine(
                fit_platt_sigmoid(pooled[teaching, 1], upper[teaching], table.person[teaching])
            ),
            people=tuple(sorted(set(table.person[seen].tolist()))),
            data=data_sets(table, seen),
        )


def _assign_folds(table: StepTable, seen: Mask, folds: int) -> dict[str, int]:
    """Deal the people seen into folds, those who teach the second level first, so that every fold has some."""
    teaching = set(table.person[seen & table.has_both_gaits].tolist())
    people = sorted(set(table.person[seen].tolist()), key=lambda person: (person not in teaching, person))
    return {person: i % folds for i, person in enumerate(people)}


def _fold_masks(table: StepTable, fold_of: Mapping[str, int]) -> Iterator[Mask]:
    """Yield the steps (n,) of the people of each fold."""
    fold = np.array([fold_of.get(person, -1) for person in table.person.tolist()])
    for number in range(max(fold_of.values(), default=-1) + 1):
        yield fold == number


def _held_out_scores(table: StepTable, seen: Mask, recipe: TrainingRecipe) -> Array:
    """Compute pooled scores (n, 2) of the people seen by fits on the others of them; zeros for all others."""
    scores = np.zeros((len(table), 2))
    for held_out in _fold_masks(table, _assign_folds(table, seen, _SIGMOID_FOLDS)):
        scores[held_out] = _fit(table, seen & ~held_out, recipe).scores(table.features[held_out])
    return table.pooled(scores)


def _fit(table: StepTable, seen: Mask, recipe: TrainingRecipe) -> _Fit:
    teaching = seen & table.has_both_gaits & table.faster
    faster = SVC(C=recipe.faster_c, kernel="rbf", gamma=recipe.gamma)
    running = LinearSVC(C=recipe.running_c, random_state=0)
    return _Fit(
        _fit_level(table, _thinned_indices(seen, recipe), table.faster, recipe.columns(recipe.faster), faster),
        _fit_level(
            table,
            _thinned_indices(teaching, recipe),
            table.gait == Gait.RUNNING,
            recipe.columns(recipe.running),
            running,
        ),
    )


def _thinned_indices(chosen: Mask, recipe: TrainingRecipe) -> Index:
    """Return the indices of the chosen steps, evenly thinned."""
    index = np.flatnonzero(chosen)
    return index[:: max(-(-len(index) // recipe.most_steps), 1)]


def _fit_level(
    table: StepTable, index: Index, upper: Mask, columns: tuple[int, ...], machine: SVC | LinearSVC
) -> _Level:
    """Fit a machine that tells the steps of the index that are on the upper side from the others."""
    if len(np.unique(upper[index])) < 2:
        raise ConfigError(
            "too few people to leave some out: record at least three who walk, and three who jog and run, or add the "
            "folders motionsense/ and sisfall/"
        )
    x = table.features[index][:, columns]
    scaler = StandardScaler().fit(x)
    machine.fit(scaler.transform(x), upper[index], sample_weight=_weights(upper[index], table.person[index]))
    return _Level(columns, scaler, machine)


def fit_platt_sigmoid(scores: Array, upper: Mask, person: NDArray[np.str_]) -> tuple[float, float]:
    """Fit the probability of the upper side to scores of people left out.

    With N steps on the upper side their target is (N + 1) / (N + 2) and not 1, and likewise on the lower one, so that
    scores that part the sides without error leave a finite slope. Every step counts as a step of its side with that
    weight, and of the other with the rest.

    Parameters
    ----------
    scores : ndarray, shape (n,)
        Scores.
    upper : ndarray of bool, shape (n,)
        True for steps on the upper side.
    person : ndarray of str, shape (n,)
        Person of each step.

    Returns
    -------
    tuple of float
        Slope and offset.

    References
    ----------
    Platt 1999, section 2.2.
    """
    weights = _weights(upper, person)
    above, below = int(upper.sum()), int((~upper).sum())
    target = np.where(upper, (above + 1.0) / (above + 2.0), 1.0 / (below + 2.0))
    logistic = LogisticRegression(C=1e6, solver="newton-cholesky", tol=1e-10)
    logistic.fit(
        np.concatenate([scores, scores])[:, None],
        np.repeat([True, False], len(scores)),
        sample_weight=np.concatenate([weights * target, weights * (1.0 - target)]),
    )
    return _rounded(logistic.coef_[0])[0], _rounded(logistic.intercept_)[0]


def _weights(upper: Mask, person: NDArray[np.str_]) -> Array:
    """Compute weights (n,) of mean 1: both sides count alike, and within a side each person."""
    weights = np.empty(len(upper))
    for side in (False, True):
        people, number, counts = np.unique(person[upper == side], return_inverse=True, return_counts=True)
        weights[upper == side] = 0.5 * len(upper) / (len(people) * counts[number])
    return weights


def _rounded(numbers: Array) -> tuple[float, ...]:
    """Round to the significant digits that a model keeps."""
    return tuple(float(f"{number:.{_DIGITS}g}") for number in numbers)
