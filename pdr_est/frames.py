"""Angles, quaternions and planar poses.

Map frame: x east, y north, headings counter-clockwise from east. Quaternions are w first and turn device
coordinates into level or world coordinates. All functions work element by element, so that results do not
depend on how a signal was cut into blocks.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

STANDARD_GRAVITY_MPS2 = 9.80665


def wrap_angle(angle_rad: ArrayLike) -> Array:
    """Angles wrapped to [-pi, pi)."""
    angle = np.asarray(angle_rad, dtype=np.float64)
    wrapped: Array = (angle + np.pi) % (2.0 * np.pi) - np.pi
    return wrapped


def rotation_matrix(heading_rad: float) -> Array:
    """2x2 matrix that turns vectors of a body with this heading into the map frame."""
    c, s = np.cos(heading_rad), np.sin(heading_rad)
    return np.array([[c, -s], [s, c]])


def turned(vectors: Array, angle_rad: ArrayLike) -> Array:
    """Vectors (..., 2) in the plane, each turned counter-clockwise by its angle (...)."""
    c, s = np.cos(angle_rad), np.sin(angle_rad)
    x, y = vectors[..., 0], vectors[..., 1]
    return np.stack([c * x - s * y, s * x + c * y], axis=-1)


def up_in_device(quaternion: Array) -> Array:
    """Unit vector up, in device coordinates, for quaternions device -> level (n, 4), w first. Shape (n, 3)."""
    w, x, y, z = quaternion.T
    return np.stack([2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)], axis=1)


def twist_about_vertical(quaternion: Array) -> Array:
    """Angle of the rotation about the vertical in quaternions device -> level (n, 4), w first. Shape (n,).

    The swing-twist decomposition has no singularity but for a device that lies exactly upside down, so it
    serves for a phone held flat as well as upright, where Euler yaw of ZYX order breaks down.
    """
    return wrap_angle(2.0 * np.arctan2(quaternion[:, 3], quaternion[:, 0]))


def quaternion_from_core_motion(roll_rad: Array, pitch_rad: Array, yaw_rad: Array) -> Array:
    """Quaternions (n, 4), w first, device -> reference, of Core Motion angles: Rz(yaw) Rx(pitch) Ry(roll)."""
    cr, sr = np.cos(roll_rad / 2), np.sin(roll_rad / 2)
    cp, sp = np.cos(pitch_rad / 2), np.sin(pitch_rad / 2)
    cy, sy = np.cos(yaw_rad / 2), np.sin(yaw_rad / 2)
    return np.stack(
        [
            cy * cp * cr - sy * sp * sr,
            cy * sp * cr - sy * cp * sr,
            cy * cp * sr + sy * sp * cr,
            cy * sp * sr + sy * cp * cr,
        ],
        axis=1,
    )
