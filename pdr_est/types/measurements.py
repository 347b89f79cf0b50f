"""Measurements."""

from dataclasses import dataclass

from pdr_est.types.sensors import Array
from pdr_est.types.steps import CarryingMode

LATE_S = 5.0  # ours; a device that begins to record no later than this after another begins where the walk did


@dataclass(frozen=True)
class StepOdometry:
    """Motion of one device from the end of the previous step to the end of this one.

    The walker turns by heading_change_rad and then moves length_m straight ahead, between start_s and time_s.
    covariance: (3, 3) of (forward m, left m, heading rad) in the body frame at the end of the step.
    observed is False for the bridge over a gap in the recording.
    """

    device: str
    time_s: float
    start_s: float
    length_m: float
    heading_change_rad: float
    covariance: Array
    mode: CarryingMode = CarryingMode.UNKNOWN
    observed: bool = True


@dataclass(frozen=True)
class HeadingPrior:
    """The heading of a device at a time, from a heading controller or a building's dominant directions.

    relative: heading_rad counts from a direction that is unknown in the map and common to all relative priors of the
    device: they tell the angles between the stretches of a walk, and nothing of north.
    """

    device: str
    time_s: float
    heading_rad: float
    sigma_rad: float
    robust: bool = True
    relative: bool = False


@dataclass(frozen=True)
class PositionFix:
    """An absolute position. position_m: (2,) east, north; covariance_m2: (2, 2)."""

    time_s: float
    position_m: Array
    covariance_m2: Array
    source: str = "waypoint"
    robust: bool = False


@dataclass(frozen=True)
class DeviceTether:
    """Two devices on one body are never farther apart than max_distance_m (Robust DR: 2R)."""

    device_a: str
    device_b: str
    time_s: float
    max_distance_m: float
    sigma_m: float


@dataclass(frozen=True)
class LoopClosure:
    """The walk of a device ends where it began, to sigma_m in each coordinate."""

    device: str
    sigma_m: float


Measurement = StepOdometry | HeadingPrior | PositionFix | DeviceTether | LoopClosure


@dataclass(frozen=True)
class StartPose:
    """Where the walk begins. A None means unknown: to be found from the fixes.

    With neither start nor fixes the track is in its own frame: origin at the start, first step to the east.
    """

    position_m: tuple[float, float] | None = None
    heading_rad: float | None = None
    sigma_position_m: float = 0.0
    sigma_heading_rad: float = 0.0


@dataclass(frozen=True)
class DeviceMeasurements:
    """What is known of one device's walk. start_s: time of its start pose."""

    device: str
    start_s: float
    measurements: tuple[Measurement, ...]
