"""The records that pass between stages: frozen, arrays inside, SI units, map frame x east and y north."""

from dataclasses import dataclass
from enum import IntEnum, StrEnum

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


LATE_S = 5.0  # ours; a device that begins to record no later than this after another begins where the walk did


class Channel(StrEnum):
    """The sensor signals that the front end uses."""

    SPECIFIC_FORCE = "specific_force"  # m/s^2, device axes, points up when the device lies still
    ROTATION_RATE = "rotation_rate"  # rad/s, device axes
    MAGNETIC_FIELD = "magnetic_field"  # uT, device axes
    ATTITUDE = "attitude"  # quaternion w x y z, device -> level frame with z up


class CarryingMode(IntEnum):
    """How the phone is carried (MMPDR section III-A; OTHER is bag, belt, ear, armband)."""

    UNKNOWN = 0
    HOLDING = 1
    SWING = 2
    POCKET = 3
    OTHER = 4
    TRANS = 5


class Gait(IntEnum):
    """How the walker moves on foot."""

    UNKNOWN = 0
    WALKING = 1
    JOGGING = 2
    RUNNING = 3


@dataclass(frozen=True)
class SensorBlock:
    """Consecutive raw samples of one channel, with the recorder's own time stamps.

    time_s: (n,), on the device's clock; values: (n, 3), or (n, 4) for quaternions.
    """

    channel: Channel
    time_s: Array
    values: Array


@dataclass(frozen=True)
class Gap:
    """A stretch that a sensor did not record, or a jump of its clock, with the reason in words."""

    channel: str
    start_s: float
    end_s: float
    reason: str


@dataclass(frozen=True)
class ImuBlock:
    """Consecutive samples on the uniform working grid, all of one segment (no gap inside).

    first_index counts grid points since the start of the recording, time_s: (n,).
    specific_force_mps2, rotation_rate_radps: (n, 3), device axes; the latter None for a device without gyroscope.
    attitude: (n, 4) w first or None. magnetic_field_ut: (n, 3), NaN where it was not recorded, None where it is not
    needed.
    """

    first_index: int
    segment: int
    time_s: Array
    specific_force_mps2: Array
    rotation_rate_radps: Array | None
    attitude: Array | None = None
    magnetic_field_ut: Array | None = None


@dataclass(frozen=True)
class LevelBlock:
    """Samples with the direction of gravity known.

    up: (n, 3) unit vector up in device axes. acceleration_mps2: (n, 3) without gravity, device axes.
    vertical_mps2: (n,) acceleration upwards. yaw_rad: (n,) rotation about the vertical, wrapped, arbitrary zero.
    rotation_rate_radps: (n, 3) device axes, turn_rate_radps: (n,) about the vertical, less the bias that
    the attitude filter knows.
    mode: (n,) values of CarryingMode, mode_probability: (n,) how sure it is.
    magnetic_field_ut: (n, 3) device axes, NaN where it was not recorded; None for a device without magnetometer.
    """

    first_index: int
    segment: int
    time_s: Array
    up: Array
    acceleration_mps2: Array
    vertical_mps2: Array
    yaw_rad: Array
    rotation_rate_radps: Array
    turn_rate_radps: Array
    mode: NDArray[np.int8]
    mode_probability: Array
    magnetic_field_ut: Array | None = None

    def __len__(self) -> int:
        return len(self.time_s)


@dataclass(frozen=True)
class StepEvent:
    """A detected step: when the detector's feature happened, not when it was recognised.

    mode_probability: how sure the recogniser was of the mode at the step. compensated: nobody saw the step; its time
    is made up from the rhythm before it.
    """

    index: int
    time_s: float
    segment: int
    mode: CarryingMode
    confidence: float = 1.0
    mode_probability: float = 1.0
    compensated: bool = False


@dataclass(frozen=True)
class Step:
    """A step on its way through the front end; length and heading are NaN until their stage has run.

    start_s: when the movement of this step began. frequency_hz: reciprocal of the time since the previous
    step, 0 for the first step after a standstill (MMPDR section III-C). samples: from start to the event.
    heading_rad: direction of the step as the heading stage found it, arbitrary zero per segment. sigma_turn_rad: of
    the change of heading since the step before, beyond what every step has. follows_phone: whether the heading stage
    tells with it where the phone was turned against the body; else a change of the mode may have. recorded_share: of
    the movement, less than 1 for a step that had begun before the segment. straight_rad,
    sigma_straight_rad: heading of the straight path that the step lies on, with the same zero, and its standard
    deviation; NaN where no such path is known.
    gait_probability: of walking, jogging and running; NaN where gait is UNKNOWN. sigma_length_m: of the length,
    independent from step to step.
    """

    event: StepEvent
    start_s: float
    frequency_hz: float
    samples: LevelBlock
    length_m: float = float("nan")
    heading_rad: float = float("nan")
    sigma_turn_rad: float = 0.0
    follows_phone: bool = False
    straight_rad: float = float("nan")
    sigma_straight_rad: float = float("nan")
    gait: Gait = Gait.UNKNOWN
    gait_probability: tuple[float, float, float] = (float("nan"), float("nan"), float("nan"))
    sigma_length_m: float = float("nan")
    recorded_share: float = 1.0


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
