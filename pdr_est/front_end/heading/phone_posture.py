"""Posture of the phone on the body: which way is up in it, and its yaw in any posture.

The twist of an attitude about the vertical is undefined for a phone upside down. Counted from the phone's usual
posture, its yaw is well defined for anything less than half a turn away from that.
"""

import numpy as np

from pdr_est.frames import Array
from pdr_est.front_end.heading.level_frame import to_level
from pdr_est.types.sensors import LevelBlock

_LEAST_LENGTH = 1e-9


def mean_up(samples: LevelBlock) -> Array:
    """Compute the mean unit vector (3,) upwards in device axes over some samples."""
    total = samples.up.sum(axis=0)
    return np.asarray(total / max(float(np.linalg.norm(total)), 1e-9))


def mean_yaw(samples: LevelBlock, reference_up: Array) -> float:
    """Compute the mean yaw over some samples of a phone in a known posture.

    Two axes of the phone that are level in that posture are turned into the level frame, where the one is a quarter
    turn ahead of the other.

    Parameters
    ----------
    samples : LevelBlock
        Samples.
    reference_up : ndarray, shape (3,)
        Unit vector upwards in device axes in the usual posture, to which the zero of the yaw belongs.

    Returns
    -------
    float
        Yaw, rad in (-pi, pi].
    """
    first, second = level_axes(reference_up)
    ahead = to_level(np.broadcast_to(first, samples.up.shape), samples.up, samples.yaw_rad)
    aside = to_level(np.broadcast_to(second, samples.up.shape), samples.up, samples.yaw_rad)
    east = np.sum(ahead[:, 0] + aside[:, 1])
    north = np.sum(ahead[:, 1] - aside[:, 0])
    return float(np.arctan2(north, east))


def level_axes(up: Array) -> tuple[Array, Array]:
    """Return two unit vectors (3,) that make a right-handed frame with `up`; the first is near a device axis."""
    axis = np.eye(3)[int(np.argmin(np.abs(up)))]
    first = axis - (axis @ up) * up
    first = first / np.linalg.norm(first)
    return first, np.cross(up, first)


def yaw_between_postures(before: Array, after: Array) -> float:
    """Compute how much larger the yaw of a phone is in a posture that it reached by the shortest way.

    `mean_yaw` counts from a zero that belongs to the posture. On the shortest way from one posture to another the
    phone is tilted and does not turn about the vertical.

    Parameters
    ----------
    before, after : ndarray, shape (3,)
        Unit vectors upwards in device axes.

    Returns
    -------
    float
        Yaw by the posture after less that by the posture before, rad in (-pi, pi].
    """
    carried = level_axes(before)[0]
    total = before + after
    length = float(total @ total)
    if length > _LEAST_LENGTH:  # not upside down
        carried = carried - 2.0 * ((total @ carried) / length) * total + 2.0 * (before @ carried) * after
    first, second = level_axes(after)
    return float(np.arctan2(-(carried @ second), carried @ first))


def angle_between(a: Array, b: Array) -> float:
    """Compute the angle, rad, between two unit vectors (3,)."""
    return float(np.arccos(np.clip(a @ b, -1.0, 1.0)))
