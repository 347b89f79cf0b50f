"""Motion of each stride of a walker, as the phone felt it: what tells the walking direction."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.front_end.heading.level_frame import to_level
from pdr_est.front_end.heading.phone_posture import posture_of
from pdr_est.front_end.heading.principal_axis import StrideMotion, is_walking_stride
from pdr_est.front_end.heading.step_motion import motion_of
from pdr_est.front_end.heading.stride_pairing import StridePairing
from pdr_est.types.steps import CarryingMode, Step


@dataclass(frozen=True)
class StrideCue:
    """Motion of a stride in the level frame turned by the yaw of the phone.

    Attributes
    ----------
    motion : StrideMotion
        First harmonic of the acceleration over the steps; its yaw is that of the phone in its posture.
    rotation_radps : ndarray of complex, shape (2,)
        Horizontal rotation rate at the stride frequency.
    rotation_at_steps_radps : ndarray of complex, shape (2,)
        Horizontal rotation rate at the step frequency, twice that.
    twist_radps : complex
        Rotation rate about the vertical at the stride frequency.
    lift_mps2 : complex
        Vertical acceleration at the stride frequency.
    mode : CarryingMode
        Carrying mode.
    """

    motion: StrideMotion
    rotation_radps: NDArray[np.complex128]
    rotation_at_steps_radps: NDArray[np.complex128]
    twist_radps: complex
    lift_mps2: complex
    mode: CarryingMode


def stride_cues(steps: Sequence[Step], up: Array) -> list[StrideCue]:
    """Compute the motion of each stride of some steps, in which the phone had the posture `up` (3,)."""
    strides = StridePairing()
    return [_cue(pair, up) for step in steps for pair in strides.add(step) if is_walking_stride(pair)]


def _cue(pair: Sequence[Step], up: Array) -> StrideCue:
    yaw_at = posture_of(up).yaw_rad
    phasor = sum(len(step.samples) * np.exp(1j * yaw_at(motion_of(step))) for step in pair)
    yaw_rad = float(np.angle(phasor))
    horizontal, rotation, at_steps = (np.zeros(2, dtype=np.complex128) for _ in range(3))
    vertical, twist, lift, count = 0j, 0j, 0j, sum(len(step.samples) for step in pair)
    for number, step in enumerate(pair):
        samples = step.samples
        once_a_step, once_a_stride = _waves(len(samples), number)
        acceleration = to_level(samples.acceleration_mps2, samples.up, samples.yaw_rad - yaw_rad)
        rate = to_level(samples.rotation_rate_radps, samples.up, samples.yaw_rad - yaw_rad)
        horizontal += (once_a_step[:, None] * acceleration).sum(axis=0)
        rotation += (once_a_stride[:, None] * rate).sum(axis=0)
        at_steps += (once_a_step[:, None] * rate).sum(axis=0)
        vertical += complex((once_a_step * samples.vertical_mps2).sum())
        lift += complex((once_a_stride * samples.vertical_mps2).sum())
        twist += complex((once_a_stride * samples.turn_rate_radps).sum())
    motion = StrideMotion(horizontal / count, vertical / count, yaw_rad)
    return StrideCue(motion, rotation / count, at_steps / count, twist / count, lift / count, pair[0].event.mode)


@lru_cache(maxsize=256)
def _waves(count: int, number: int) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
    """Return the waves (count,) at the step frequency and at the stride frequency over the first or second step."""
    phase = (np.arange(count) + 0.5) / count
    return np.exp(-2j * np.pi * phase), np.exp(-1j * np.pi * (phase + number))
