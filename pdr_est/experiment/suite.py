"""Definition of a benchmark suite.

A new suite is one module of `suites/` that makes one `Suite`, and its line in `suites/__init__.py`.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol

from pdr_est.calibration.step_length_fit import Calibration, ScaleObservation
from pdr_est.experiment.analysed_walk import AnalysedWalk
from pdr_est.experiment.config import FixesProtocol
from pdr_est.types.floor_plan import FloorPlan
from pdr_est.types.ground_truth import Truth
from pdr_est.types.outcome import TrackOutcome
from pdr_est.types.recording import Recording


@dataclass(frozen=True)
class WalkFile:
    """One walk of a suite on disk.

    Attributes
    ----------
    name : str
        Path of the main recording relative to the folder of the suite, without extensions.
    path : Path
        File or folder that is read.
    labels : Mapping
        Further keys of the result rows, such as the position of the phone; None where a value is not known.
    group : str or None
        Group that the walk is also averaged in.
    headline : bool
        True if the walk counts in the summary of the suite.
    truth : Truth
        Ground truth that the data set states outside of the recording.
    """

    name: str
    path: Path
    labels: Mapping[str, str | None] = field(default_factory=dict)
    group: str | None = None
    headline: bool = True
    truth: Truth = field(default_factory=Truth)


class CalibrationCase(Protocol):
    """A scored walk as it takes part in the calibration of its walker; it is sent between processes."""

    @property
    def observation(self) -> ScaleObservation | None:
        """Return what the walk says about its walker, for the calibration of other walks; None if it is nothing."""

    def errors(self, calibration: Calibration) -> Mapping[str, float]:
        """Compute the metrics of this walk, by name, with the constants of a calibrated walker."""


@dataclass(frozen=True)
class TrackScores:
    """Scores of one track of a walk.

    A metric of the suite that is in neither `values` nor `missing` does not apply to this walk, such as the false
    steps of a person who walks.

    Attributes
    ----------
    track : str
        Name of the device, "device" if there is only one, or "fused" for the person.
    mode : str
        Carrying mode that was recognised for most of the walking time.
    values : Mapping
        Metric -> value; a value that is not finite counts as missing.
    counts : Mapping
        Name -> number of points or steps that the metrics are based on.
    missing : Mapping
        Metric -> reason why it cannot be computed for this walk.
    predicted : Mapping
        Label -> number of steps that got it, for suites that classify steps.
    calibration : CalibrationCase or None
        Input of the metrics that are computed after a calibration on other walks.
    """

    track: str
    mode: str
    values: Mapping[str, float]
    counts: Mapping[str, int] = field(default_factory=dict)
    missing: Mapping[str, str] = field(default_factory=dict)
    predicted: Mapping[str, int] = field(default_factory=dict)
    calibration: CalibrationCase | None = None


@dataclass(frozen=True)
class ConfusionMatrix:
    """Confusion matrix of step classes.

    Attributes
    ----------
    counts : Mapping
        True class -> label -> number of steps.
    shares : Mapping
        Recalls and accuracies that follow from the counts, by name.
    """

    counts: Mapping[str, Mapping[str, int]]
    shares: Mapping[str, float]


def no_confusions(_rows: Sequence[TrackOutcome]) -> Mapping[str, ConfusionMatrix]:
    """Return nothing: `Suite.confusions` of a suite that does not classify steps."""
    return {}


def nothing_beside(_path: Path) -> Truth:
    """Return no ground truth: `Suite.truth_beside` of a suite whose recordings have no file with it beside them."""
    return Truth()


def no_plan_beside(_path: Path) -> FloorPlan | None:
    """Return None: `Suite.plan_beside` of a suite whose recordings have no floor plan beside them."""
    return None


@dataclass(frozen=True)
class ProfileGroup:
    """Walks that learn from each other.

    Attributes
    ----------
    name : str
        Name of the group.
    sigma_walk : float
        Standard deviation of the logarithm of a walk's length scale about that of the group.
    """

    name: str
    sigma_walk: float


def unknown_height(_path: Path) -> float | None:
    """Return None: `Suite.walker_height` of a suite that does not know the heights of its walkers."""
    return None


def as_recorded(recording: Recording) -> Recording:
    """Return the recording unchanged: `Suite.prepare` of most suites."""
    return recording


@dataclass(frozen=True)
class Suite:
    """A benchmark suite; its functions stand at module level so that they can be sent to other processes.

    Attributes
    ----------
    name : str
        Name on the command line.
    folder : str
        Name of its folder inside the data folder, "." for the data folder itself.
    metrics : tuple of str
        Metrics in the order of the table.
    find : Callable
        Lists the walks in that folder.
    score : Callable
        Computes the scores of a walk, one for each track.
    prepare : Callable
        Changes a recording before any stage sees it.
    truth_beside : Callable
        Reads the ground truth of a recording from files beside it, by the path of the recording.
    plan_beside : Callable
        Reads the floor plan of a recording from files beside it, by the path of the recording; None without any.
    walker_height : Callable
        Reads the height of the walker, m, from files beside a recording, by its path; None where it is not known.
    fixes : "none", "heldout" or None
        Fixes of the benchmark; None for a suite whose metrics need no true positions.
    calibrated_on : int
        Number of other walks on which the walker is calibrated for the metrics `calibrated`.
    calibrated : tuple of str
        Metrics after that calibration.
    profile_group : Callable or None
        Finds the group of a walk, by its row, for the metrics `calibrated` after learning from all other walks of
        the group (`scoring.profiles`); it returns None for a walk of nobody known.
    confusions : Callable
        Computes the confusion matrices, by name, from the rows of one variant.
    """

    name: str
    folder: str
    metrics: tuple[str, ...]
    find: Callable[[Path], list[WalkFile]]
    score: Callable[[AnalysedWalk], list[TrackScores]]
    prepare: Callable[[Recording], Recording] = as_recorded
    truth_beside: Callable[[Path], Truth] = nothing_beside
    plan_beside: Callable[[Path], FloorPlan | None] = no_plan_beside
    walker_height: Callable[[Path], float | None] = unknown_height
    fixes: FixesProtocol | None = None
    calibrated_on: int = 0
    calibrated: tuple[str, ...] = ()
    profile_group: Callable[[TrackOutcome], ProfileGroup | None] | None = None
    confusions: Callable[[Sequence[TrackOutcome]], Mapping[str, ConfusionMatrix]] = no_confusions
