"""Held phones with the length of each stride (two steps) measured at the foot.

The first and the last stride of a walk and strides above 3 m are not scored (`evaluate.strides.scored_strides`).

* `stride_error`: a stride is two steps, as the metric's definition says: twice the mean length of the steps during
  the stride, and as many times that as their number asks for (`lengths_by_two_steps`). A step count that is wrong
  goes into `distance_error` and not into this.
* `stride_error_by_time`: the same strides with the way between their beginnings and ends (`lengths_by_time`). The
  times of the sensor at the foot scatter, so that even steps at the true speed are several percent off.
* `distance_error`: the way during all scored strides, by time, against the sum of their lengths.
* `scale_coverage68`: the share of the walks for which that way is right within the standard deviation that is stated
  for the scale of their steps: `odometry.sigma_length_scale`, after a calibration `Calibration.sigma_next`.
* `…_calibrated`: the same after calibrating the walker on one other walk of the set, the mean over all other walks.
  What is fitted is the ratio of true to modelled length of that walk's scored strides (`calibrate.fit`).

The rule of `stride_error` is the letter of that definition. It was not chosen blindly: how far a prototype was off by
either rule was known before, and it was less by two steps. Therefore both are always reported.
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
    shares,
    stride_error,
)
from pdr_est.experiment.recording_files import recordings
from pdr_est.experiment.scoring.track_scores import MetricPart, device_scores
from pdr_est.experiment.suite import AnalysedWalk, Scores, Suite, WalkFile, as_recorded
from pdr_est.frames import Array
from pdr_est.front_end.step_length import WalkerParams
from pdr_est.pipeline import DeviceWalk
from pdr_est.types.ground_truth import TrueStrides

_METRICS = ("stride_error", "stride_error_by_time", "distance_error", "scale_coverage68")
_CALIBRATED = tuple(f"{name}_calibrated" for name in _METRICS)


@dataclass(frozen=True)
class StrideCase:
    """The steps of a walk beside its strides. steps: all of the recording; strides: those scored."""

    steps: CalibrationSteps
    strides: TrueStrides

    @property
    def steps_within(self) -> int:
        """How many steps there are during the scored strides, rounded."""
        return round(float(self._shares().sum()))

    @property
    def observation(self) -> ScaleObservation:
        within = self.steps.weighted(self._shares().sum(axis=0))
        return observe_scale([within], float(self.strides.length_m.sum() / within.length_m.sum()))

    def errors(self, calibration: Calibration) -> Mapping[str, float]:
        steps = self.steps.with_personal_constants(calibration.walker(WalkerParams()))
        return dict(zip(_CALIBRATED, self._errors(steps, calibration.sigma_next), strict=True))

    def errors_uncalibrated(self, sigma_length_scale: float) -> Mapping[str, float]:
        """Of the lengths as the front end gave them, with the sigma that is stated for their scale."""
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
        return shares(self.steps.start_s, self.steps.end_s, self.strides)


def find(folder: Path) -> list[WalkFile]:
    """The tables `PDR_Raw_*.txt`."""
    return [WalkFile(name, path) for name, path in recordings(folder, "PDR_Raw_*.txt")]


def score(walk: AnalysedWalk) -> list[Scores]:
    """Lengths of strides and of the way; no estimator runs. Raises RecordingError when no stride can be scored."""
    return [_scores(walk, device) for device in walk.devices]


def _scores(walk: AnalysedWalk, device: DeviceWalk) -> Scores:
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
    find=find,
    prepare=as_recorded,
    score=score,
    calibrated_on=1,
    calibrated=_CALIBRATED,
)
