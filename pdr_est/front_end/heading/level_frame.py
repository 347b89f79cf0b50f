"""Vectors of the device in the level frame: turned upright by the shortest way, then about the vertical."""

import numpy as np

from pdr_est.frames import Array, rotate_vectors

_LEAST_UPRIGHT = 1e-9  # of 1 + cos: a device exactly upside down has no shortest way, and no yaw either


def to_level(vectors: Array, up: Array, yaw_rad: Array) -> Array:
    """East and north components (n, 2), in the level frame of the yaw, of vectors (n, 3) in device axes.

    up: (n, 3) unit vector up in device axes; yaw_rad: (n,) rotation about the vertical, as `twist_about_vertical`
    tells it. An attitude is the smallest rotation that takes `up` to the z axis, followed by the yaw about it; so
    these two tell the attitude, and this is what it makes of the horizontal part of the vectors.
    """
    x, y, z = vectors.T
    up_x, up_y, up_z = up.T
    tilted = z + (up_x * x + up_y * y) / np.maximum(1.0 + up_z, _LEAST_UPRIGHT)
    return rotate_vectors(np.stack([x - up_x * tilted, y - up_y * tilted], axis=1), yaw_rad)
