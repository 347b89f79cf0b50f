"""The gait model as plain data: two levels of support-vector machines, and a summary of their training data.

In UPTIME the first level tells slower from faster gaits, the second the gaits within. On the slower side stands
walking alone, so there is one machine for each level: walking or faster, jogging or running. A model is a JSON file
of numbers and words; reading it executes nothing.

References
----------
UPTIME: Alzantot and Youssef, WCNC 2012, section III-B, Figure 5.
"""

from collections.abc import Iterator
from dataclasses import asdict
from functools import cache
from pathlib import Path
from typing import Any, Literal

from pydantic import TypeAdapter, ValidationError

from pdr_est.errors import ConfigError
from pdr_est.front_end.gait.checksummed_json import content_sha256, read_checksummed, write_checksummed
from pdr_est.front_end.gait.features import FeatureSet, step_features
from pdr_est.params import Positive, params

FORMAT, VERSION = "pdr_est-gait", 1
REMEDY = "take the shipped model, or train one with `pdr-est train-gait`"

# Limits far beyond what training gives, and far from where the arithmetic of a score would overflow.
_STEEPEST = 1e4
_LARGEST = 1e6

Row = tuple[float, ...]
Confusion = tuple[tuple[int, int, int], tuple[int, int, int], tuple[int, int, int]]


@params
class SupportVectorMachine:
    """A support-vector machine on standardised features z = (x[columns] - mean) / scale.

    Its score is sum_i dual_i K(support_i, z) + intercept, above zero for the faster of its two sides. K(s, z) is
    exp(-gamma |s - z|^2) for the kernel rbf and s . z for the linear one.
    """

    columns: tuple[int, ...]
    """Columns (k,) of the features that the machine takes."""
    mean: Row
    """Means (k,) of these features."""
    scale: tuple[Positive, ...]
    """Standard deviations (k,) of these features."""
    kernel: Literal["rbf", "linear"]
    """Kernel; the linear one has one support vector, its weights."""
    gamma: float
    """Inverse squared width of the kernel rbf; 0 for the linear kernel."""
    support: tuple[Row, ...]
    """Support vectors (n, k)."""
    dual: Row
    """Dual coefficients (n,)."""
    intercept: float
    """Constant term of the score."""
    sigmoid: tuple[float, float]
    """Slope a and offset b of the probability 1 / (1 + exp(-(a score + b))) of the faster side (Platt), for pooled
    scores as `StepTable.pooled` gives them.
    """


@params
class TrainingDataSet:
    """Summary of a data set that a model was trained on."""

    name: str
    """Name of the data set."""
    people: int
    """Number of people."""
    recordings: int
    """Number of recordings."""
    steps: tuple[int, int, int]
    """Numbers of steps of walking, jogging and running."""


@params
class GaitMetrics:
    """Accuracy of the classifier on steps of people whom it had not seen; all figures are per step."""

    faster_accuracy: dict[str, float]
    """Accuracy of walking against faster gaits, by data set and for all."""
    balanced_accuracy: dict[str, float]
    """Mean over the three gaits of the share of steps that were recognised, by data set and for all."""
    confusion: dict[str, Confusion]
    """Confusion matrices, by data set and for all: rows true, columns classified; walking, jogging, running."""
    brier: tuple[float, float]
    """Mean squared error of the probability of the first level, and of the second on the data that train it."""


@params
class GaitModel:
    """A trained classifier of two levels."""

    features: FeatureSet
    """Feature set of the machines."""
    faster: SupportVectorMachine
    """Machine of the first level: walking or faster."""
    running: SupportVectorMachine
    """Machine of the second level: jogging or running."""
    people: tuple[str, ...]
    """People whose steps the model was trained on."""
    data: tuple[TrainingDataSet, ...]
    """Summary of the training data."""
    metrics: GaitMetrics | None = None
    """Metrics of models trained in the same way with some people left out; null for such a model itself."""


@cache
def _validator() -> TypeAdapter[GaitModel]:
    """Build the validator at its first use, because that is slow."""
    return TypeAdapter(GaitModel)


def load_model(path: Path) -> GaitModel:
    """Read the model from a file that `save_model` wrote.

    Raises
    ------
    ConfigError
        If the file is missing, damaged, changed, foreign or of another version.
    """
    content = read_checksummed(path, FORMAT, VERSION, REMEDY)
    del content["format"], content["version"]
    return model_from_dict(content, str(path))


def save_model(model: GaitModel, path: Path) -> str:
    """Write a model to a file; the same model gives the same bytes.

    Returns
    -------
    str
        Its checksum.

    Raises
    ------
    OutputError
        If the file cannot be written.
    """
    return write_checksummed(path, _document(model))


def model_digest(model: GaitModel) -> str:
    """Compute the SHA-256 that a file of this model carries."""
    return content_sha256(_document(model))


def model_from_dict(content: Any, place: str) -> GaitModel:
    """Make a model from plain dictionaries.

    Parameters
    ----------
    content : Any
        The document.
    place : str
        Name of the document in messages.

    Raises
    ------
    ConfigError
        If keys are missing or unknown, types are wrong, arrays do not fit together, or numbers are implausible.
    """
    try:
        model = _validator().validate_python(content)
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(str(part) for part in first["loc"])
        raise ConfigError(f"{place}: {key}: {first['msg']}: {REMEDY}") from error
    known = len(step_features(model.features).names)
    for level, machine in (("faster", model.faster), ("running", model.running)):
        if not _arrays_match(machine, known):
            raise ConfigError(f"{place}: {level}: its arrays differ in length: {REMEDY}")
        for key, number, expected in _implausible_numbers(machine):
            raise ConfigError(f"{place}: {level}.{key} = {number:g}: {expected}: {REMEDY}")
    return model


def _document(model: GaitModel) -> dict[str, Any]:
    return {"format": FORMAT, "version": VERSION, **asdict(model)}


def _implausible_numbers(machine: SupportVectorMachine) -> Iterator[tuple[str, float, str]]:
    """Yield key, value and remark of each number that no training gives."""
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


def _arrays_match(machine: SupportVectorMachine, features: int) -> bool:
    """Return True if the lengths of a machine's arrays agree and its columns are features."""
    width = len(machine.columns)
    return (
        width > 0
        and all(0 <= column < features for column in machine.columns)
        and len(machine.mean) == len(machine.scale) == width
        and len(machine.support) == len(machine.dual) > 0
        and all(len(row) == width for row in machine.support)
    )
