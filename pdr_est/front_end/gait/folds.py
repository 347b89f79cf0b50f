"""Models that leave some people out, so that people of the training data can be scored by one that never saw them."""

from dataclasses import asdict
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter, ValidationError

from pdr_est.errors import ConfigError
from pdr_est.front_end.gait.checksummed_json import read_checksummed, write_checksummed
from pdr_est.front_end.gait.model import REMEDY, GaitModel, model_from_dict
from pdr_est.params import params

FORMAT, VERSION = "pdr_est-gait-folds", 1


@params
class GaitFolds:
    """The models of all folds, and the fold of each person."""

    models: tuple[GaitModel, ...]
    """Models, one for each fold, trained without the people of the fold."""
    fold_of: dict[str, int]
    """Number of the fold of each person."""

    def model_for(self, person: str) -> GaitModel | None:
        """Return the model that never saw this person.

        It is None for a person outside the training data, whom no model saw.
        """
        fold = self.fold_of.get(person)
        return None if fold is None else self.models[fold]


_FOLD_OF = TypeAdapter(dict[str, int])


def save_folds(folds: GaitFolds, path: Path) -> str:
    """Write the folds to a file; the same folds give the same bytes.

    Returns
    -------
    str
        Their checksum.

    Raises
    ------
    OutputError
        If the file cannot be written.
    """
    return write_checksummed(path, {"format": FORMAT, "version": VERSION, **asdict(folds)})


def load_folds(path: Path) -> GaitFolds:
    """Read the folds from a file that `save_folds` wrote.

    Raises
    ------
    ConfigError
        If the file is missing, damaged, changed, foreign or of another version.
    """
    content = read_checksummed(path, FORMAT, VERSION, REMEDY)
    documents: Any = content.get("models")
    if not isinstance(documents, list):
        raise ConfigError(f"{path}: models: is no list: {REMEDY}")
    models = tuple(model_from_dict(document, f"{path}: models.{i}") for i, document in enumerate(documents))
    try:
        fold_of = _FOLD_OF.validate_python(content.get("fold_of"))
    except ValidationError as error:
        raise ConfigError(f"{path}: fold_of: {error.errors()[0]['msg']}: {REMEDY}") from error
    for person, fold in fold_of.items():
        if not 0 <= fold < len(models) or person in models[fold].people:
            raise ConfigError(f"{path}: fold_of.{person} = {fold}: is no model without this person: {REMEDY}")
    return GaitFolds(models=models, fold_of=fold_of)
