"""Training of the gait model from labelled steps. The only place that knows scikit-learn; inference does without.

People are never split: a fold leaves out whole people, and every figure is of people whom the model had not seen,
neither its machines nor its sigmoids. These are fitted to scores of people left out once more, among those seen.
The same steps give the same bytes: nothing is drawn at random, and numbers are rounded before and after the fit, so
that the last bits of another processor do not show.
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

_SIGMOID_FOLDS = 5  # groups of the people that a model has seen, whose scores by the others fit its sigmoids

_DIGITS = 9  # significant ones that a model keeps

Mask = NDArray[np.bool_]
Index = NDArray[np.intp]


@dataclass(frozen=True)
class TrainingRecipe:
    """What a feature set is trained with. faster, running: features of the two levels; gamma: of the first one's
    kernel; faster_c, running_c: the cost of errors. most_steps: of one fit; more of the same people add support
    vectors and hardly anything else."""

    names: tuple[str, ...]
    faster: tuple[str, ...]
    running: tuple[str, ...]
    gamma: float
    faster_c: float
    most_steps: int
    running_c: float = 0.1

    def columns(self, level: tuple[str, ...]) -> tuple[int, ...]:
        """Where the features of a level stand."""
        return tuple(self.names.index(name) for name in level)


TRAINING_RECIPES: dict[FeatureSet, TrainingRecipe] = {
    "auto": TrainingRecipe(
        STRIDE_NAMES, STRIDE_NAMES[:3], STRIDE_NAMES[2:], gamma=0.25, faster_c=10.0, most_steps=4500
    ),
    "uptime": TrainingRecipe(UPTIME_NAMES, UPTIME_NAMES, UPTIME_NAMES, gamma=0.25, faster_c=1.0, most_steps=1000),
}


@dataclass(frozen=True)
class TrainedGait:
    """A model of all people, with the metrics of the folds, and the folds."""

    model: GaitModel
    folds: GaitFolds


def train(walks: Sequence[LabelledSteps], features: FeatureSet, folds: int = MOST_FOLDS) -> TrainedGait:
    """Train the two levels on all people, and once a fold without the people of the fold.

    walks: features of the named set; their order matters only within a person. The second level learns from people
    who were recorded jogging and running: the border between them is relative to the person, and somebody's jogging
    alone does not tell where it lies. Raises ConfigError when there are too few people for the folds.
    """
    table = step_table(walks)
    recipe = TRAINING_RECIPES[features]
    everybody = np.ones(len(table), dtype=bool)
    fold_of = _deal(table, everybody, folds)
    left_out = []
    probability = np.empty((len(table), 3))
    for away in _groups(table, fold_of):
        fit = _fit(table, ~away, recipe)
        left_out.append(fit.model(features, table, ~away, _scores_left_out(table, ~away, recipe)))
        scores = np.zeros((len(table), 2))
        scores[away] = fit.scores(table.features[away])
        probability[away] = gait_probabilities(left_out[-1], table.pooled(scores)[away])
    fit = _fit(table, everybody, recipe)
    model = fit.model(features, table, everybody, _scores_left_out(table, everybody, recipe))
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
        found: Array = self.machine.decision_function(self.scaler.transform(features[:, self.columns]))
        return found

    def numbers(self, sigmoid: tuple[float, float]) -> SupportVectorMachine:
        """The machine as plain numbers."""
        linear = isinstance(self.machine, LinearSVC)
        return SupportVectorMachine(
            columns=self.columns,
            mean=_short(self.scaler.mean_),
            scale=_short(self.scaler.scale_),
            kernel="linear" if linear else "rbf",
            gamma=0.0 if linear else float(self.machine.gamma),
            support=tuple(_short(row) for row in (self.machine.coef_ if linear else self.machine.support_vectors_)),
            dual=(1.0,) if linear else _short(self.machine.dual_coef_[0]),
            intercept=_short(self.machine.intercept_)[0],
            sigmoid=sigmoid,
        )


@dataclass(frozen=True)
class _Fit:
    """Both levels."""

    faster: _Level
    running: _Level

    def scores(self, features: Array) -> Array:
        """(n, 2), of each step alone."""
        return np.stack([self.faster.scores(features), self.running.scores(features)], axis=1)

    def model(self, features: FeatureSet, table: StepTable, seen: Mask, pooled: Array) -> GaitModel:
        """The model of the people that were seen, sigmoids fitted to their scores (n, 2) when they were left out."""
        upper = table.gait == Gait.RUNNING
        told = seen & table.has_both_gaits & table.faster
        return GaitModel(
            features=features,
            faster=self.faster.numbers(_platt(pooled[seen, 0], table.faster[seen], table.person[seen])),
            running=self.running.numbers(_platt(pooled[told, 1], upper[told], table.person[told])),
            people=tuple(sorted(set(table.person[seen].tolist()))),
            data=data_sets(table, seen),
        )


def _deal(table: StepTable, seen: Mask, folds: int) -> dict[str, int]:
    """Fold of each person seen: those who teach the second level are dealt out first, so that every fold has some."""
    told = set(table.person[seen & table.has_both_gaits].tolist())
    people = sorted(set(table.person[seen].tolist()), key=lambda person: (person not in told, person))
    return {person: i % folds for i, person in enumerate(people)}


def _groups(table: StepTable, fold_of: Mapping[str, int]) -> Iterator[Mask]:
    """The steps (n,) of the people of each fold."""
    fold = np.array([fold_of.get(person, -1) for person in table.person.tolist()])
    for number in range(max(fold_of.values(), default=-1) + 1):
        yield fold == number


def _scores_left_out(table: StepTable, seen: Mask, recipe: TrainingRecipe) -> Array:
    """Pooled scores (n, 2) of the people seen, by fits on the others of them; zeros for those not seen."""
    scores = np.zeros((len(table), 2))
    for away in _groups(table, _deal(table, seen, _SIGMOID_FOLDS)):
        scores[away] = _fit(table, seen & ~away, recipe).scores(table.features[away])
    return table.pooled(scores)


def _fit(table: StepTable, seen: Mask, recipe: TrainingRecipe) -> _Fit:
    told = seen & table.has_both_gaits & table.faster
    faster = SVC(C=recipe.faster_c, kernel="rbf", gamma=recipe.gamma)
    running = LinearSVC(C=recipe.running_c, random_state=0)
    return _Fit(
        _fit_level(table, _thin(seen, recipe), table.faster, recipe.columns(recipe.faster), faster),
        _fit_level(table, _thin(told, recipe), table.gait == Gait.RUNNING, recipe.columns(recipe.running), running),
    )


def _thin(chosen: Mask, recipe: TrainingRecipe) -> Index:
    """Numbers of the chosen steps, evenly thinned."""
    index = np.flatnonzero(chosen)
    return index[:: max(-(-len(index) // recipe.most_steps), 1)]


def _fit_level(
    table: StepTable, index: Index, upper: Mask, columns: tuple[int, ...], machine: SVC | LinearSVC
) -> _Level:
    """Fit a machine to tell those steps of the index that are on the upper side."""
    if len(np.unique(upper[index])) < 2:
        raise ConfigError(
            "too few people to leave some out: record at least three who walk, and three who jog and run, or add the "
            "folders motionsense/ and sisfall/"
        )
    x = table.features[index][:, columns]
    scaler = StandardScaler().fit(x)
    machine.fit(scaler.transform(x), upper[index], sample_weight=_weights(upper[index], table.person[index]))
    return _Level(columns, scaler, machine)


def _platt(scores: Array, upper: Mask, person: NDArray[np.str_]) -> tuple[float, float]:
    """Slope and offset of the probability of the upper side for scores (n,) of people left out.

    Platt 1999, section 2.2: with N steps on the upper side their target is (N + 1) / (N + 2) and not 1, and likewise
    on the lower one, so that scores that part the sides without error leave a finite slope. Every step counts as a
    step to its side with that weight, and to the other with the rest.
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
    return _short(logistic.coef_[0])[0], _short(logistic.intercept_)[0]


def _weights(upper: Mask, person: NDArray[np.str_]) -> Array:
    """Weights (n,) of mean 1: both sides count alike, and within a side each person."""
    weights = np.empty(len(upper))
    for side in (False, True):
        people, number, counts = np.unique(person[upper == side], return_inverse=True, return_counts=True)
        weights[upper == side] = 0.5 * len(upper) / (len(people) * counts[number])
    return weights


def _short(numbers: Array) -> tuple[float, ...]:
    return tuple(float(f"{number:.{_DIGITS}g}") for number in numbers)
