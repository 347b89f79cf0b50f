"""Training of the gait model: people are never split, same steps give same bytes, arithmetic as scikit-learn's."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from gait_people import walks_of
from signals import run, step
from sklearn.preprocessing import StandardScaler
from sklearn.svm import SVC, LinearSVC

from pdr_est.errors import ConfigError
from pdr_est.front_end.gait.classifier import GaitClassifier
from pdr_est.front_end.gait.evaluation import balanced_accuracy, gait_metrics, gait_probabilities
from pdr_est.front_end.gait.features import UPTIME_NAMES
from pdr_est.front_end.gait.folds import load_folds, save_folds
from pdr_est.front_end.gait.model import GaitModel, SupportVectorMachine, model_from_dict, save_model
from pdr_est.front_end.gait.svm_scorer import GaitScorer, scorer
from pdr_est.front_end.gait.training import TrainedGait, fit_platt_sigmoid, train_gait_model
from pdr_est.front_end.gait.training_data import step_table
from pdr_est.types.steps import Gait


@pytest.fixture(scope="module")
def trained() -> TrainedGait:
    return train_gait_model(walks_of(people=4, joggers_only=2), "auto")


def test_the_gaits_of_people_left_out_are_told(trained: TrainedGait) -> None:
    metrics = trained.model.metrics
    assert metrics is not None
    assert metrics.faster_accuracy["all"] > 0.99
    assert metrics.balanced_accuracy["both"] > 0.9
    assert sum(map(sum, metrics.confusion["all"])) == 60 * (4 * 3 + 2 * 2)
    assert metrics.confusion["jogging"][2] == (0, 0, 0)


def test_each_fold_has_not_seen_its_people(trained: TrainedGait) -> None:
    people = set(trained.model.people)
    assert len(people) == len(trained.folds.models) == 6
    for person in people:
        model = trained.folds.model_for(person)
        assert model is not None
        assert set(model.people) == people - {person}
        assert model.faster != trained.model.faster
        assert model.metrics is None
    assert trained.folds.model_for("somebody else") is None


def test_a_person_left_out_has_no_influence_on_the_fold(trained: TrainedGait) -> None:
    """Neither on its machines nor on its sigmoids."""
    walks = [
        replace(walk, features=walk.features + 0.3) if walk.person == "both/1" else walk
        for walk in walks_of(people=4, joggers_only=2)
    ]
    changed, before = train_gait_model(walks, "auto").folds.model_for("both/1"), trained.folds.model_for("both/1")
    assert changed is not None
    assert before is not None
    assert changed == before


def test_more_people_than_folds_are_left_out_in_groups() -> None:
    folds = train_gait_model(walks_of(people=5, steps=20), "auto", folds=2).folds
    assert sorted(folds.fold_of.values()) == [0, 0, 0, 1, 1]
    assert folds.models[0].people == ("both/1", "both/3")


def test_the_same_steps_in_another_order_of_people_give_the_same_bytes(trained: TrainedGait, tmp_path: Path) -> None:
    again = train_gait_model(list(reversed(_by_person(walks_of(people=4, joggers_only=2)))), "auto")
    for name, each in (("a", trained), ("b", again)):
        save_model(each.model, tmp_path / name)
        save_folds(each.folds, tmp_path / f"{name}-folds")
    assert (tmp_path / "a").read_bytes() == (tmp_path / "b").read_bytes()
    assert (tmp_path / "a-folds").read_bytes() == (tmp_path / "b-folds").read_bytes()
    assert load_folds(tmp_path / "a-folds") == trained.folds


def _by_person(walks: list) -> list:  # type: ignore[type-arg]
    """Walks whose order within a person survives being reversed."""
    people = sorted({walk.person for walk in walks})
    return [walk for person in people for walk in reversed([w for w in walks if w.person == person])]


@pytest.mark.parametrize("kernel", ["rbf", "linear"])
def test_scores_are_those_of_scikit_learn(kernel: str) -> None:
    rng = np.random.default_rng(1)
    x, columns = rng.standard_normal((200, 6)) * 3.0 + 1.0, (4, 0, 2)
    upper = x[:, 4] + 0.3 * x[:, 0] ** 2 > 2.0
    scaler = StandardScaler().fit(x[:, columns])
    svm = SVC(C=1.0, gamma=0.4) if kernel == "rbf" else LinearSVC(random_state=0)
    svm.fit(scaler.transform(x[:, columns]), upper)
    rbf = isinstance(svm, SVC)
    machine = SupportVectorMachine(
        columns=columns,
        mean=tuple(scaler.mean_),
        scale=tuple(scaler.scale_),
        kernel="rbf" if rbf else "linear",
        gamma=0.4,
        support=tuple(map(tuple, svm.support_vectors_ if rbf else svm.coef_)),
        dual=tuple(svm.dual_coef_[0]) if rbf else (1.0,),
        intercept=float(svm.intercept_[0]),
        sigmoid=(1.0, 0.0),
    )
    expected = svm.decision_function(scaler.transform(x[:, columns]))
    found = [float(scorer(machine)(row[None])[0]) for row in x]
    np.testing.assert_array_equal(scorer(machine)(x), found)
    np.testing.assert_allclose(found, expected, atol=1e-12)


def test_the_second_level_learns_from_those_who_did_both_only() -> None:
    alone = train_gait_model(walks_of(people=4), "auto").model.running
    walks = walks_of(people=4, joggers_only=2)
    assert train_gait_model(walks, "auto").model.running == alone


def test_the_pooled_scores_are_those_of_the_step_and_the_one_before() -> None:
    table = step_table(walks_of(people=1, steps=21)[:1])
    scores = np.stack([np.arange(21.0) / 4.0, -np.ones(21)], axis=1)
    pooled = table.pooled(scores)[:, 0]
    assert pooled[[0, 1, 7, 8, 9, 20]].tolist() == [0.0, 0.125, 1.625, 1.875, 2.0, 2.0]


def peak_and_range() -> GaitModel:
    """A model whose first score is UPTIME's peak and whose second one is its range less 1."""
    machines = [
        {
            "columns": [UPTIME_NAMES.index(name)],
            "mean": [mean],
            "scale": [1.0],
            "kernel": "linear",
            "gamma": 0.0,
            "support": [[1.0]],
            "dual": [1.0],
            "intercept": 0.0,
            "sigmoid": [1.5, 0.1],
        }
        for name, mean in (("peak", 0.0), ("range", 1.0))
    ]
    content = {"features": "uptime", "faster": machines[0], "running": machines[1], "people": [], "data": []}
    return model_from_dict(content, "made up")


def test_the_classifier_pools_as_training_does() -> None:
    """Steps of both gaits by turns: means, clear changes and beginnings."""
    scores = np.random.default_rng(5).uniform([-1.5, -0.9], 1.5, (60, 2))
    steps = [
        step(
            0.5 * i + 0.5,
            0.5 * i,
            frequency_hz=0.0 if i % 11 == 0 else 2.0,
            vertical_mps2=np.array([peak, peak - (second + 1.0)]),
        )
        for i, (peak, second) in enumerate(scores.tolist())
    ]
    found = [each.gait_probability for each in run(GaitClassifier(peak_and_range()), steps)]
    table = replace(step_table(walks_of(people=1, steps=60)[:1]), begins=np.arange(60) % 11 == 0)
    pooled = table.pooled(scores)
    np.testing.assert_allclose(found, gait_probabilities(peak_and_range(), pooled), rtol=1e-9)
    alone = np.all(pooled == scores, axis=1)
    assert 11 < alone.sum() < 55


def test_scores_that_part_the_sides_without_error_leave_a_finite_slope() -> None:
    """Platt's targets for twenty steps a side are 21/22 and 1/22, which the sigmoid meets at the scores 1 and -1."""
    upper = np.arange(40) < 20
    slope, offset = fit_platt_sigmoid(np.where(upper, 1.0, -1.0), upper, np.repeat("someone", 40))
    assert slope == pytest.approx(np.log(21.0), rel=1e-4)
    assert offset == pytest.approx(0.0, abs=1e-6)


def test_probabilities_say_what_the_metrics_count() -> None:
    table = step_table(walks_of(people=1, steps=2))
    right = np.eye(3)[table.gait - 1]
    metrics = gait_metrics(table, right)
    assert metrics.confusion["all"] == ((2, 0, 0), (0, 2, 0), (0, 0, 2))
    assert metrics.brier == (0.0, 0.0)
    assert balanced_accuracy(((3, 1, 0), (0, 0, 0), (0, 1, 1))) == pytest.approx(0.625)


@pytest.mark.parametrize("people", [0, 1, 2])
def test_too_few_people_are_refused(people: int) -> None:
    with pytest.raises(ConfigError, match=r"nothing to train on|too few people"):
        train_gait_model(walks_of(people=people), "auto")


def test_probabilities_add_up(trained: TrainedGait) -> None:
    scores = np.array([(-2.0, 2.0), (0.1, 0.0), (2.0, -2.0)]).T
    assert GaitScorer(trained.model).probabilities(scores).sum(axis=1) == pytest.approx(np.ones(3))
    assert Gait.WALKING == 1
