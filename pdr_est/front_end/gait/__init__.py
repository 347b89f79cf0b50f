"""Classify the gait of each step: walking, jogging or running.

* `features`: the features of a step.
* `classifier`: the stage that fills in the gait; `svm_scorer` is its arithmetic.
* `model`: the support-vector machines as plain data; `checksummed_json` reads and writes their files.
* `training`, `training_data`: training on labelled steps; `evaluation`: how well the gaits are recognised.
* `folds`: models that left some people out, to score people of the training data.
"""

from dataclasses import field
from pathlib import Path
from typing import Annotated, Any

from pdr_est.errors import ConfigError
from pdr_est.front_end.gait.classifier import GaitClassifier, UnknownGait
from pdr_est.front_end.gait.features import FeatureSet
from pdr_est.front_end.gait.folds import GaitFolds, load_folds
from pdr_est.front_end.gait.model import GaitModel, load_model, model_digest
from pdr_est.params import params
from pdr_est.parts import STAGE, PartName, is_external, named_part
from pdr_est.stage import Stage

__all__ = [
    "GAIT_METHODS",
    "GaitClassifier",
    "GaitFolds",
    "GaitModel",
    "GaitParams",
    "UnknownGait",
    "gait_model",
    "gait_stage",
    "is_shipped",
    "shipped_folds",
    "shipped_model",
]

GAIT_METHODS = ("auto", "uptime", "none")


@params
class GaitParams:
    """Choose the gait classifier."""

    method: Annotated[str, PartName(GAIT_METHODS)] = "auto"
    """Features: "auto" takes those of a stride, "uptime" those of the paper, "none" leaves the gait unknown."""
    parameters: dict[str, Any] = field(default_factory=dict, hash=False)
    """Arguments of a gait classifier of your own, which `method` names as module:attribute."""
    model: str | None = None
    """Path of a model file written by `pdr-est train-gait` for the same method; null is the shipped model."""


def gait_stage(rate_hz: float, parameters: GaitParams) -> Stage:
    """Make the configured stage Step -> Step.

    Raises
    ------
    ConfigError
        If the model cannot be used.
    PartError
        If a stage from outside the package cannot be made.
    """
    if is_external(parameters.method):
        own: Stage = named_part(parameters.method, parameters.parameters, STAGE, "gait.method", {"rate_hz": rate_hz})
        return own
    model = gait_model(parameters)
    return UnknownGait() if model is None else GaitClassifier(model)


def gait_model(parameters: GaitParams) -> GaitModel | None:
    """Load the configured model; return None for the method "none" and for a method from outside the package.

    Raises
    ------
    ConfigError
        If the model cannot be loaded, is of another method, or is given for the method "none".
    """
    if parameters.method == "none" or is_external(parameters.method):
        if parameters.model is not None:
            raise ConfigError(
                f'gait.model = {parameters.model}: the method "{parameters.method}" uses none: set gait.method, or '
                "leave it out"
            )
        return None
    if parameters.model is None:
        return shipped_model("uptime" if parameters.method == "uptime" else "auto")
    model = load_model(Path(parameters.model).expanduser())
    if model.features != parameters.method:
        raise ConfigError(
            f"gait.model = {parameters.model}: is a model of the method {model.features!r}: "
            f"set gait.method = {model.features}, or leave gait.model out"
        )
    return model


def is_shipped(model: GaitModel) -> bool:
    """Return True if a model is the one that comes with the package, wherever its file lies."""
    return model_digest(model) == model_digest(shipped_model(model.features))


def shipped_model(method: FeatureSet) -> GaitModel:
    """Load the model that comes with the package."""
    return load_model(_shipped(f"gait-{method}.json"))


def shipped_folds(method: FeatureSet) -> GaitFolds:
    """Load the models of the folds of the shipped model."""
    return load_folds(_shipped(f"gait-{method}-folds.json"))


def _shipped(name: str) -> Path:
    """Find a model file: within an installed package, or beside the package in the repository."""
    package = Path(__file__).resolve().parents[2]
    installed = package / "models" / name
    return installed if installed.is_file() else package.parent / "models" / name
