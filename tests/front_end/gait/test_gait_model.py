"""Files of gait models: what they refuse."""

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from gait_people import walks_of

from pdr_est.errors import ConfigError, OutputError
from pdr_est.front_end.gait.checksummed_json import content_sha256
from pdr_est.front_end.gait.folds import load_folds, save_folds
from pdr_est.front_end.gait.model import GaitModel, load_model, model_digest, save_model
from pdr_est.front_end.gait.training import TrainedGait, train_gait_model

Json = dict[str, Any]


@pytest.fixture(scope="module")
def trained() -> TrainedGait:
    return train_gait_model(walks_of(people=3, steps=20), "auto")


@pytest.fixture(scope="module")
def model(trained: TrainedGait) -> GaitModel:
    return trained.model


def test_a_model_comes_back_as_it_was(model: GaitModel, tmp_path: Path) -> None:
    seal = save_model(model, tmp_path / "model.json")
    assert load_model(tmp_path / "model.json") == model
    assert seal == model_digest(model) == json.loads((tmp_path / "model.json").read_text())["sha256"]


def refused(path: Path) -> str:
    with pytest.raises(ConfigError) as caught:
        load_model(path)
    message = str(caught.value)
    assert message.startswith(str(path))
    assert "\n" not in message
    assert "train-gait" in message
    return message


def changed(model: GaitModel, path: Path, change: Callable[[Json], object], seal: bool = False) -> Path:
    """A file of the model with a change, with a digest that fits it if wanted."""
    save_model(model, path)
    content = json.loads(path.read_text())
    change(content)
    if seal:
        del content["sha256"]
        content["sha256"] = content_sha256(content)
    path.write_text(json.dumps(content))
    return path


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda c: c["faster"].update(intercept=0.0), "does not match its sha256"),
        (lambda c: c["people"].append("me"), "does not match its sha256"),
        (lambda c: c.pop("sha256"), "does not match its sha256 None"),
        (lambda c: c["faster"].update(intercept=float("nan")), "does not match its sha256"),
        (lambda c: c.update(version=2), "version 2 of pdr_est-gait, this program reads 1"),
        (lambda c: c.update(format="other"), "is no file of format 'pdr_est-gait'"),
        (lambda c: c.pop("format"), "is no file of format 'pdr_est-gait'"),
    ],
)
def test_a_changed_file_is_refused(
    model: GaitModel, tmp_path: Path, change: Callable[[Json], object], words: str
) -> None:
    assert words in refused(changed(model, tmp_path / "model.json", change))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda c: c.pop("running"), "running"),
        (lambda c: c.update(code="x"), "code"),
        (lambda c: c["faster"]["scale"].__setitem__(0, 0.0), "faster.scale.0"),
        (lambda c: c["faster"]["dual"].pop(), "faster: its arrays differ in length"),
        (lambda c: c["running"]["columns"].__setitem__(0, 6), "running: its arrays differ in length"),
        (lambda c: c["faster"]["support"][1].pop(), "faster: its arrays differ in length"),
        (lambda c: c["faster"].update(gamma=-5.0), "faster.gamma = -5: is no width"),
        (lambda c: c["faster"].update(sigmoid=[1e308, 0.0]), "faster.sigmoid.0 = 1e+308: is steeper than"),
        (lambda c: c["running"].update(sigmoid=[1.0, -1e308]), "running.sigmoid.1 = -1e+308: is beyond"),
        (lambda c: c["running"].update(intercept=1e300), "running.intercept = 1e+300: is beyond"),
        (lambda c: c["running"].update(support=c["running"]["support"] * 2, dual=[1.0, 1.0]), "running.support = 2"),
    ],
)
def test_a_sealed_file_that_makes_no_sense_is_refused(
    model: GaitModel, tmp_path: Path, change: Callable[[Json], object], words: str
) -> None:
    assert words in refused(changed(model, tmp_path / "model.json", change, seal=True))


@pytest.mark.parametrize("content", [b"", b"{", b"[]", b"\xff\xfe{}", b"\x80\x04cos\nsystem\n", b"[" * 100_000])
def test_what_is_no_model_is_refused(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "model.json"
    path.write_bytes(content)
    refused(path)


def test_a_truncated_missing_or_unwritable_file(model: GaitModel, tmp_path: Path) -> None:
    path = tmp_path / "model.json"
    save_model(model, path)
    path.write_bytes(path.read_bytes()[:-200])
    assert "perhaps cut short" in refused(path)
    assert "cannot be read" in refused(tmp_path / "none.json")
    assert "cannot be read" in refused(tmp_path)
    with pytest.raises(OutputError, match="cannot be written"):
        save_model(model, tmp_path / "nowhere" / "model.json")


def test_folds_that_leave_nobody_out_are_refused(trained: TrainedGait, tmp_path: Path) -> None:
    path = tmp_path / "folds.json"
    save_folds(trained.folds, path)
    assert load_folds(path) == trained.folds
    shifted = {person: (fold + 1) % 3 for person, fold in trained.folds.fold_of.items()}
    save_folds(replace(trained.folds, fold_of=shifted), path)
    with pytest.raises(ConfigError, match=r"folds\.json: fold_of\.both/0 = 1: is no model without this person"):
        load_folds(path)
    save_model(trained.model, path)
    with pytest.raises(ConfigError, match="is no file of format 'pdr_est-gait-folds'"):
        load_folds(path)
