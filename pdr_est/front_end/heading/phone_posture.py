"""Posture of the phone on the body: which way is up in it, and its yaw in any posture.

The twist of an attitude about the vertical is undefined for a phone upside down. Counted from the phone's usual
posture, its yaw is well defined for anything less than half a turn away from that.
"""

from dataclasses import dataclass
from functools import cached_property
from math import acos, atan2, pi

import numpy as np

from pdr_est.frames import Array
from pdr_est.types.steps import StepMotion

Vector = tuple[float, float, float]
"""Vector in device axes."""

_LEAST_LENGTH = 1e-9
_AXES = np.eye(3)


@dataclass(frozen=True)
class Posture:
    """Posture of a phone by its unit vector upwards, to which the zero of a yaw belongs."""

    up: Vector

    @cached_property
    def _level_axes(self) -> tuple[Vector, Vector]:
        first, second = (tuple(axis.tolist()) for axis in level_axes(np.array(self.up)))
        return first, second

    def yaw_rad(self, motion: StepMotion) -> float:
        """Compute the mean yaw of the phone over a step, rad in (-pi, pi].

        Two axes of the phone that are level in this posture are turned into the level frame, where the one is a
        quarter turn ahead of the other.
        """
        (a, b, c), (d, e, f) = self._level_axes
        x, y, z = motion.east
        u, v, w = motion.north
        # Written out, for this is called at every step.
        north_of_first, east_of_second = u * a + v * b + w * c, x * d + y * e + z * f
        east_of_first, north_of_second = x * a + y * b + z * c, u * d + v * e + w * f
        return atan2(north_of_first - east_of_second, east_of_first + north_of_second)

    def angle_to(self, up: Vector) -> float:
        """Compute the angle, rad, to another unit vector upwards."""
        (a, b, c), (x, y, z) = self.up, up
        return acos(min(max(a * x + b * y + c * z, -1.0), 1.0))


def wrapped(angle_rad: float) -> float:
    """Wrap a single angle to [-pi, pi), as `wrap_angle` does at a higher cost."""
    return (angle_rad + pi) % (2.0 * pi) - pi


def posture_of(up: Array) -> Posture:
    """Return the posture of a unit vector (3,) upwards in device axes."""
    x, y, z = up.tolist()
    return Posture((x, y, z))


def level_axes(up: Array) -> tuple[Array, Array]:
    """Return two unit vectors (3,) that make a right-handed frame with `up`; the first is near a device axis."""
    axis = _AXES[int(np.argmin(np.abs(up)))]
    first = axis - (axis @ up) * up
    first = first / np.sqrt(first.dot(first))
    (a, b, c), (x, y, z) = up.tolist(), first.tolist()
    return first, np.array([b * z - c * y, c * x - a * z, a * y - b * x])


def yaw_between_postures(before: Array, after: Array) -> float:
    """Compute how much larger the yaw of a phone is in a posture that it reached by the shortest way.

    `Posture.yaw_rad` counts from a zero that belongs to the posture. On the shortest way from one posture to another
    the phone is tilted and does not turn about the vertical.

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
