"""Direction of gravity, vertical acceleration and yaw: from raw samples, or from the device's own attitude.

Without gyroscope there is no yaw, and gravity comes from the accelerometer alone.
"""

from typing import Annotated, Any, Literal

import numpy as np
from annotated_types import Ge, Le
from vqf import VQF

from pdr_est.errors import RecordingError
from pdr_est.frames import STANDARD_GRAVITY_MPS2, Array, twist_about_vertical, up_in_device
from pdr_est.front_end.signal.filters import CausalLowPass
from pdr_est.front_end.signal.vectors import dot, norm
from pdr_est.params import Positive, params
from pdr_est.types.sensors import ImuBlock, LevelBlock
from pdr_est.types.steps import CarryingMode

_LEAST_FORCE_MPS2 = 1e-9  # keeps the direction of nothing finite


@params
class AttitudeParams:
    """source: "vqf" integrates the raw samples (Laidig and Seel 2023), "device" takes the recorder's attitude, and
    "auto" takes that where the samples are too far apart to integrate: the device saw those in between.

    accelerometer_time_constant_s: how slowly the accelerometer corrects the tilt that the gyroscope tells.
    rest_rate_radps: below this rate, about each axis and against its own mean, vqf takes a phone for one at rest and
    its rotation for the gyroscope's bias. Its own default, 2 degrees a second, takes the sway of a walker who stands
    for that; the bias found so turned simulated pockets by 23 degrees in 100 m, against 3 degrees with ours.
    tilt_cutoff_hz: below this frequency the specific force of a device without gyroscope is taken for gravity.
    """

    source: Literal["auto", "vqf", "device"] = "auto"
    accelerometer_time_constant_s: Positive = 3.0
    rest_rate_radps: Positive = 0.0087
    tilt_cutoff_hz: Annotated[float, Ge(0.02), Le(2.0)] = 0.3


class VqfAttitude:
    """Stage ImuBlock -> LevelBlock with VQF without magnetometer. A new segment starts the filter anew."""

    latency_s = 0.0

    def __init__(self, rate_hz: float, parameters: AttitudeParams) -> None:
        self._settings = {
            "gyrTs": 1.0 / rate_hz,
            "tauAcc": parameters.accelerometer_time_constant_s,
            "restThGyr": float(np.rad2deg(parameters.rest_rate_radps)),
        }
        self._filter = VQF(**self._settings)
        self._segment: int | None = None

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_filter": self._filter.state}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self._filter = VQF(**self._settings)
        self._filter.state = state["_filter"]

    def push(self, item: ImuBlock, /) -> list[LevelBlock]:
        if not len(item.time_s):
            return []
        if item.segment != self._segment:
            self._filter.resetState()
            self._segment = item.segment
        rate = _rotation_rate(item)
        result = self._filter.updateBatch(np.ascontiguousarray(rate), np.ascontiguousarray(item.specific_force_mps2))
        return [_level(item, result["quat6D"], rate - result["bias"])]

    def flush(self) -> list[LevelBlock]:
        return []


class DeviceAttitude:
    """Stage ImuBlock -> LevelBlock with the attitude that the device itself estimated."""

    latency_s = 0.0

    def push(self, item: ImuBlock, /) -> list[LevelBlock]:
        if item.attitude is None:
            raise RecordingError("the recording has no attitude of the device: use attitude source vqf")
        return [_level(item, item.attitude, _rotation_rate(item))]

    def flush(self) -> list[LevelBlock]:
        return []


class AccelerometerTilt:
    """Stage ImuBlock -> LevelBlock for a device without gyroscope: enough to find steps, not for a direction.

    Up is the direction of the low-passed specific force; it lags behind a phone that turns over. The vertical
    acceleration is therefore not taken along it: it is the length of the specific force less gravity, which no tilt
    can spoil and which differs from the acceleration upwards in second order only. Yaw, rotation rate and turn rate
    are NaN. Without any specific force up is zero.
    """

    latency_s = 0.0

    def __init__(self, rate_hz: float, parameters: AttitudeParams) -> None:
        self._low_pass = CausalLowPass(parameters.tilt_cutoff_hz, rate_hz)
        self._segment: int | None = None

    def push(self, item: ImuBlock, /) -> list[LevelBlock]:
        if not len(item.time_s):
            return []
        if item.segment != self._segment:
            self._low_pass.reset()
            self._segment = item.segment
        force = item.specific_force_mps2
        slow = self._low_pass.push(force)
        up = slow / np.maximum(norm(slow), _LEAST_FORCE_MPS2)[:, None]
        unknown = np.full(force.shape, np.nan)
        return [
            LevelBlock(
                first_index=item.first_index,
                segment=item.segment,
                time_s=item.time_s,
                up=up,
                acceleration_mps2=force - STANDARD_GRAVITY_MPS2 * up,
                vertical_mps2=norm(force) - STANDARD_GRAVITY_MPS2,
                yaw_rad=unknown[:, 0],
                rotation_rate_radps=unknown,
                turn_rate_radps=unknown[:, 1],
                mode=np.full(len(force), CarryingMode.UNKNOWN, dtype=np.int8),
                mode_probability=np.zeros(len(force)),
                magnetic_field_ut=item.magnetic_field_ut,
            )
        ]

    def flush(self) -> list[LevelBlock]:
        return []


def _rotation_rate(block: ImuBlock) -> Array:
    if block.rotation_rate_radps is None:
        raise RecordingError("the recording has no gyroscope: only AccelerometerTilt does without it")
    return block.rotation_rate_radps


def _level(block: ImuBlock, quaternion: Array, rotation_rate_radps: Array) -> LevelBlock:
    """Combine samples and attitude."""
    up = up_in_device(quaternion)
    acceleration = block.specific_force_mps2 - STANDARD_GRAVITY_MPS2 * up
    return LevelBlock(
        first_index=block.first_index,
        segment=block.segment,
        time_s=block.time_s,
        up=up,
        acceleration_mps2=acceleration,
        vertical_mps2=dot(acceleration, up),
        yaw_rad=twist_about_vertical(quaternion),
        rotation_rate_radps=rotation_rate_radps,
        turn_rate_radps=dot(rotation_rate_radps, up),
        mode=np.full(len(block.time_s), CarryingMode.UNKNOWN, dtype=np.int8),
        mode_probability=np.zeros(len(block.time_s)),
        magnetic_field_ut=block.magnetic_field_ut,
    )
