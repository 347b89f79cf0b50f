"""Walking direction relative to a phone on a leg or an arm, as a density, from the rotation of the limb.

A limb swings forward and backward once a stride: the horizontal part of its rotation is along one line, at right
angles to the walking direction. It also turns about the vertical and sideways, which turns that line. How far follows
from the vertical rotation rate over the one along the line, at the stride frequency: fitted to 100 simulated walkers
it takes the error of a phone in a pocket from 14.6 to 5.4 degrees, and in a swinging hand from 7.2 to 3.1 degrees.
Real pockets differ from simulated ones: with the attitude of the phone known from motion capture (OxIOD, user 5) the
corrected rotation is off by 24 degrees. So the density has a narrow and a wide part.

Two things tell which end of the line is the walker's left, and so forward from backward. Both hold whichever leg it
is, and wherever in the stride the steps begin.

* The lift: a thigh swings further forward than backward, an arm bends at the elbow, and both carry the phone before
  the body. So the phone rises as it swings forward, and its vertical acceleration lags behind the rotation rate about
  the walker's left by a quarter of a stride.
* The beat: a thigh moves back for longer than it moves forward. So its rotation at the step frequency has a fixed
  phase against that at the stride frequency.

Measured over runs of 4 strides: in simulated pockets, of which the direction is known, the lift lags by 85 degrees
and the beat has a phase of -164; they are right in 100 and 99.7 % of the runs. In swinging hands the lift is right in
99.4 %. Of real pockets those runs are counted whose acceleration tells forward at a coherence above 0.75. In
MotionSense (16 people) the phases are -92 and -107 degrees; lift and beat are right in 100 and 99.8 % of 906 runs. In
sets that the constants do not come from (OxIOD, RIDI, GeoTec: 17 people; legs of DSADS) the lift lags by 73 to 120
degrees and is right in all of 311 runs, the beat has a phase of -117 to -152 and is wrong in one. The probabilities
leave more room: a phone in a back pocket is behind the hip, where the lift may have the other sign.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.front_end.heading.placement_change.stride_cues import StrideCue
from pdr_est.front_end.heading.placement_change.turn_density import CELLS, gaussian, mixed
from pdr_est.types.steps import CarryingMode

_LEAST_LINEAR = 0.8  # share of the rotation that is along one line, below which a limb does not swing about it
_LIFT_RAD = -0.5 * np.pi  # phase of the vertical acceleration against the rotation rate about the walker's left
# Phase of that rate at the step frequency against the square of it at the stride frequency: halfway between simulated
# pockets and those of MotionSense.
_BEAT_RAD = np.deg2rad(-135.0)


@dataclass(frozen=True)
class _EndSign:
    """Describe how well something tells the ends of the line apart.

    The log odds are `slope` times the coherence with the phase that it should have. With the probability `misleads`
    it tells nothing, or the contrary.
    """

    slope: float
    misleads: float

    def probability(self, coherence: float) -> float:
        """Compute the probability that an end is the walker's left."""
        return float(self.misleads + (1.0 - 2.0 * self.misleads) / (1.0 + np.exp(-self.slope * coherence)))


@dataclass(frozen=True)
class _LimbSwing:
    """Relation of the rotation of a limb and the walking direction.

    `by_twist_rad`: turn of the line, rad, for a vertical rotation as large as that along the line, in phase with it
    and a quarter of a stride ahead. The standard deviation of the error is `narrow_rad`, with the probability `wide`
    it is `wide_rad`, and with the probability `useless` the error may be anything: the mode is another one. `lift`
    and `beat` tell the ends of the line apart; an arm has no beat that is known.
    """

    by_twist_rad: tuple[float, float]
    narrow_rad: float
    wide_rad: float
    wide: float
    useless: float
    lift: _EndSign
    beat: _EndSign | None = None

    def density(self, ahead_rad: float) -> Array:
        """Compute the density (360,) of the walking direction near one end of the line."""
        narrow = 1.0 - self.wide - self.useless
        return mixed((narrow, gaussian(ahead_rad, self.narrow_rad)), (self.wide, gaussian(ahead_rad, self.wide_rad)))


_LIMBS = {
    CarryingMode.SWING: _LimbSwing(
        (-0.317, 0.0), narrow_rad=0.08, wide_rad=0.25, wide=0.25, useless=0.02, lift=_EndSign(6.0, 0.05)
    ),
    CarryingMode.POCKET: _LimbSwing(
        (0.242, -0.282),
        narrow_rad=0.13,
        wide_rad=0.4,
        wide=0.25,
        useless=0.02,
        lift=_EndSign(6.0, 0.05),
        beat=_EndSign(6.0, 0.05),
    ),
}


def density_by_rotation(cues: Sequence[StrideCue]) -> Array:
    """Compute the density (360,) of the walking direction less the yaw of the phone, by the rotation of a limb.

    It is uniform where the phone is on no limb that swings.

    Parameters
    ----------
    cues : sequence of StrideCue
        Motion of each stride, at least one; the carrying mode is that of the last one.
    """
    limb = _LIMBS.get(cues[-1].mode)
    rotation = np.array([cue.rotation_radps for cue in cues])
    along, across = np.abs(rotation.T) ** 2
    total = float(np.sum(along + across))
    double = complex(np.sum(along - across), 2.0 * np.sum((rotation[:, 0] * rotation[:, 1].conj()).real))
    if limb is None or total == 0.0 or abs(double) < _LEAST_LINEAR * total:
        return np.ones(CELLS)
    line_rad = 0.5 * float(np.angle(double))  # the walker's left, or right
    line = np.array([np.cos(line_rad), np.sin(line_rad)])
    about = rotation @ line
    twist = np.array([cue.twist_radps for cue in cues])
    ratio = complex(np.sum(twist * about.conj())) / float(np.sum(np.abs(about) ** 2))
    turned_rad = limb.by_twist_rad[0] * ratio.real + limb.by_twist_rad[1] * ratio.imag
    left = _probability_of_left(limb, cues, about, line)
    ahead_rad = line_rad - 0.5 * np.pi  # if the line is the left
    return np.asarray(
        left * limb.density(ahead_rad - turned_rad) + (1.0 - left) * limb.density(ahead_rad + np.pi + turned_rad)
    )


def _probability_of_left(
    limb: _LimbSwing, cues: Sequence[StrideCue], about: NDArray[np.complex128], line: Array
) -> float:
    """Compute the probability that a line (2,) points to the walker's left; `about` (n,) is the rotation about it."""
    lift = np.array([cue.lift_mps2 for cue in cues], dtype=np.complex128)
    signs = [limb.lift.probability(_coherence(lift, about, _LIFT_RAD))]
    if limb.beat is not None:
        at_steps = np.array([cue.rotation_at_steps_radps for cue in cues], dtype=np.complex128) @ line
        signs.append(limb.beat.probability(_coherence(at_steps, about**2, _BEAT_RAD)))
    left, right = float(np.prod(signs)), float(np.prod([1.0 - sign for sign in signs]))
    return left / (left + right)


def _coherence(values: NDArray[np.complex128], others: NDArray[np.complex128], phase_rad: float) -> float:
    """Compute the coherence, from -1 to 1, of values (n,) with others that they should lead by a phase."""
    power = float(np.sum(np.abs(values) ** 2)) * float(np.sum(np.abs(others) ** 2))
    together = complex(np.sum(values * others.conj())) * np.exp(-1j * phase_rad)
    return float(together.real / np.sqrt(power)) if power > 0.0 else 0.0
