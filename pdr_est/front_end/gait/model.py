"""The gait model as plain data: two levels of support-vector machines, and what they were trained on.

UPTIME (Alzantot and Youssef 2012), figure 5: the first level tells slower from faster gaits, the second the gaits
within. On the slower side stands walking alone, so there is one machine a level: walking or faster, jogging or
running. A model is a JSON file of numbers and words; reading it executes nothing.
"""

from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from typing import Any, Literal

from pydantic import TypeAdapter, ValidationError

from pdr_est.errors import ConfigError
from pdr_est.front_end.gait.checksummed_json import content_sha256, read_checksummed, write_checksummed
from pdr_est.front_end.gait.features import FeatureSet, step_features
from pdr_est.params import Positive, params

FORMAT, VERSION = "pdr_est-gait", 1
REMEDY = "take the shipped model, or train one with `pdr-est train-gait`"

# Far beyond what training gives, and far from where the arithmetic of a score would overflow.
_STEEPEST = 1e4
_LARGEST = 1e6

Row = tuple[float, ...]
Confusion = tuple[tuple[int, int, int], tuple[int, int, int], tuple[int, int, int]]


@params
class SupportVectorMachine:
    """A support-vector machine on standardised features z = (x[columns] - mean) / scale.

    Its score is sum_i dual_i K(support_i, z) + intercept, above zero for the faster of its two sides.
    K(s, z) = exp(-gamma |s - z|^2) for the kernel rbf, s . z for the linear one, which has one support vector: its
    weights. support: (n, k), dual: (n,), columns, mean, scale: (k,). sigmoid: slope a and offset b of the
    probability 1 / (1 + exp(-(a score + b))) of the faster side (Platt), for scores as `pooled` gives them.
    """

    columns: tuple[int, ...]
    mean: Row
    scale: tuple[Positive, ...]
    kernel: Literal["rbf", "linear"]
    gamma: float
    support: tuple[Row, ...]
    dual: Row
    intercept: float
    sigmoid: tuple[float, float]


@params
class TrainingDataSet:
    """What was trained on: people and recordings, and steps of walking, jogging and running."""

    name: str
    people: int
    recordings: int
    steps: tuple[int, int, int]


@params
class GaitMetrics:
    """How the classifier did on steps of people whom it had not seen; all per step.

    faster_accuracy: walking against faster. balanced_accuracy: mean over the three gaits of the share found.
    confusion: rows true, columns found, walking, jogging, running. brier: mean squared error of the probability of
    the first level, and of the second on the data that train it.
    """

    faster_accuracy: dict[str, float]
    balanced_accuracy: dict[str, float]
    confusion: dict[str, Confusion]
    brier: tuple[float, float]


@params
class GaitModel:
    """A trained classifier. faster, running: the machines of the two levels. people: whom it has seen.

    metrics: of models that were trained in the same way with some people left out; None for such a model itself.
    """

    features: FeatureSet
    faster: SupportVectorMachine
    running: SupportVectorMachine
    people: tuple[str, ...]
    data: tuple[TrainingDataSet, ...]
    metrics: GaitMetrics | None = None


_MODEL = TypeAdapter(GaitModel)


def load_model(path: Path) -> GaitModel:
    """The model in a file that `save_model` wrote.

    Raises ConfigError for a file that is missing, damaged, changed, foreign or of another version.
    """
    content = read_checksummed(path, FORMAT, VERSION, REMEDY)
    del content["format"], content["version"]
    return model_from_dict(content, str(path))


def save_model(model: GaitModel, path: Path) -> str:
    """Write a model; the same model gives the same bytes. Returns its digest. Raises OutputError."""
    return write_checksummed(path, _document(model))


def model_digest(model: GaitModel) -> str:
    """The SHA-256 that a file of this model carries."""
    return content_sha256(_document(model))


def model_from_dict(content: Any, place: str) -> GaitModel:
    """A model from plain dictionaries. place: what to call it in messages.

    Raises ConfigError for missing and unknown keys, wrong types, and arrays that do not fit together.
    """
    try:
        model = _MODEL.validate_python(content)
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(str(part) for part in first["loc"])
        raise ConfigError(f"{place}: {key}: {first['msg']}: {REMEDY}") from error
    known = len(step_features(model.features).names)
    for level, machine in (("faster", model.faster), ("running", model.running)):
        if not _fits(machine, known):
            raise ConfigError(f"{place}: {level}: its arrays differ in length: {REMEDY}")
        for key, number, right in _oddities(machine):
            raise ConfigError(f"{place}: {level}.{key} = {number:g}: {right}: {REMEDY}")
    return model


def _document(model: GaitModel) -> dict[str, Any]:
    return {"format": FORMAT, "version": VERSION, **asdict(model)}


def _oddities(machine: SupportVectorMachine) -> Iterator[tuple[str, float, str]]:
    """Key and value of what no training gives, and what it has to be."""
    if machine.kernel == "rbf" and not machine.gamma > 0.0:
        yield "gamma", machine.gamma, "is no width of the kernel rbf, which is above 0"
    if machine.kernel == "linear" and len(machine.support) != 1:
        yield "support", len(machine.support), "vectors, where the kernel linear has one, its weights"
    slope, offset = machine.sigmoid
    if not abs(slope) <= _STEEPEST:
        yield "sigmoid.0", slope, f"is steeper than {_STEEPEST:g}"
    numbers = {"sigmoid.1": (offset,), "intercept": (machine.intercept,), "dual": machine.dual, "mean": machine.mean}
    for key, values in (*numbers.items(), *(("support", row) for row in machine.support)):
        for value in values:
            if not abs(value) <= _LARGEST:
                yield key, value, f"is beyond {_LARGEST:g}"


def _fits(machine: SupportVectorMachine, features: int) -> bool:
    """Whether the arrays of a machine belong together, and its columns are features."""
    width = len(machine.columns)
    return (
        width > 0
        and all(0 <= column < features for column in machine.columns)
        and len(machine.mean) == len(machine.scale) == width
        and len(machine.support) == len(machine.dual) > 0
        and all(len(row) == width for row in machine.support)
    )
