"""Blocks of sensor samples: raw, on the uniform working grid, and with the direction of gravity resolved."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array


class Channel(StrEnum):
    """Sensor channels that the front end uses."""

    SPECIFIC_FORCE = "specific_force"
    """Accelerometer including gravity, (n, 3) m/s², device axes; points up when the device lies still."""

    ROTATION_RATE = "rotation_rate"
    """Gyroscope, (n, 3) rad/s, device axes, right-handed."""

    MAGNETIC_FIELD = "magnetic_field"
    """Magnetometer, (n, 3) µT, device axes."""

    ATTITUDE = "attitude"
    """Attitude computed by the device, (n, 4) quaternion w x y z, device to level frame with z up."""


class AttitudeReference(StrEnum):
    """Direction that the yaw of a recorded attitude counts from."""

    UNKNOWN = "unknown"
    """Not stated by the recorder."""

    ARBITRARY = "arbitrary"
    """That of the device when the recording began, or any other that says nothing about north."""

    MAGNETIC_NORTH = "magnetic-north"
    """The level frame has x east and y north, by the magnetic field."""

    TRUE_NORTH = "true-north"
    """The level frame has x east and y north, corrected by the device for the magnetic declination."""

    @property
    def is_north(self) -> bool:
        """Tell whether the yaw counts from north."""
        return self in (AttitudeReference.MAGNETIC_NORTH, AttitudeReference.TRUE_NORTH)


@dataclass(frozen=True)
class SensorBlock:
    """Consecutive raw samples of one channel, with the time stamps of the recorder.

    Attributes
    ----------
    channel
        The sensor, which decides unit and shape of `values`.
    time_s
        (n,) s on the clock of the device.
    values
        (n, 3), or (n, 4) for quaternions.
    """

    channel: Channel
    time_s: Array
    values: Array


@dataclass(frozen=True)
class Gap:
    """A time span that a sensor did not record, or a jump of its clock.

    Attributes
    ----------
    channel
        Name of the channel.
    start_s, end_s
        Last sample before and first sample after the gap, s.
    reason
        The cause, in words.
    """

    channel: str
    start_s: float
    end_s: float
    reason: str


@dataclass(frozen=True)
class Hole:
    """The gap between two segments of the working grid, which some or all channels of the device have.

    Attributes
    ----------
    start_s, end_s
        Last sample before and first sample after it, s.
    duration_known
        False where the clock restarted, so that nobody knows how long the gap was.
    """

    start_s: float
    end_s: float
    duration_known: bool = True

    @property
    def duration_s(self) -> float:
        """Return the duration, s; infinite where it is not known."""
        return self.end_s - self.start_s if self.duration_known else float("inf")


@dataclass(frozen=True)
class ImuBlock:
    """Consecutive samples on the uniform working grid, all of one segment (no gap inside).

    Attributes
    ----------
    first_index
        Index of the first sample, counted in grid points from the start of the recording.
    segment
        Number of the segment; it increases after each gap.
    time_s
        (n,) s.
    specific_force_mps2
        (n, 3) m/s², device axes.
    rotation_rate_radps
        (n, 3) rad/s, device axes; None for a device without gyroscope.
    attitude
        (n, 4) quaternions w first, device to level, NaN where it was not recorded; None where the device's own
        attitude is not used.
    magnetic_field_ut
        (n, 3) µT, NaN where it was not recorded; None where no stage needs it.
    hole
        The gap before the first sample, where a segment after another one begins; else None.
    """

    first_index: int
    segment: int
    time_s: Array
    specific_force_mps2: Array
    rotation_rate_radps: Array | None
    attitude: Array | None = None
    magnetic_field_ut: Array | None = None
    hole: Hole | None = None


@dataclass(frozen=True)
class LevelBlock:
    """Consecutive samples whose direction of gravity is known.

    Attributes
    ----------
    first_index, segment, hole
        As in `ImuBlock`.
    time_s
        (n,) s.
    up
        (n, 3) upward unit vectors in device axes.
    acceleration_mps2
        (n, 3) m/s² without gravity, device axes.
    vertical_mps2
        (n,) m/s², upward component of the acceleration.
    yaw_rad
        (n,) rad, rotation about the vertical, wrapped, with an arbitrary zero; carried over gaps.
    rotation_rate_radps
        (n, 3) rad/s, device axes, corrected by the gyroscope bias that the attitude filter estimates.
    turn_rate_radps
        (n,) rad/s about the vertical, corrected in the same way.
    mode
        (n,) values of `CarryingMode`.
    mode_probability
        (n,) probability of that mode.
    magnetic_field_ut
        (n, 3) µT, device axes, NaN where it was not recorded; None for a device without magnetometer.
    recorded_yaw_rad
        (n,) rad, rotation about the vertical by the attitude that the device recorded, wrapped, NaN where there is
        none; None where that attitude is not used.
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
    recorded_yaw_rad: Array | None = None
    hole: Hole | None = None

    def __len__(self) -> int:
        return len(self.time_s)
