"""Walking direction relative to the phone, as a density: from the acceleration and, on a limb, from the rotation.

Two things show the direction in which a walker moves, whatever the posture of the phone.

* The principal axis of the horizontal acceleration at the step frequency, with its sign from the phase
  (`principal_axis`).
* The rotation of a leg or an arm that swings (`limb_swing`).

Neither cue is always right. On 200 simulated walkers the sign of the principal axis is wrong in half of the cases
without coherence and in 2 % at a coherence of 0.5, and it is of no use in a swinging hand. In a real pocket, with the
attitude of the phone known from motion capture (OxIOD, user 5), the axis is off by 3 degrees, at a coherence of 0.95.
"""

from collections.abc import Sequence

import numpy as np

from pdr_est.frames import Array
from pdr_est.front_end.heading.placement_change.limb_swing import density_by_rotation
from pdr_est.front_end.heading.placement_change.stride_cues import StrideCue
from pdr_est.front_end.heading.placement_change.turn_density import CELLS, gaussian, mixed, normalised
from pdr_est.front_end.heading.principal_axis import PrincipalAxisParams, walking_direction
from pdr_est.types.steps import CarryingMode

_WRONG_SIGN_COHERENCE = 0.13  # the probability of a wrong sign falls by e over so much coherence
_NO_AXIS_COHERENCE = 0.085  # the probability of no axis at all falls by e over so much coherence
_LEAST_NO_AXIS = 0.015
_INCOHERENT_AXIS_RAD = 1.0  # standard deviation of the axis in a pocket without coherence: a thigh moves by itself


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
    density = _by_acceleration(cues, sigma_axis_rad) * density_by_rotation(cues)
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
