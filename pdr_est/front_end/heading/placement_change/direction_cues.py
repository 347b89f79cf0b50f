"""Walking direction relative to the phone, as a density: from the acceleration and, on a limb, from the rotation.

Two things show the direction in which a walker moves, whatever the posture of the phone.

* The principal axis of the horizontal acceleration at the step frequency, with its sign from the phase
  (`principal_axis`).
* A leg or an arm swings forward and backward once a stride: the horizontal part of its rotation is along one line, at
  right angles to the walking direction. It does not tell forward from backward.

A limb also turns about the vertical and sideways as it swings, which turns the line of its rotation. How far follows
from the vertical rotation rate over the one along the line, at the stride frequency: fitted to 100 simulated walkers
it takes the error of a phone in a pocket from 14.6 to 5.4 degrees, and in a swinging hand from 7.2 to 3.1 degrees.

Neither cue is always right. On 200 simulated walkers the sign of the principal axis is wrong in half of the cases
without coherence and in 2 % at a coherence of 0.5, and it is of no use in a swinging hand. Real pockets differ from
simulated ones: with the attitude of the phone known from motion capture (OxIOD, user 5) the axis is off by 3 degrees,
at a coherence of 0.95, and the corrected rotation by 24. So the density by the rotation has a narrow and a wide part.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.front_end.heading.level_frame import to_level
from pdr_est.front_end.heading.phone_posture import mean_yaw
from pdr_est.front_end.heading.placement_change.turn_density import CELLS, gaussian, mixed, normalised
from pdr_est.front_end.heading.principal_axis import (
    PrincipalAxisParams,
    StrideMotion,
    is_walking_stride,
    walking_direction,
)
from pdr_est.front_end.heading.stride_pairing import StridePairing
from pdr_est.types.steps import CarryingMode, Step

_LEAST_LINEAR = 0.8  # share of the rotation that is along one line, below which a limb does not swing about it


@dataclass(frozen=True)
class _LimbSwing:
    """Relation of the rotation of a limb and the walking direction.

    `by_twist_rad`: turn of the line, rad, for a vertical rotation as large as that along the line, in phase with it
    and a quarter of a stride ahead. The standard deviation of the error is `narrow_rad`, with the probability `wide`
    it is `wide_rad`, and with the probability `useless` the error may be anything: the mode is another one.
    """

    by_twist_rad: tuple[float, float]
    narrow_rad: float
    wide_rad: float
    wide: float
    useless: float

    def density(self, ahead_rad: float) -> Array:
        """Compute the density (360,) of the walking direction near one end of the line."""
        narrow = 1.0 - self.wide - self.useless
        return mixed((narrow, gaussian(ahead_rad, self.narrow_rad)), (self.wide, gaussian(ahead_rad, self.wide_rad)))


_LIMBS = {
    CarryingMode.SWING: _LimbSwing((-0.317, 0.0), narrow_rad=0.08, wide_rad=0.25, wide=0.25, useless=0.02),
    CarryingMode.POCKET: _LimbSwing((0.242, -0.282), narrow_rad=0.13, wide_rad=0.4, wide=0.25, useless=0.02),
}
_WRONG_SIGN_COHERENCE = 0.13  # the probability of a wrong sign falls by e over so much coherence
_NO_AXIS_COHERENCE = 0.085  # the probability of no axis at all falls by e over so much coherence
_LEAST_NO_AXIS = 0.015
_INCOHERENT_AXIS_RAD = 1.0  # standard deviation of the axis in a pocket without coherence: a thigh moves by itself


@dataclass(frozen=True)
class StrideCue:
    """Motion of a stride in the level frame turned by the yaw of the phone.

    Attributes
    ----------
    motion : StrideMotion
        First harmonic of the acceleration over the steps; its yaw is that of the phone in its posture.
    rotation_radps : ndarray of complex, shape (2,)
        Horizontal rotation rate at the stride frequency.
    twist_radps : complex
        Rotation rate about the vertical at the stride frequency.
    mode : CarryingMode
        Carrying mode.
    """

    motion: StrideMotion
    rotation_radps: NDArray[np.complex128]
    twist_radps: complex
    mode: CarryingMode


def stride_cues(steps: Sequence[Step], up: Array) -> list[StrideCue]:
    """Compute the motion of each stride of some steps, in which the phone had the posture `up` (3,)."""
    strides = StridePairing()
    return [_cue(pair, up) for step in steps for pair in strides.add(step) if is_walking_stride(pair)]


def _cue(pair: Sequence[Step], up: Array) -> StrideCue:
    phasor = sum(len(step.samples) * np.exp(1j * mean_yaw(step.samples, up)) for step in pair)
    yaw_rad = float(np.angle(phasor))
    horizontal, rotation = np.zeros(2, dtype=np.complex128), np.zeros(2, dtype=np.complex128)
    vertical, twist, count = 0j, 0j, sum(len(step.samples) for step in pair)
    for number, step in enumerate(pair):
        samples = step.samples
        phase = (np.arange(len(samples)) + 0.5) / len(samples)
        once_a_step, once_a_stride = np.exp(-2j * np.pi * phase), np.exp(-1j * np.pi * (phase + number))
        acceleration = to_level(samples.acceleration_mps2, samples.up, samples.yaw_rad - yaw_rad)
        rate = to_level(samples.rotation_rate_radps, samples.up, samples.yaw_rad - yaw_rad)
        horizontal += np.sum(once_a_step[:, None] * acceleration, axis=0)
        rotation += np.sum(once_a_stride[:, None] * rate, axis=0)
        vertical += complex(np.sum(once_a_step * samples.vertical_mps2))
        twist += complex(np.sum(once_a_stride * samples.turn_rate_radps))
    motion = StrideMotion(horizontal / count, vertical / count, yaw_rad)
    return StrideCue(motion, rotation / count, twist / count, pair[0].event.mode)


def direction_density(cues: Sequence[StrideCue], sigma_axis_rad: float) -> Array:
    """Compute the density (360,) of the walking direction less the yaw of the phone; uniform without strides.

    Parameters
    ----------
    cues : sequence of StrideCue
        Motion of each stride.
    sigma_axis_rad : float
        Standard deviation of the principal axis against the walking direction, by how the phone is worn.
    """
    if not cues:
        return np.ones(CELLS)
    density = _by_acceleration(cues, sigma_axis_rad) * _by_rotation(cues)
    return normalised(density)


def _by_acceleration(cues: Sequence[StrideCue], sigma_axis_rad: float) -> Array:
    found = walking_direction(
        [cue.motion for cue in cues], PrincipalAxisParams(least_coherence=0.0, sigma_rad=sigma_axis_rad)
    )
    if cues[-1].mode is CarryingMode.SWING:
        return np.ones(CELLS)
    sigma = found.sigma_rad
    if cues[-1].mode is CarryingMode.POCKET:
        sigma = float(np.hypot(sigma, _INCOHERENT_AXIS_RAD * (1.0 - found.coherence) ** 2))
    wrong = 0.5 * np.exp(-found.coherence / _WRONG_SIGN_COHERENCE)
    axis = (1.0 - _LEAST_NO_AXIS) * (1.0 - np.exp(-found.coherence / _NO_AXIS_COHERENCE))
    ahead = -found.offset_rad
    return mixed(
        (axis * (1.0 - wrong), gaussian(ahead, sigma)),
        (axis * wrong, gaussian(ahead + np.pi, sigma)),
    )


def _by_rotation(cues: Sequence[StrideCue]) -> Array:
    limb = _LIMBS.get(cues[-1].mode)
    rotation = np.array([cue.rotation_radps for cue in cues])
    along, across = np.abs(rotation.T) ** 2
    total = float(np.sum(along + across))
    double = complex(np.sum(along - across), 2.0 * np.sum((rotation[:, 0] * rotation[:, 1].conj()).real))
    if limb is None or total == 0.0 or abs(double) < _LEAST_LINEAR * total:
        return np.ones(CELLS)
    line_rad = 0.5 * float(np.angle(double))  # the walker's left, or right
    about = rotation @ np.array([np.cos(line_rad), np.sin(line_rad)])
    twist = np.array([cue.twist_radps for cue in cues])
    ratio = complex(np.sum(twist * about.conj())) / float(np.sum(np.abs(about) ** 2))
    turned_rad = limb.by_twist_rad[0] * ratio.real + limb.by_twist_rad[1] * ratio.imag
    ahead_rad = line_rad - 0.5 * np.pi  # if the line is the left
    return 0.5 * (limb.density(ahead_rad - turned_rad) + limb.density(ahead_rad + np.pi + turned_rad))
