"""From a folder of recordings to a gait model with its card."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from datetime import date
from pathlib import Path

from pdr_est import pipeline
from pdr_est.config import Config
from pdr_est.errors import RecordingError
from pdr_est.front_end.gait import GaitParams
from pdr_est.front_end.gait.features import FeatureSet
from pdr_est.front_end.gait.folds import save_folds
from pdr_est.front_end.gait.model import save_model
from pdr_est.front_end.gait.training import TrainedGait, train_gait_model
from pdr_est.front_end.gait.training_data import LabelledSteps, labelled_steps
from pdr_est.io import read
from pdr_est.output.atomic_output import write_text
from pdr_est.training.gait_card import model_card
from pdr_est.training.gait_files import LabelledFile, labelled_files

ProgressCallback = Callable[[int, int], None]


def train_gait(
    data: Path, features: FeatureSet, on_progress: ProgressCallback = lambda done, total: None
) -> TrainedGait:
    """Train on every recording of a known gait in a folder; steps are those of the default configuration.

    Parameters
    ----------
    data : Path
        Data folder, see `gait_files`.
    features : FeatureSet
        Features of a stride (`auto`) or of a step (`uptime`).
    on_progress : callable
        Called with the number of finished recordings and of all.

    Raises
    ------
    RecordingError
        For recordings that cannot be used.
    ConfigError
        If there are too few people.
    """
    files = labelled_files(data)
    walks: list[LabelledSteps] = []
    for done, file in enumerate(files):
        on_progress(done, len(files))
        walks += _steps_of(file, features)
    on_progress(len(files), len(files))
    return train_gait_model(walks, features)


def write_trained(trained: TrainedGait, folder: Path, trained_on: date, recordings_sha256: str) -> None:
    """Write the model, its folds and its card.

    The last two arguments stand in the card only, so that the same steps give the same model, however the recordings
    are packed.

    Parameters
    ----------
    trained : TrainedGait
        Result of `train_gait`.
    folder : Path
        Existing folder.
    trained_on : date
        Date of the training.
    recordings_sha256 : str
        Result of `recordings_digest`.

    Raises
    ------
    OutputError
        If a file cannot be written.
    """
    name = f"gait-{trained.model.features}"
    save_model(trained.model, folder / f"{name}.json")
    save_folds(trained.folds, folder / f"{name}-folds.json")
    write_text(folder / f"{name}.md", model_card(trained, trained_on, recordings_sha256))


def _steps_of(file: LabelledFile, features: FeatureSet) -> Sequence[LabelledSteps]:
    """Find the steps of each device of a recording."""
    recording = read(file.path)
    gait = file.gait_of(recording)
    config = replace(Config(), gait=GaitParams(method="none"))
    walks = pipeline.analyse_recording(recording, config)
    for walk in walks:
        if not walk.steps:
            raise RecordingError(f"{file.path}: {walk.device}: no step found in {gait.name.lower()}: take it out")
    return [
        labelled_steps(walk.steps, features, person=file.person, data_set=file.data_set, gait=gait) for walk in walks
    ]
