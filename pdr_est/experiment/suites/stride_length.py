"""Held phones with the length of each stride (two steps) measured at the foot.

The first and the last stride of a walk and strides above 3 m are not scored (`stride_lengths.scored_strides`).

* `stride_error`: a stride is two steps, as the definition of the metric says: twice the mean length of the steps
  during the stride, times the number of strides that these steps are (`lengths_by_two_steps`). A wrong number of
  steps changes `distance_error` and not this metric.
* `stride_error_by_time`: the same strides with the distance between their beginnings and ends (`lengths_by_time`).
  The times of the sensor at the foot scatter, so that even steps of the true speed are wrong by several percent.
* `distance_error`: the distance during all scored strides, by time, against the sum of their lengths.
* `scale_coverage68`: the share of the walks for which that distance is right within the standard deviation that is
  stated for the scale of the step lengths: `odometry.sigma_length_scale`, after a calibration
  `Calibration.sigma_next`.
* `…_calibrated`: the same after calibrating the walker on one other walk of the set, the mean over all other walks.
  The ratio of the true to the modelled length of that walk's scored strides is fitted
  (`calibration.step_length_fit.fit_calibration`).

Both rules for the length of a stride are always reported, because the errors of a prototype by both rules (smaller
by two steps) were known when the rule of `stride_error` was chosen.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from pdr_est.calibration.step_length_fit import Calibration, CalibrationSteps, ScaleObservation, observe_scale
from pdr_est.errors import RecordingError
from pdr_est.evaluate.position_errors import distance_error, within_sigma
from pdr_est.evaluate.stride_lengths import (
    LONGEST_STRIDE_M,
    lengths_by_time,
    lengths_by_two_steps,
    scored_strides,
    step_shares,
    stride_error,
)
from pdr_est.experiment.analysed_walk import AnalysedWalk
from pdr_est.experiment.recording_files import recordings
from pdr_est.experiment.scoring.track_scores import MetricPart, device_scores
from pdr_est.experiment.suite import Suite, TrackScores, WalkFile
from pdr_est.frames import Array
from pdr_est.front_end.step_length import WalkerParams
from pdr_est.pipeline import DeviceWalk
from pdr_est.types.ground_truth import TrueStrides

_METRICS = ("stride_error", "stride_error_by_time", "distance_error", "scale_coverage68")
_CALIBRATED = tuple(f"{name}_calibrated" for name in _METRICS)


@dataclass(frozen=True)
class StrideCase:
    """The steps of a walk beside its measured strides.

    Attributes
    ----------
    steps : CalibrationSteps
        All steps of the recording.
    strides : TrueStrides
        The strides that are scored.
    """

    steps: CalibrationSteps
    strides: TrueStrides

    @property
    def steps_within(self) -> int:
        """Number of steps during the scored strides, rounded."""
        return round(float(self._shares().sum()))

    @property
    def observation(self) -> ScaleObservation:
        """Return the ratio of the true to the modelled length of the scored strides."""
        within = self.steps.weighted(self._shares().sum(axis=0))
        return observe_scale([within], float(self.strides.length_m.sum() / within.length_m.sum()))

    def errors(self, calibration: Calibration) -> Mapping[str, float]:
        """Compute the calibrated metrics of the walk."""
        steps = self.steps.with_personal_constants(calibration.walker(WalkerParams()))
        return dict(zip(_CALIBRATED, self._errors(steps, calibration.sigma_next), strict=True))

    def errors_uncalibrated(self, sigma_length_scale: float) -> Mapping[str, float]:
        """Compute the metrics of the lengths from the front end, with the standard deviation of their scale."""
        return dict(zip(_METRICS, self._errors(self.steps, sigma_length_scale), strict=True))

    def _errors(self, steps: CalibrationSteps, sigma_log: float) -> tuple[float, float, float, float]:
        share, true_m = self._shares(), self.strides.length_m
        by_time_m = lengths_by_time(share, steps.length_m)
        way_m, true_way_m = float(by_time_m.sum()), float(true_m.sum())
        return (
            stride_error(lengths_by_two_steps(share, steps.length_m), true_m),
            stride_error(by_time_m, true_m),
            distance_error(way_m, true_way_m),
            within_sigma(way_m, true_way_m, sigma_log),
        )

    def _shares(self) -> Array:
        return step_shares(self.steps.start_s, self.steps.end_s, self.strides)


def _find(folder: Path) -> list[WalkFile]:
    """List the tables `PDR_Raw_*.txt`."""
    return [WalkFile(name, path) for name, path in recordings(folder, "PDR_Raw_*.txt")]


def _score(walk: AnalysedWalk) -> list[TrackScores]:
    """Score stride lengths and distance; no estimator runs. Raises RecordingError if no stride can be scored."""
    return [_device_scores(walk, device) for device in walk.devices]


def _device_scores(walk: AnalysedWalk, device: DeviceWalk) -> TrackScores:
    truth = walk.recording.truth.strides
    if truth is None or not len(truth.length_m):
        raise RecordingError(f"{walk.recording.name}: no stride to compare with: none measured from beginning to end")
    strides = scored_strides(truth)
    if not len(strides.length_m):
        too_long = int((truth.length_m[:-1] > LONGEST_STRIDE_M).sum())
        raise RecordingError(
            f"{walk.recording.name}: no stride to compare with: {len(truth.length_m)} measured from beginning to "
            f"end, left out {too_long} above {LONGEST_STRIDE_M:g} m and the last"
        )
    case = StrideCase(CalibrationSteps.from_steps(device.steps), strides)
    counts = {"true_strides": len(strides.length_m), "detected_steps": case.steps_within}
    part = MetricPart(case.errors_uncalibrated(walk.config.odometry.sigma_length_scale), counts)
    if case.steps_within:
        return replace(device_scores(walk, device, part), calibration=case)
    return device_scores(walk, device, part, MetricPart(missing=dict.fromkeys(_CALIBRATED, "no step found")))


SUITE = Suite(
    name="stride-length",
    folder="stride-length",
    metrics=(*_METRICS, *_CALIBRATED),
    find=_find,
    score=_score,
    calibrated_on=1,
    calibrated=_CALIBRATED,
)
