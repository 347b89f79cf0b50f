"""North in the level frame of the yaw of a phone, by its own attitude or the magnetic field, for many steps at once.

The offset of north is the mean yaw against north less that of the level frame, NaN where it is not known. Angles are
averaged as unit vectors.
"""

from collections.abc import Sequence
from math import atan2, nan

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.front_end.heading.level_frame import turn_upright
from pdr_est.front_end.signal.step_samples import Places, StepSamples, for_each_step
from pdr_est.types.sensors import LevelBlock

_EARTH_UT = (20.0, 70.0)  # the field is 22 to 67 uT everywhere on the surface


def recorded_north_offsets(samples: Sequence[LevelBlock]) -> list[float]:
    """Compute the offset of north, rad, over the samples of each step by the attitude that the device recorded."""
    present = [block for block in samples if block.recorded_yaw_rad is not None]
    found = iter(for_each_step(present, _by_attitude, nan))
    return [nan if block.recorded_yaw_rad is None else next(found) for block in samples]


def magnetic_north_offsets(samples: Sequence[LevelBlock]) -> list[float]:
    """Compute the offset of magnetic north, rad, over the samples of each step by the magnetic field.

    NaN for a field that cannot be the Earth's, too: of a magnetometer that is not calibrated, or beside a magnet.
    """
    present = [block for block in samples if block.magnetic_field_ut is not None]
    found = iter(for_each_step(present, _by_field, nan))
    return [nan if block.magnetic_field_ut is None else next(found) for block in samples]


def _by_attitude(samples: StepSamples) -> list[float]:
    angle_rad = samples.column("recorded_yaw_rad") - samples.column("yaw_rad")
    known = np.isfinite(angle_rad)
    return _mean_angles(np.cos(angle_rad), np.sin(angle_rad), known, np.ones_like(known), samples.start)


def _by_field(samples: StepSamples) -> list[float]:
    field, yaw_rad = samples.column("magnetic_field_ut").T.copy(), samples.column("yaw_rad")
    x, y, z = field
    strength_ut = np.sqrt(x * x + y * y + z * z)
    possible = (strength_ut >= _EARTH_UT[0]) & (strength_ut <= _EARTH_UT[1])
    east, north = turn_upright(field, samples.column("up").T.copy().T)
    level_ut = np.sqrt(east * east + north * north)
    known = possible & (level_ut > 0.0)
    level_ut = np.where(known, level_ut, 1.0)
    cos, sin = np.cos(yaw_rad) / level_ut, np.sin(yaw_rad) / level_ut
    return _mean_angles(north * cos + east * sin, east * cos - north * sin, known, possible, samples.start)


def _mean_angles(
    cos: Array, sin: Array, known: NDArray[np.bool_], possible: NDArray[np.bool_], first: Places
) -> list[float]:
    """Compute the mean angle of each step over those of its samples whose angles are known.

    NaN if there are none, or if less than half of the samples are possible.
    """
    terms = np.where(known, (cos, sin, known), 0.0)
    cos_sum, sin_sum, count = np.add.reduceat(terms, first, axis=1).tolist()
    share = np.add.reduceat(possible, first, dtype=np.int64) / np.diff(first, append=len(possible))
    return [
        atan2(y, x) if number and enough else nan
        for x, y, number, enough in zip(cos_sum, sin_sum, count, (share >= 0.5).tolist(), strict=True)
    ]
