"""Level the samples: find gravity, vertical acceleration and yaw from raw samples or the device's own attitude.

Without gyroscope there is no yaw, and gravity comes from the accelerometer alone.
"""

from typing import Annotated, Any, Literal

import numpy as np
from annotated_types import Ge, Le
from vqf import VQF

from pdr_est.errors import RecordingError
from pdr_est.frames import STANDARD_GRAVITY_MPS2, Array, twist_about_vertical, up_in_device, wrap_angle
from pdr_est.front_end.signal.axis_turn import AxisTurn, axes_through
from pdr_est.front_end.signal.filters import CausalLowPass
from pdr_est.front_end.signal.standing_bias import StandingBias, StandingBiasParams
from pdr_est.front_end.signal.vectors import dot, norm, specific_force
from pdr_est.params import Positive, params
from pdr_est.records import changed
from pdr_est.types.sensors import ImuBlock, LevelBlock
from pdr_est.types.steps import CarryingMode

BRIDGED_S = 1.5
"""Duration, s, of a gap up to which a straight line between its borders tells more of the rotation than nothing:
measured by cutting gaps into recorded walks. Over a longer one the yaw stays as it was.
"""
_LEAST_FORCE_MPS2 = 1e-9  # keeps the direction of a zero vector finite


@params
class AttitudeParams:
    """Choose the source of the attitude, and how it is filtered."""

    source: Literal["auto", "vqf", "device"] = "auto"
    """Source of the attitude: "vqf" integrates the raw samples (Laidig and Seel 2023), "device" takes the recorder's
    own, and "auto" takes the recorder's where the samples are too far apart to integrate: the device saw those in
    between.
    """
    accelerometer_time_constant_s: Positive = 3.0
    """Time constant, s, with which the accelerometer corrects the tilt integrated from the gyroscope (VQF's tauAcc).
    """
    rest_rate_radps: Positive = 0.0087
    """Rotation rate, rad/s, about each axis and against its own mean, below which VQF takes the phone for one at rest
    and its rotation for the gyroscope's bias. VQF's own default, 2 degrees per second, takes the sway of a standing
    walker for rest; the bias found so turned simulated pockets by 23 degrees in 100 m, against 3 degrees with ours.
    """
    standing: StandingBiasParams = StandingBiasParams()
    """Parameters of the bias about the vertical that standing with the phone in the hand shows, for the source "vqf".
    """
    tilt_cutoff_hz: Annotated[float, Ge(0.02), Le(2.0)] = 0.3
    """Frequency, Hz, below which the specific force of a device without gyroscope is taken for gravity."""


class VqfAttitude:
    """Stage ImuBlock -> LevelBlock with the filter VQF without magnetometer.

    The filter goes on over a short gap as if the samples changed linearly. After a longer one gravity is found
    anew, and yaw and the bias of the gyroscope are kept.

    Where VQF looks for rest or limits what it corrects, it treats each axis by itself, so that its result depends on
    how the axes lie in the device. Here it gets the samples in axes that are laid through the first sample of the
    segment: the third along its specific force, the first along what is level of its rotation.

    Parameters
    ----------
    rate_hz : float
        Sampling rate of the samples.
    parameters : AttitudeParams
        Time constant and rest threshold of the filter.

    References
    ----------
    Laidig and Seel: VQF, Information Fusion 2023.
    """

    latency_s = 0.0

    def __init__(self, rate_hz: float, parameters: AttitudeParams) -> None:
        self._settings = {
            "gyrTs": 1.0 / rate_hz,
            "tauAcc": parameters.accelerometer_time_constant_s,
            "restThGyr": float(np.rad2deg(parameters.rest_rate_radps)),
        }
        self._filter = VQF(**self._settings)
        self._last: tuple[Array, Array, float] | None = None  # last rate, force and yaw
        self._segment: int | None = None
        self._yaw_offset_rad = 0.0  # that keeps the yaw over long gaps, less what standing says of the bias
        self._turn = AxisTurn(np.eye(3))
        self._standing_arguments = rate_hz, parameters.standing
        self._standing = StandingBias(*self._standing_arguments)

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_filter": self._filter.state}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self._filter = VQF(**self._settings)
        self._filter.state = state["_filter"]

    def push(self, item: ImuBlock, /) -> list[LevelBlock]:
        """Level the samples of a block.

        Raises
        ------
        RecordingError
            If the block has no rotation rate.
        """
        if not len(item.time_s):
            return []
        rate, force = _rotation_rate(item), item.specific_force_mps2
        yaw_kept_rad = self._bridge(item, rate[0], force[0]) if item.segment != self._segment else None
        self._segment = item.segment
        turned = self._turn.vectors(rate)
        result = self._filter.updateBatch(turned, self._turn.vectors(force))
        level = _level(item, self._turn.attitudes(result["quat6D"]), rate - self._turn.vectors_back(result["bias"]))
        if yaw_kept_rad is not None:
            self._yaw_offset_rad = yaw_kept_rad - float(level.yaw_rad[0])
        level = self._without_standing_bias(level, turned - result["bias"])
        self._last = rate[-1], force[-1], float(level.yaw_rad[-1])
        return [level]

    def _without_standing_bias(self, level: LevelBlock, rate: Array) -> LevelBlock:
        """Take what standing tells of the bias about the vertical off the yaw and the rates.

        VQF finds the bias of a phone at rest. In the hand of somebody who stands there is no rest, but the rates
        scatter about the bias that VQF leaves. `rate` (n, 3) is the rotation rate without the bias that VQF found, in
        the axes of the filter.
        """
        up = self._turn.vectors(level.up)
        bias, variance = self._standing.push(
            level.first_index, norm(specific_force(level.up, level.acceleration_mps2)), rate
        )
        excess = dot(bias, up)
        # The carry is the first term of the sum, so that the additions and their order do not depend on the cuts.
        offset = np.cumsum(np.concatenate([[self._yaw_offset_rad], -self._settings["gyrTs"] * excess]))[1:]
        self._yaw_offset_rad = float(offset[-1])
        return changed(
            level,
            yaw_rad=wrap_angle(level.yaw_rad + offset),
            rotation_rate_radps=level.rotation_rate_radps - excess[:, None] * level.up,
            turn_rate_radps=level.turn_rate_radps - excess,
            turn_bias_radps=np.stack([excess, np.sqrt(dot(up**2, variance))], axis=1),
        )

    def _bridge(self, item: ImuBlock, first_rate: Array, first_force: Array) -> float | None:
        """Take the filter over the gap before a block; return the yaw to go on with, None for its own."""
        if self._last is None or item.hole is None:
            self._filter.resetState()
            self._standing, self._yaw_offset_rad = StandingBias(*self._standing_arguments), 0.0
            self._turn = AxisTurn(axes_through(first_force, first_rate))
            return None
        last_rate, last_force, last_yaw_rad = self._last
        if item.hole.duration_s <= BRIDGED_S:
            count = round(item.hole.duration_s / self._settings["gyrTs"])
            share = np.arange(1, count)[:, None] / count
            rate, force = (
                last_rate + share * (first_rate - last_rate),
                last_force + share * (first_force - last_force),
            )
            self._filter.updateBatch(self._turn.vectors(rate), self._turn.vectors(force))
            return None
        bias, sigma = self._filter.getBiasEstimate()
        bias = self._turn.vectors_back(bias[None])
        self._filter.resetState()
        axes = axes_through(first_force, first_rate)
        self._standing.turn(axes @ self._turn.vectors_back(np.eye(3)).T)
        self._turn = AxisTurn(axes)
        self._filter.setBiasEstimate(self._turn.vectors(bias)[0], sigma)
        return last_yaw_rad

    def flush(self) -> list[LevelBlock]:
        """Return nothing: no sample is held back."""
        return []


class DeviceAttitude:
    """Stage ImuBlock -> LevelBlock with the attitude that the device itself estimated."""

    latency_s = 0.0

    def push(self, item: ImuBlock, /) -> list[LevelBlock]:
        """Level the samples of a block.

        Raises
        ------
        RecordingError
            If the block has no attitude or no rotation rate.
        """
        if item.attitude is None:
            raise RecordingError("the recording has no attitude of the device: use attitude source vqf")
        return [_level(item, item.attitude, _rotation_rate(item))]

    def flush(self) -> list[LevelBlock]:
        """Return nothing: no sample is held back."""
        return []


class AccelerometerTilt:
    """Stage ImuBlock -> LevelBlock for a device without gyroscope: enough to find steps, not for a heading.

    Up is the direction of the low-passed specific force; it lags behind a phone that turns over. The vertical
    acceleration is therefore not taken along it: it is the length of the specific force less gravity, which no tilt
    can spoil and which differs from the vertical acceleration in second order only. Yaw, rotation rate and turn rate
    are NaN. Without any specific force up is zero.

    Parameters
    ----------
    rate_hz : float
        Sampling rate of the samples.
    parameters : AttitudeParams
        Cutoff frequency of the low-pass.
    """

    latency_s = 0.0

    def __init__(self, rate_hz: float, parameters: AttitudeParams) -> None:
        self._low_pass = CausalLowPass(parameters.tilt_cutoff_hz, rate_hz)
        self._segment: int | None = None

    def push(self, item: ImuBlock, /) -> list[LevelBlock]:
        """Level the samples of a block."""
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
                pressure_pa=item.pressure_pa,
                hole=item.hole,
            )
        ]

    def flush(self) -> list[LevelBlock]:
        """Return nothing: no sample is held back."""
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
        pressure_pa=block.pressure_pa,
        recorded_yaw_rad=None if block.attitude is None else _recorded_yaw(block.attitude, quaternion),
        hole=block.hole,
    )


def _recorded_yaw(recorded: Array, own: Array) -> Array:
    """Compute the yaw (n,) by the recorded attitude of a device whose own attitude has another zero of the yaw.

    The turn from the one level frame to the other is about the vertical, up to the difference of the tilts. The
    difference of the two yaws would be the same only for a device whose tilts are equal, or that lies flat.
    """
    a, b, c, d = recorded.T
    w, x, y, z = own.T
    turn = 2.0 * np.arctan2(d * w - a * z - b * y + c * x, a * w + b * x + c * y + d * z)
    return wrap_angle(twist_about_vertical(own) + turn)
