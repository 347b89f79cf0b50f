"""Oxford Inertial Odometry Dataset: an iPhone carried in several ways, with a true pose for every sample.

The summary averages the large-scale office loops; the walks in a small Vicon room are averaged apart. Both are
grouped by the position of the phone.
"""

import re
from pathlib import Path

from pdr_est.evaluate.position_errors import OPEN_METRICS
from pdr_est.experiment.recording_files import recordings
from pdr_est.experiment.scoring.positions import score_positions
from pdr_est.experiment.scoring.track_scores import MODE_METRIC, mode_truth
from pdr_est.experiment.suite import Suite, WalkFile
from pdr_est.types.ground_truth import Truth
from pdr_est.types.steps import CarryingMode

_LARGE_SCALE = "large-scale"

# Folder of the data set -> position of the phone in all its walks.
_POSITION_OF_FOLDER = {"handheld": "hand", "pocket": "pocket", "handbag": "bag", "trolley": "trolley"}

# Position -> carrying mode; a phone in a bag or on a trolley has no mode of ours.
_MODE_OF_POSITION = {"hand": CarryingMode.HOLDING, "pocket": CarryingMode.POCKET}

# Folder of mixed walks -> number of the walk -> position, found from the statistics of the signals.
_POSITION_OF_WALK = {
    "large-scale/floor1": {
        1: "hand",
        3: "hand",
        4: "pocket",
        5: "pocket",
        6: "pocket",
        7: "bag",
        8: "bag",
        10: "bag",
    },
    "multi-users/user5": {1: "hand", 3: "hand", 5: "pocket"},
}


def _find(folder: Path) -> list[WalkFile]:
    """List the tables `…/imuN.csv`, without those of the folders `raw`, whose rows are not paired with poses."""
    walks = recordings(folder, "imu*.csv")
    return [_walk(name, path) for name, path in walks if "raw" not in Path(name).parts]


def position_of(name: str) -> str | None:
    """Return the position of the phone in the walk of this name; None if it is not known."""
    for part in Path(name).parts:
        if part in _POSITION_OF_FOLDER:
            return _POSITION_OF_FOLDER[part]
    number = re.search(r"\d+$", name)
    for folder, positions in _POSITION_OF_WALK.items():
        if number and f"{folder}/" in f"{name}/":
            return positions.get(int(number.group()))
    return None


def _walk(name: str, path: Path) -> WalkFile:
    position = position_of(name)
    large = _LARGE_SCALE in Path(name).parts
    mode = None if position is None else _MODE_OF_POSITION.get(position)
    return WalkFile(
        name=name,
        path=path,
        labels={"position": position},
        group=f"{_LARGE_SCALE if large else 'vicon'}/{position or 'unknown'}",
        headline=large,
        truth=Truth() if mode is None else mode_truth(mode),
    )


SUITE = Suite(
    name="oxiod",
    folder="oxiod",
    metrics=(*OPEN_METRICS, MODE_METRIC),
    find=_find,
    score=score_positions,
    fixes="none",
)
