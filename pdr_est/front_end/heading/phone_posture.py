"""Posture of the phone on the body: which way is up in it, and its yaw in any posture.

The twist of an attitude about the vertical is undefined for a phone upside down. Counted from the phone's usual
posture, its yaw is well defined for anything less than half a turn away from that.
"""

import numpy as np

from pdr_est.frames import Array
from pdr_est.front_end.heading.level_frame import turn_upright
from pdr_est.types.sensors import LevelBlock

_LEAST_LENGTH = 1e-9
_AXES = np.eye(3)


def mean_up(samples: LevelBlock) -> Array:
    """Compute the mean unit vector (3,) upwards in device axes over some samples."""
    total = samples.up.sum(axis=0)
    return np.asarray(total / max(float(np.sqrt(total.dot(total))), 1e-9))


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
    # `to_level` of both axes would turn them by the yaw one after the other; this is done at every step.
    c, s = np.cos(samples.yaw_rad), np.sin(samples.yaw_rad)
    (first_x, first_y), (second_x, second_y) = (turn_upright(axis, samples.up) for axis in (first, second))
    east = np.add.reduce((c * first_x - s * first_y) + (s * second_x + c * second_y))
    north = np.add.reduce((s * first_x + c * first_y) - (c * second_x - s * second_y))
    return float(np.arctan2(north, east))


def level_axes(up: Array) -> tuple[Array, Array]:
    """Return two unit vectors (3,) that make a right-handed frame with `up`; the first is near a device axis."""
    axis = _AXES[int(np.argmin(np.abs(up)))]
    first = axis - (axis @ up) * up
    first = first / np.sqrt(first.dot(first))
    (a, b, c), (x, y, z) = up.tolist(), first.tolist()
    return first, np.array([b * z - c * y, c * x - a * z, a * y - b * x])


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
    return float(np.arccos(min(max(float(a @ b), -1.0), 1.0)))
