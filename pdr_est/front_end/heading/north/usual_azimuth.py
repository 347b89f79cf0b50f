"""The direction that a phone in front of the body points to by the usual axes of phones, which is the walker's."""

import numpy as np

from pdr_est.frames import Array
from pdr_est.front_end.heading.level_frame import to_level
from pdr_est.front_end.heading.phone_posture import mean_up
from pdr_est.types.sensors import LevelBlock

_TOP, _BACK = np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, -1.0])
_LYING = float(np.cos(np.deg2rad(30.0)))  # cosine of the tilt below which a phone has no side that is up
_SCREEN_DOWN = -0.3  # upward component of the screen below which nobody looks at it


def usual_azimuth(samples: LevelBlock) -> float:
    """Compute the direction, in the level frame of the yaw, that a phone in front of the body points to.

    Of a phone that lies flat, it is that of the top edge; of an upright one, that of the camera on its back. In
    between the two are the same for a phone in portrait format, and are averaged by their horizontal lengths. In
    landscape format only the back tells the direction.

    Returns
    -------
    float
        Direction, rad, counter-clockwise from the x axis of the level frame; NaN for a phone with its screen down.
    """
    up = mean_up(samples)
    if up[2] < _SCREEN_DOWN:
        return float("nan")
    back = _level_mean(_BACK, samples)
    portrait = up[2] > _LYING or up[1] > abs(up[0])
    if portrait:
        top, level = _level_mean(_TOP, samples), float(np.hypot(up[0], up[1]))
        forward = max(float(up[2]), 0.0) * top + level * back
    else:
        forward = back
    return float(np.arctan2(forward[1], forward[0]))


def _level_mean(axis: Array, samples: LevelBlock) -> Array:
    level: Array = to_level(np.broadcast_to(axis, samples.up.shape), samples.up, samples.yaw_rad).mean(axis=0)
    return level
