"""The stage of the gait: probabilities, classes, pauses, and which model it takes."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from gait_people import walks_of
from signals import run, step

from pdr_est.config import config_from_dict
from pdr_est.errors import ConfigError
from pdr_est.front_end.gait import GaitClassifier, GaitParams, gait_stage, shipped_folds, shipped_model
from pdr_est.front_end.gait.features import step_features
from pdr_est.front_end.gait.model import save_model
from pdr_est.front_end.gait.svm_scorer import GaitScorer, decide_gait
from pdr_est.front_end.gait.training import train_gait_model
from pdr_est.stage import Stage
from pdr_est.types.steps import Gait, Step

SLOW, FAST = (1.9, 2.5), (2.9, 14.0)  # steps a second, m/s^2


def steps_of(*parts: tuple[tuple[float, float], int]) -> list[Step]:
    """So many steps of each rate and height, one after the other without a pause."""
    found, time_s = [], 0.0
    for (rate_hz, height_mps2), count in parts:
        for _ in range(count):
            samples = round(50.0 / rate_hz)
            wave = height_mps2 * np.sin(2.0 * np.pi * np.arange(samples) / samples)
            frequency_hz = rate_hz if found else 0.0
            found.append(step(time_s + 1.0 / rate_hz, time_s, vertical_mps2=wave, frequency_hz=frequency_hz))
            time_s += 1.0 / rate_hz
    return found


@pytest.mark.parametrize("method", ["auto", "uptime"])
def test_a_change_of_gait_is_found_within_two_steps(method: str) -> None:
    stage = gait_stage(50.0, GaitParams(method=method))  # type: ignore[arg-type]
    assert isinstance(stage, Stage)
    steps = steps_of((SLOW, 10), (FAST, 10), (SLOW, 10))
    walking = [found.gait is Gait.WALKING for found in run(stage, steps)]
    assert len(walking) == 30
    assert all(walking[:10])
    assert not any(walking[12:20])
    assert all(walking[22:])


def test_a_step_is_emitted_at_once_with_its_probabilities_and_nothing_else_changed() -> None:
    stage = GaitClassifier(shipped_model("auto"))
    for given in steps_of((SLOW, 3), (FAST, 3)):
        (found,) = stage.push(given)
        assert sum(found.gait_probability) == pytest.approx(1.0)
        assert found.gait is decide_gait(found.gait_probability)
        kept = replace(found, gait=given.gait, gait_probability=given.gait_probability)
        assert kept.samples is given.samples
        assert (kept.event, kept.start_s, kept.frequency_hz) == (given.event, given.start_s, given.frequency_hz)
    assert stage.flush() == []


@pytest.mark.parametrize("fresh", [{"frequency_hz": 0.0}, {"segment": 1}], ids=["pause", "gap"])
def test_a_walk_begins_without_memory(fresh: dict[str, float]) -> None:
    stage = GaitClassifier(shipped_model("auto"))
    run(stage, steps_of((FAST, 5)))
    again = steps_of((SLOW, 2))[1]
    event = replace(again.event, segment=int(fresh.get("segment", 0)))
    again = replace(again, event=event, frequency_hz=fresh.get("frequency_hz", 2.0))
    (found,) = stage.push(again)
    (alone,) = GaitClassifier(shipped_model("auto")).push(again)
    assert found.gait_probability == alone.gait_probability


def test_the_mean_of_two_steps_decides() -> None:
    """Worked out from the scores of each step."""
    model, steps = shipped_model("auto"), steps_of((SLOW, 1), (FAST, 1))
    features, scorer = step_features("auto"), GaitScorer(model)
    scores = scorer.scores(features.push_all(steps))
    (expected,) = scorer.probabilities(scores.mean(axis=1, keepdims=True)).tolist()
    assert run(GaitClassifier(model), steps)[1].gait_probability == tuple(expected)


def test_without_a_method_the_gait_stays_unknown() -> None:
    (found,) = gait_stage(50.0, GaitParams(method="none")).push(steps_of((SLOW, 1))[0])
    assert found.gait is Gait.UNKNOWN
    assert all(map(math.isnan, found.gait_probability))


def test_the_class_is_the_end_of_the_path_through_the_levels() -> None:
    assert decide_gait((0.5, 0.3, 0.2)) is Gait.WALKING
    assert decide_gait((0.4, 0.35, 0.25)) is Gait.JOGGING
    assert decide_gait((0.4, 0.25, 0.35)) is Gait.RUNNING


@pytest.mark.parametrize("method", ["auto", "uptime"])
def test_the_shipped_models_have_folds_for_all_their_people(method: str) -> None:
    model, folds = shipped_model(method), shipped_folds(method)  # type: ignore[arg-type]
    assert model.features == method
    assert set(folds.fold_of) == set(model.people)
    assert {"motionsense/1", "sisfall/SA01"} <= set(model.people)
    assert model.metrics is not None
    assert method == "uptime" or model.metrics.faster_accuracy["all"] >= 0.99


def test_a_model_of_ones_own(tmp_path: Path) -> None:
    path = tmp_path / "own.json"
    model = train_gait_model(walks_of(people=3), "auto").model
    save_model(model, path)
    expected = run(GaitClassifier(model), steps_of((SLOW, 3)))
    found = run(gait_stage(50.0, GaitParams(model=str(path))), steps_of((SLOW, 3)))
    assert [each.gait_probability for each in found] == [each.gait_probability for each in expected]
    with pytest.raises(ConfigError, match=r"test: gait\.model: .*own\.json: is a model of the method 'auto'"):
        config_from_dict({"gait": {"method": "uptime", "model": str(path)}}, "test")


def test_a_model_for_no_method_is_refused() -> None:
    with pytest.raises(ConfigError, match=r'test: gait\.model: .*the method "none" uses none'):
        config_from_dict({"gait": {"method": "none", "model": "own.json"}}, "test")


def test_a_missing_model_is_told_by_the_configuration() -> None:
    with pytest.raises(ConfigError, match=r"test: gait\.model: nowhere\.json: cannot be read"):
        config_from_dict({"gait": {"model": "nowhere.json"}}, "test")
