"""Step detectors, one file each: stages LevelBlock -> StepEvent."""

from dataclasses import field
from typing import Annotated, Any, Literal, get_args

from pdr_est.front_end.steps.bandpass_peaks import AutoStepParams, BandpassPeakDetector
from pdr_est.front_end.steps.local_variance import LocalVariance, LocalVarianceParams
from pdr_est.front_end.steps.mmpdr_peaks import MmpdrStepParams, MmpdrSteps
from pdr_est.front_end.steps.relative_threshold import RelativeThreshold, RelativeThresholdParams
from pdr_est.front_end.steps.segmentation import SegmentationParams
from pdr_est.front_end.steps.uptime_fsm import UptimeFsm, UptimeFsmParams
from pdr_est.front_end.steps.zero_crossing import ZeroCrossing, ZeroCrossingParams
from pdr_est.params import params
from pdr_est.parts import STAGE, PartName, named_part
from pdr_est.stage import Stage

DetectorName = Literal["auto", "mmpdr", "uptime-fsm", "relative-threshold", "local-variance", "zero-crossing"]
DETECTORS: tuple[DetectorName, ...] = get_args(DetectorName)


@params
class StepsParams:
    """detector: which step detector; the parameters of each lie under its own name."""

    detector: Annotated[str, PartName(DETECTORS)] = "auto"
    parameters: dict[str, Any] = field(default_factory=dict, hash=False)
    """Arguments of a step detector of your own, which `detector` names as module:attribute."""
    auto: AutoStepParams = AutoStepParams()
    mmpdr: MmpdrStepParams = MmpdrStepParams()
    uptime_fsm: UptimeFsmParams = UptimeFsmParams()
    relative_threshold: RelativeThresholdParams = RelativeThresholdParams()
    local_variance: LocalVarianceParams = LocalVarianceParams()
    zero_crossing: ZeroCrossingParams = ZeroCrossingParams()
    segmentation: SegmentationParams = SegmentationParams()


def step_detector(rate_hz: float, parameters: StepsParams) -> Stage:
    """Make the configured step detector. Raises PartError for one from outside the package that cannot be made."""
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
    own: Stage = named_part(parameters.detector, parameters.parameters, STAGE, "steps.detector", {"rate_hz": rate_hz})
    return own
