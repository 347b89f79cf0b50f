"""Step detectors, one file each: stages LevelBlock -> StepEvent; and the stage that cuts the samples into steps.

* `bandpass_peaks`: the default. `step_evidence/` tells whether a peak is a step, and whether somebody walks;
  `stride_period` finds the period of the strides in a pocket.
* `mmpdr_peaks`: the peaks of MMPDR in each carrying mode. `mode_transition` makes up the steps of a transition.
* `uptime_fsm`: the state machine of UPTIME.
* `relative_threshold`: the alternating extremes of Robust DR.
* `local_variance`, `zero_crossing`: the baselines of UPTIME, on a common `hysteresis_detector`.
* `magnitude_peaks`: peaks of the magnitude, as textbooks have them; a yardstick.
* `sample_buffer`: the samples that a detector may still need.
* `segmentation`: from step events to steps with their samples.
"""

from dataclasses import field
from typing import Annotated, Any, Literal, get_args

from pdr_est.front_end.steps.bandpass_peaks import AutoStepParams, BandpassPeakDetector
from pdr_est.front_end.steps.local_variance import LocalVariance, LocalVarianceParams
from pdr_est.front_end.steps.magnitude_peaks import MagnitudePeaks, MagnitudePeaksParams
from pdr_est.front_end.steps.mmpdr_peaks import MmpdrStepParams, MmpdrSteps
from pdr_est.front_end.steps.relative_threshold import RelativeThreshold, RelativeThresholdParams
from pdr_est.front_end.steps.segmentation import SegmentationParams
from pdr_est.front_end.steps.uptime_fsm import UptimeFsm, UptimeFsmParams
from pdr_est.front_end.steps.zero_crossing import ZeroCrossing, ZeroCrossingParams
from pdr_est.params import params
from pdr_est.parts import STAGE, PartName, named_part
from pdr_est.stage import Stage

DetectorName = Literal[
    "auto", "mmpdr", "uptime-fsm", "relative-threshold", "local-variance", "zero-crossing", "magnitude-peaks"
]
DETECTORS: tuple[DetectorName, ...] = get_args(DetectorName)


@params
class StepsParams:
    """Choose the step detector; the parameters of each lie under its own name."""

    detector: Annotated[str, PartName(DETECTORS)] = "auto"
    """Name of the step detector."""
    parameters: dict[str, Any] = field(default_factory=dict, hash=False)
    """Arguments of a step detector of your own, which `detector` names as module:attribute."""
    auto: AutoStepParams = AutoStepParams()
    """Parameters of the detector "auto" (`BandpassPeakDetector`)."""
    mmpdr: MmpdrStepParams = MmpdrStepParams()
    """Parameters of the detector "mmpdr"."""
    uptime_fsm: UptimeFsmParams = UptimeFsmParams()
    """Parameters of the detector "uptime-fsm"."""
    relative_threshold: RelativeThresholdParams = RelativeThresholdParams()
    """Parameters of the detector "relative-threshold"."""
    local_variance: LocalVarianceParams = LocalVarianceParams()
    """Parameters of the detector "local-variance"."""
    zero_crossing: ZeroCrossingParams = ZeroCrossingParams()
    """Parameters of the detector "zero-crossing"."""
    magnitude_peaks: MagnitudePeaksParams = MagnitudePeaksParams()
    """Parameters of the detector "magnitude-peaks"."""
    segmentation: SegmentationParams = SegmentationParams()
    """Parameters of the cut of the samples into steps."""


def step_detector(rate_hz: float, parameters: StepsParams) -> Stage:
    """Make the configured step detector.

    Raises
    ------
    PartError
        If a stage from outside the package cannot be made.
    """
    match parameters.detector:
        case "auto":
            return BandpassPeakDetector(rate_hz, parameters.auto)
        case "mmpdr":
            return MmpdrSteps(rate_hz, parameters.mmpdr)
        case "uptime-fsm":
            return UptimeFsm(rate_hz, parameters.uptime_fsm)
        case "relative-threshold":
            return RelativeThreshold(rate_hz, parameters.relative_threshold)
        case "local-variance":
            return LocalVariance(rate_hz, parameters.local_variance)
        case "zero-crossing":
            return ZeroCrossing(rate_hz, parameters.zero_crossing)
        case "magnitude-peaks":
            return MagnitudePeaks(rate_hz, parameters.magnitude_peaks)
    own: Stage = named_part(parameters.detector, parameters.parameters, STAGE, "steps.detector", {"rate_hz": rate_hz})
    return own
