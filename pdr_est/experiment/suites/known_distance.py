"""Held phones over a known distance, with the steps counted by hand; a table `truth.csv` gives both for each file.

`scale_coverage68` is the share of the walks whose length is right within the standard deviation that the
configuration states for the scale of the step lengths (`odometry.sigma_length_scale`).

`distance_error_calibrated` is `distance_error` after calibrating the walker
(`calibration.step_length_fit.fit_calibration`) on two other walks of the set: the mean over all pairs of them.
`scale_coverage68_calibrated` is computed in the same way with the standard deviation that the calibration states
(`Calibration.sigma_next`).
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from pdr_est.calibration.step_length_fit import Calibration, CalibrationSteps, ScaleObservation, observe_scale
from pdr_est.errors import RecordingError
from pdr_est.evaluate.position_errors import distance_error, within_sigma
from pdr_est.evaluate.step_detection import count_error
from pdr_est.experiment.analysed_walk import AnalysedWalk
from pdr_est.experiment.recording_files import recordings
from pdr_est.experiment.scoring.track_scores import MetricPart, device_scores
from pdr_est.experiment.suite import Suite, TrackScores, WalkFile
from pdr_est.front_end.step_length import WalkerParams
from pdr_est.io.side_tables.known_distances import KnownDistance, read_known_distances
from pdr_est.pipeline import DeviceWalk
from pdr_est.types.ground_truth import Truth

_TRUTH = "truth"
_CALIBRATED = ("distance_error_calibrated", "scale_coverage68_calibrated")


@dataclass(frozen=True)
class DistanceCase:
    """A walk of known length as it takes part in calibrations.

    Attributes
    ----------
    steps : CalibrationSteps
        At least one step.
    distance_m : float
        Length of the walk, m.
    """

    steps: CalibrationSteps
    distance_m: float

    @property
    def observation(self) -> ScaleObservation:
        """Return the ratio of the true length to the modelled one."""
        return observe_scale([self.steps], self.distance_m / float(self.steps.length_m.sum()))

    def errors(self, calibration: Calibration) -> Mapping[str, float]:
        """Compute the calibrated metrics of the walk."""
        steps = self.steps.with_personal_constants(calibration.walker(WalkerParams()))
        return dict(zip(_CALIBRATED, _distance_metrics(steps, self.distance_m, calibration.sigma_next), strict=True))


def _distance_metrics(steps: CalibrationSteps, distance_m: float, sigma_log: float) -> tuple[float, float]:
    """Compute the relative error of the length, and if it is within its standard deviation."""
    length_m = float(steps.length_m.sum())
    return distance_error(length_m, distance_m), within_sigma(length_m, distance_m, sigma_log)


def _find(folder: Path) -> list[WalkFile]:
    """List the tables `*.csv` beside a truth.csv; raise RecordingError if that is missing or damaged."""
    tables = [(name, path) for name, path in recordings(folder, "*.csv") if path.parent == folder]
    truth_path = dict(tables).get(_TRUTH)
    if truth_path is None and tables:
        raise RecordingError(
            f"{folder}: no {_TRUTH}.csv beside the recordings: put the table with file,distance_m,steps there"
        )
    if truth_path is None:
        return []
    known = read_known_distances(truth_path)
    return [WalkFile(name, path, truth=_truth(known.get(name))) for name, path in tables if name != _TRUTH]


def _score(walk: AnalysedWalk) -> list[TrackScores]:
    """Score length and number of all steps; no estimator runs. Raises RecordingError without known distance."""
    return [_device_scores(walk, device) for device in walk.devices]


def _device_scores(walk: AnalysedWalk, device: DeviceWalk) -> TrackScores:
    truth = walk.recording.truth
    if truth.distance_m is None or truth.step_count is None:
        raise RecordingError(
            f"{walk.recording.name}: not in {_TRUTH}.csv: no distance and step count to compare with"
        )
    steps = CalibrationSteps.from_steps(device.steps)
    error, covered = _distance_metrics(steps, truth.distance_m, walk.config.odometry.sigma_length_scale)
    part = MetricPart(
        {
            "distance_error": error,
            "scale_coverage68": covered,
            "count_error": count_error(len(device.steps), truth.step_count),
        },
        {"true_steps": truth.step_count, "detected_steps": len(device.steps)},
    )
    if not device.steps:
        return device_scores(walk, device, part, MetricPart(missing=dict.fromkeys(_CALIBRATED, "no step found")))
    return replace(device_scores(walk, device, part), calibration=DistanceCase(steps, truth.distance_m))


def _truth(known: KnownDistance | None) -> Truth:
    return Truth() if known is None else Truth(distance_m=known.distance_m, step_count=known.step_count)


SUITE = Suite(
    name="known-distance",
    folder="known-distance",
    metrics=("distance_error", "scale_coverage68", *_CALIBRATED, "count_error"),
    find=_find,
    score=_score,
    calibrated_on=2,
    calibrated=_CALIBRATED,
)
