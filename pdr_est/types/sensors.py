"""Sensors."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Channel(StrEnum):
    """The sensor signals that the front end uses."""

    SPECIFIC_FORCE = "specific_force"  # m/s^2, device axes, points up when the device lies still
    ROTATION_RATE = "rotation_rate"  # rad/s, device axes
    MAGNETIC_FIELD = "magnetic_field"  # uT, device axes
    ATTITUDE = "attitude"  # quaternion w x y z, device -> level frame with z up


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
