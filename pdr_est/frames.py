"""Map frame, angles, quaternions and planar rotations.

Map frame: x east, y north, headings counter-clockwise from east. Quaternions are w first and rotate device
coordinates into level or world coordinates. Every function works element by element, so that a result does not
depend on how a signal was cut into blocks.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
"""Array of double-precision numbers, the only floating-point type of the library."""

STANDARD_GRAVITY_MPS2 = 9.80665
"""Standard acceleration of gravity (m/s²)."""

SIGMA_UNIFORM_RAD = float(np.pi / np.sqrt(3.0))
"""Standard deviation of an angle of which nothing is known: uniform on the circle (rad)."""


@dataclass(frozen=True)
class GeoOrigin:
    """Origin of the map frame on the WGS 84 ellipsoid.

    Attributes
    ----------
    latitude_deg, longitude_deg
        Geodetic coordinates, degrees.
    """

    latitude_deg: float
    longitude_deg: float


def wrap_angle(angle_rad: ArrayLike) -> Array:
    """Wrap angles to [-pi, pi).

    Parameters
    ----------
    angle_rad
        One angle or an array of any shape, rad.

    Returns
    -------
    Array
        The wrapped angles in the same shape, rad.
    """
    angle = np.asarray(angle_rad, dtype=np.float64)
    wrapped: Array = (angle + np.pi) % (2.0 * np.pi) - np.pi
    return wrapped


def rotation_matrix(heading_rad: float) -> Array:
    """Return the 2x2 matrix that rotates vectors from the frame of a body with this heading into the map frame."""
    c, s = np.cos(heading_rad), np.sin(heading_rad)
    return np.array([[c, -s], [s, c]])


def rotate_vectors(vectors: Array, angle_rad: ArrayLike) -> Array:
    """Rotate each plane vector counter-clockwise by its own angle.

    Parameters
    ----------
    vectors
        (..., 2) vectors in the plane.
    angle_rad
        (...) rotation angles, rad; one angle serves all vectors.

    Returns
    -------
    Array
        (..., 2) rotated vectors.
    """
    c, s = np.cos(angle_rad), np.sin(angle_rad)
    x, y = vectors[..., 0], vectors[..., 1]
    return np.stack([c * x - s * y, s * x + c * y], axis=-1)


def up_in_device(quaternion: Array) -> Array:
    """Compute the upward unit vector in device axes.

    Parameters
    ----------
    quaternion
        (n, 4) attitudes, w first, device to level frame.

    Returns
    -------
    Array
        (n, 3) unit vectors.
    """
    w, x, y, z = quaternion.T
    return np.stack([2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)], axis=1)


def twist_about_vertical(quaternion: Array) -> Array:
    """Compute the rotation angle about the vertical (the twist of a swing-twist decomposition).

    The decomposition is singular only for a device that lies exactly upside down. It therefore serves a phone held
    flat as well as one held upright, where the yaw of Euler angles in ZYX order breaks down.

    Parameters
    ----------
    quaternion
        (n, 4) attitudes, w first, device to level frame.

    Returns
    -------
    Array
        (n,) angles in [-pi, pi), rad, counter-clockwise seen from above.
    """
    return wrap_angle(2.0 * np.arctan2(quaternion[:, 3], quaternion[:, 0]))


def quaternion_from_core_motion(roll_rad: Array, pitch_rad: Array, yaw_rad: Array) -> Array:
    """Convert Euler angles of Apple's Core Motion into quaternions.

    Core Motion composes the attitude as Rz(yaw) Rx(pitch) Ry(roll).

    Parameters
    ----------
    roll_rad, pitch_rad, yaw_rad
        (n,) angles, rad.

    Returns
    -------
    Array
        (n, 4) quaternions, w first, device to reference frame.
    """
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
