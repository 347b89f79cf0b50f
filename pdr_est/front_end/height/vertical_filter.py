"""Kalman filters of height, error of the height by the pressure, and vertical speed: what a second does to them."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.front_end.height import vertical_moves as modes
from pdr_est.front_end.height.height_params import HeightParams

STEADY, JUMP, GREAT_JUMP = range(3)
"""Cases of the error of the pressure in a second: it wanders, or it has jumped, or jumped far."""

Numbers = NDArray[np.int64]


class Passage(NamedTuple):
    """Change of a filter by a second in a mode, after one in the same mode or another.

    Of height h, error e and speed s, `h + height_by_speed s`, e and `speed_kept s` are left. A change of the speed
    within the second, evenly, then moves the height by half of itself.

    Attributes
    ----------
    height_by_speed
        Change of the height by the speed of the second before, s.
    speed_kept
        Share of the speed that is kept.
    speed_mps, variance_m2ps2
        Mean and variance of the change of the speed, m/s and m²/s².
    """

    height_by_speed: float
    speed_kept: float
    speed_mps: float
    variance_m2ps2: float


def passage(before: int, mode: int) -> Passage:
    """Return what a second in a mode does after one in another mode, or in the same."""
    speed, variance = float(modes.SPEED_MPS[mode]), float(modes.SIGMA_SPEED_MPS[mode]) ** 2
    if before == mode and modes.direction_of(mode):
        kept = float(modes.STEADINESS[mode])
        return Passage(0.5 * (1.0 + kept), kept, (1.0 - kept) * speed, (1.0 - kept**2) * variance)
    ends_within_m = 0.5 * abs(modes.direction_of(before))  # half a second of it
    return Passage(ends_within_m, 0.0, speed, variance)


def jump_variances_m2(parameters: HeightParams) -> Array:
    """Return what each case adds to the variance of the error of the pressure (cases,), m²."""
    return np.array([0.0, parameters.sigma_jump_m**2, parameters.sigma_great_jump_m**2])
