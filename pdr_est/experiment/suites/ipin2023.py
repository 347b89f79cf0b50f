"""IPIN 2023 competition, track 3, training logs: held phones, surveyed points marked while walking over them.

Errors are 2-D also where a walk changes floors.
"""

from pathlib import Path

from pdr_est.errors import RecordingError
from pdr_est.evaluate.position_errors import OPEN_METRICS
from pdr_est.experiment.recording_files import recordings
from pdr_est.experiment.scoring.positions import HELDOUT_METRICS, score_positions
from pdr_est.experiment.scoring.track_scores import MODE_METRIC, mode_truth
from pdr_est.experiment.suite import Suite, WalkFile
from pdr_est.preprocessing.trim import trim_recording
from pdr_est.types.recording import Recording
from pdr_est.types.steps import CarryingMode


def _find(folder: Path) -> list[WalkFile]:
    """List the logs `*.txt`."""
    held = mode_truth(CarryingMode.HOLDING)
    return [WalkFile(name, path, truth=held) for name, path in recordings(folder, "*.txt")]


def from_first_point(recording: Recording) -> Recording:
    """Cut off what is before the first surveyed point, where the phones are shaken for a minute to calibrate them.

    Raises
    ------
    RecordingError
        If there is no surveyed point.
    """
    positions = recording.truth.positions
    if positions is None or not len(positions.time_s):
        raise RecordingError(f"{recording.name}: no surveyed point (POSI): nothing to score the track against")
    return trim_recording(recording, float(positions.time_s.min()))


SUITE = Suite(
    name="ipin2023",
    folder="ipin2023",
    metrics=(*OPEN_METRICS, *HELDOUT_METRICS, MODE_METRIC),
    find=_find,
    prepare=from_first_point,
    score=score_positions,
    fixes="heldout",
)
