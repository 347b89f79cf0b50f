"""North in the level frame of the yaw of a phone, by its own attitude or by the magnetic field."""

import numpy as np

from pdr_est.frames import Array
from pdr_est.front_end.heading.magnetometer import magnetic_yaw
from pdr_est.types.sensors import LevelBlock

_EARTH_UT = (20.0, 70.0)  # the field is 22 to 67 uT everywhere on the surface


def recorded_north_offset(samples: LevelBlock) -> float:
    """Return mean yaw by the recorded attitude less that of the level frame, rad; NaN where it was not recorded."""
    if samples.recorded_yaw_rad is None:
        return float("nan")
    return _mean_angle(samples.recorded_yaw_rad - samples.yaw_rad)


def magnetic_north_offset(samples: LevelBlock) -> float:
    """Return the mean yaw against magnetic north less that of the level frame, rad.

    NaN without field, and for one that cannot be the Earth's: of a magnetometer that is not calibrated, or beside a
    magnet.
    """
    if samples.magnetic_field_ut is None:
        return float("nan")
    strength_ut = np.linalg.norm(samples.magnetic_field_ut, axis=1)
    possible = (strength_ut >= _EARTH_UT[0]) & (strength_ut <= _EARTH_UT[1])
    if np.count_nonzero(possible) < 0.5 * len(possible):
        return float("nan")
    return _mean_angle(magnetic_yaw(samples)[possible] - samples.yaw_rad[possible])


def _mean_angle(angle_rad: Array) -> float:
    known = angle_rad[np.isfinite(angle_rad)]
    if not len(known):
        return float("nan")
    return float(np.arctan2(np.sin(known).sum(), np.cos(known).sum()))
