"""Indoor Location Competition 2.0: phones held flat, waypoints clicked on the floor map about every 10 m."""

from pathlib import Path

from pdr_est.evaluate.position_errors import OPEN_METRICS
from pdr_est.experiment.recording_files import recordings
from pdr_est.experiment.scoring.positions import HELDOUT_METRICS, score_positions
from pdr_est.experiment.scoring.track_scores import MODE_METRIC, mode_truth
from pdr_est.experiment.suite import Suite, WalkFile
from pdr_est.types.steps import CarryingMode


def _find(folder: Path) -> list[WalkFile]:
    """List the logs `SITE/FLOOR/*.txt`."""
    held = mode_truth(CarryingMode.HOLDING)
    return [WalkFile(name, path, truth=held) for name, path in recordings(folder, "*.txt")]


SUITE = Suite(
    name="ilc20",
    folder="ilc20",
    metrics=(*OPEN_METRICS, *HELDOUT_METRICS, MODE_METRIC),
    find=_find,
    score=score_positions,
    fixes="heldout",
)
