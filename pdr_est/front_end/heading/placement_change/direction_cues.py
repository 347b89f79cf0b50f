"""Walking direction relative to the phone, as a density: from the acceleration and, on a limb, from the rotation.

Two things show the direction in which a walker moves, whatever the posture of the phone.

* The principal axis of the horizontal acceleration at the step frequency, with its sign from the phase
  (`principal_axis`).
* A leg or an arm swings forward and backward once a stride: the horizontal part of its rotation is along one line, at
  right angles to the walking direction. It does not tell forward from backward.

Neither is always right. Measured on 200 simulated walkers, who were not used for any test: the sign of the axis is
wrong in half of the cases without coherence and in 2 % at a coherence of 0.5, and of no use in a swinging hand; the
rotation is off by 7 degrees in a swinging hand and by 14 in a pocket. With the attitude of the phone known from motion
capture (OxIOD, user 5) the axis of a phone in a pocket is off by 3 degrees at a coherence of 0.95, and the rotation by
31, since the thigh turns about the vertical as well.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.front_end.heading.level_frame import to_level
from pdr_est.front_end.heading.phone_posture import mean_yaw
from pdr_est.front_end.heading.placement_change.turn_density import CELLS, gaussian, mixed
from pdr_est.front_end.heading.principal_axis import (
    PrincipalAxisParams,
    StrideMotion,
    is_walking_stride,
    walking_direction,
)
from pdr_est.front_end.heading.stride_pairing import StridePairing
from pdr_est.types.steps import CarryingMode, Step

_SIGMA_ROTATION_RAD = {CarryingMode.SWING: 0.15, CarryingMode.POCKET: 0.35}
_LEAST_LINEAR = 0.8  # share of the rotation that is along one line, below which a limb does not swing about it
_UNIFORM_ROTATION = 0.05  # probability that a limb's rotation tells nothing: the mode is another one
_WRONG_SIGN_COHERENCE = 0.22  # the probability of a wrong sign falls by e over so much coherence
_NO_AXIS_COHERENCE = 0.1  # the probability of no axis at all falls by e over so much coherence
_LEAST_NO_AXIS = 0.02


@dataclass(frozen=True)
class StrideCue:
    """Motion of a stride in the level frame turned by the yaw of the phone.

    Attributes
    ----------
    motion : StrideMotion
        First harmonic of the acceleration over the steps; its yaw is that of the phone in its posture.
    rotation_radps : ndarray of complex, shape (2,)
        Horizontal rotation rate at the stride frequency.
    mode : CarryingMode
        Carrying mode.
    """

    motion: StrideMotion
    rotation_radps: NDArray[np.complex128]
    mode: CarryingMode


def stride_cues(steps: Sequence[Step], up: Array) -> list[StrideCue]:
    """Compute the motion of each stride of some steps, in which the phone had the posture `up` (3,)."""
    strides = StridePairing()
    return [_cue(pair, up) for step in steps for pair in strides.add(step) if is_walking_stride(pair)]


def _cue(pair: Sequence[Step], up: Array) -> StrideCue:
    phasor = sum(len(step.samples) * np.exp(1j * mean_yaw(step.samples, up)) for step in pair)
    yaw_rad = float(np.angle(phasor))
    horizontal, rotation = np.zeros(2, dtype=np.complex128), np.zeros(2, dtype=np.complex128)
    vertical, count = 0j, sum(len(step.samples) for step in pair)
    for number, step in enumerate(pair):
        samples = step.samples
        phase = (np.arange(len(samples)) + 0.5) / len(samples)
        once_a_step, once_a_stride = np.exp(-2j * np.pi * phase), np.exp(-1j * np.pi * (phase + number))
        acceleration = to_level(samples.acceleration_mps2, samples.up, samples.yaw_rad - yaw_rad)
        rate = to_level(samples.rotation_rate_radps, samples.up, samples.yaw_rad - yaw_rad)
        horizontal += np.sum(once_a_step[:, None] * acceleration, axis=0)
        rotation += np.sum(once_a_stride[:, None] * rate, axis=0)
        vertical += complex(np.sum(once_a_step * samples.vertical_mps2))
    motion = StrideMotion(horizontal / count, vertical / count, yaw_rad)
    return StrideCue(motion, rotation / count, pair[0].event.mode)


def direction_density(cues: Sequence[StrideCue], parameters: PrincipalAxisParams) -> Array:
    """Compute the density (360,) of the walking direction less the yaw of the phone; uniform without strides."""
    if not cues:
        return np.ones(CELLS)
    density = _by_acceleration(cues, parameters) * _by_rotation(cues)
    return np.asarray(density / density.mean())


def _by_acceleration(cues: Sequence[StrideCue], parameters: PrincipalAxisParams) -> Array:
    found = walking_direction([cue.motion for cue in cues], replace(parameters, least_coherence=0.0))
    if cues[-1].mode is CarryingMode.SWING:
        return np.ones(CELLS)
    sigma = found.sigma_rad
    if cues[-1].mode is CarryingMode.POCKET:
        sigma = float(np.hypot(sigma, 0.75 * (1.0 - found.coherence) ** 2))
    wrong = 0.5 * np.exp(-found.coherence / _WRONG_SIGN_COHERENCE)
    axis = 1.0 - _LEAST_NO_AXIS - 0.5 * np.exp(-found.coherence / _NO_AXIS_COHERENCE)
    ahead = -found.offset_rad
    return mixed(
        (axis * (1.0 - wrong), gaussian(ahead, sigma)),
        (axis * wrong, gaussian(ahead + np.pi, sigma)),
    )


def _by_rotation(cues: Sequence[StrideCue]) -> Array:
    sigma = _SIGMA_ROTATION_RAD.get(cues[-1].mode)
    rotation = np.array([cue.rotation_radps for cue in cues])
    along, across = np.abs(rotation.T) ** 2
    total = float(np.sum(along + across))
    double = complex(np.sum(along - across), 2.0 * np.sum((rotation[:, 0] * rotation[:, 1].conj()).real))
    if sigma is None or abs(double) < _LEAST_LINEAR * total or total == 0.0:
        return np.ones(CELLS)
    ahead = 0.5 * float(np.angle(double)) + 0.5 * np.pi
    share = 0.5 * (1.0 - _UNIFORM_ROTATION)
    return mixed((share, gaussian(ahead, sigma)), (share, gaussian(ahead + np.pi, sigma)))
