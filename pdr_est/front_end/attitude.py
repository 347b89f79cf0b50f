"""Direction of gravity, vertical acceleration and yaw, from raw samples or from the device's own attitude."""

from typing import Any, Literal

import numpy as np
from vqf import VQF

from pdr_est.errors import RecordingError
from pdr_est.frames import STANDARD_GRAVITY_MPS2, Array, twist_about_vertical, up_in_device
from pdr_est.params import Positive, params
from pdr_est.records import CarryingMode, ImuBlock, LevelBlock


@params
class AttitudeParams:
    """source: "vqf" integrates the raw samples (Laidig and Seel 2023), "device" takes the recorder's attitude.

    accelerometer_time_constant_s: how slowly the accelerometer corrects the tilt that the gyroscope tells.
    """

    source: Literal["vqf", "device"] = "vqf"
    accelerometer_time_constant_s: Positive = 3.0


class VqfAttitude:
    """Stage ImuBlock -> LevelBlock with VQF without magnetometer. A new segment starts the filter anew."""

    latency_s = 0.0

    def __init__(self, rate_hz: float, parameters: AttitudeParams) -> None:
        self._settings = {"gyrTs": 1.0 / rate_hz, "tauAcc": parameters.accelerometer_time_constant_s}
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
        result = self._filter.updateBatch(
            np.ascontiguousarray(item.rotation_rate_radps), np.ascontiguousarray(item.specific_force_mps2)
        )
        return [_level(item, result["quat6D"], item.rotation_rate_radps - result["bias"])]

    def flush(self) -> list[LevelBlock]:
        return []


class DeviceAttitude:
    """Stage ImuBlock -> LevelBlock with the attitude that the device itself estimated."""

    latency_s = 0.0

    def push(self, item: ImuBlock, /) -> list[LevelBlock]:
        if item.attitude is None:
            raise RecordingError("the recording has no attitude of the device: use attitude source vqf")
        return [_level(item, item.attitude, item.rotation_rate_radps)]

    def flush(self) -> list[LevelBlock]:
        return []


def _level(block: ImuBlock, quaternion: Array, rotation_rate_radps: Array) -> LevelBlock:
    """Combine samples and attitude. Sums are written out: batched products differ with the size of a block."""
    up = up_in_device(quaternion)
    acceleration = block.specific_force_mps2 - STANDARD_GRAVITY_MPS2 * up
    return LevelBlock(
        first_index=block.first_index,
        segment=block.segment,
        time_s=block.time_s,
        up=up,
        acceleration_mps2=acceleration,
        vertical_mps2=_dot(acceleration, up),
        yaw_rad=twist_about_vertical(quaternion),
        rotation_rate_radps=rotation_rate_radps,
        turn_rate_radps=_dot(rotation_rate_radps, up),
        mode=np.full(len(block.time_s), CarryingMode.UNKNOWN, dtype=np.int8),
        mode_probability=np.zeros(len(block.time_s)),
    )


def _dot(a: Array, b: Array) -> Array:
    product: Array = a[:, 0] * b[:, 0] + a[:, 1] * b[:, 1] + a[:, 2] * b[:, 2]
    return product
