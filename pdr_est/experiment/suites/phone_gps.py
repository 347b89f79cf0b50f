"""An Android phone on playing fields, swung in the hand or held, with the recorded GPS fixes as ground truth."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from pdr_est.errors import RecordingError
from pdr_est.experiment.recording_files import recordings
from pdr_est.experiment.scoring.positions import score_positions
from pdr_est.experiment.scoring.track_scores import MODE_METRIC, mode_truth
from pdr_est.experiment.suite import Suite, WalkFile
from pdr_est.types.ground_truth import TruePositions
from pdr_est.types.recording import Recording
from pdr_est.types.steps import CarryingMode


def _find(folder: Path) -> list[WalkFile]:
    """List the tables `*.csv`; if the name contains "swing" the phone was swung, otherwise held."""
    return [_walk(name, path) for name, path in recordings(folder, "*.csv")]


def with_fixes_as_truth(recording: Recording) -> Recording:
    """Turn the GPS fixes into true positions, and remove all fixes, so that no stage can see them.

    Raises
    ------
    RecordingError
        If there is no GPS fix.
    """
    fixes = [fix for fix in recording.fixes if fix.source == "gps"]
    if not fixes:
        raise RecordingError(f"{recording.name}: no GPS fix: nothing to score the track against")
    positions = TruePositions(
        time_s=np.array([fix.time_s for fix in fixes]),
        position_m=np.array([fix.position_m for fix in fixes]),
        sigma_m=float(np.sqrt(np.median([fix.covariance_m2[0, 0] for fix in fixes]))),
        source="gps",
    )
    return replace(recording, truth=replace(recording.truth, positions=positions), fixes=())


def _walk(name: str, path: Path) -> WalkFile:
    mode = CarryingMode.SWING if "swing" in Path(name).name.lower() else CarryingMode.HOLDING
    return WalkFile(name, path, group=mode.name.lower(), truth=mode_truth(mode))


SUITE = Suite(
    name="phone-gps",
    folder="phone-gps",
    metrics=("ate_rigid_m", "length_ratio", "final_drift", MODE_METRIC),
    find=_find,
    prepare=with_fixes_as_truth,
    score=score_positions,
    fixes="none",
)
