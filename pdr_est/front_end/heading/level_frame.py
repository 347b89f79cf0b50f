"""Turn vectors of the device into the level frame: upright by the shortest way, then about the vertical."""

import numpy as np

from pdr_est.frames import Array, rotate_vectors

_LEAST_UPRIGHT = 1e-9  # 1 + cos of the tilt: a device exactly upside down has no shortest way upright, and no yaw


def to_level(vectors: Array, up: Array, yaw_rad: Array) -> Array:
    """Turn vectors into the level frame and return their horizontal part.

    An attitude is the smallest rotation that takes `up` to the z axis, followed by the yaw about it; so these two
    determine the attitude.

    Parameters
    ----------
    vectors : ndarray, shape (n, 3)
        Vectors in device axes.
    up : ndarray, shape (n, 3)
        Unit vector upwards in device axes.
    yaw_rad : ndarray, shape (n,)
        Rotation about the vertical, as `twist_about_vertical` gives it.

    Returns
    -------
    ndarray, shape (n, 2)
        East and north components in the level frame of the yaw.
    """
    return rotate_vectors(np.stack(turn_upright(vectors.T, up), axis=1), yaw_rad)


def turn_upright(components: Array, up: Array) -> tuple[Array, Array]:
    """Turn vectors by the smallest rotation that takes `up` to the z axis; return their two horizontal components.

    Parameters
    ----------
    components : ndarray, shape (3, n) or (3,)
        Vectors in device axes by component, or a single one to turn by the tilt of each sample.
    up : ndarray, shape (n, 3)
        Unit vector upwards in device axes.

    Returns
    -------
    x, y : ndarray, shape (n,)
        Horizontal components, before any rotation about the vertical.
    """
    (x, y, z), (up_x, up_y, up_z) = components, up.T
    tilted = z + (up_x * x + up_y * y) / np.maximum(1.0 + up_z, _LEAST_UPRIGHT)
    return x - up_x * tilted, y - up_y * tilted


def upright_axes(up: Array) -> tuple[tuple[Array, Array], tuple[Array, Array], tuple[Array, Array]]:
    """Turn the three device axes by the smallest rotation that takes `up` (3, n) to the z axis.

    Returns
    -------
    x_axis, y_axis, z_axis : tuple of ndarray, shape (n,)
        Horizontal components of each, as `turn_upright` gives them.
    """
    up_x, up_y, up_z = up
    upright = np.maximum(1.0 + up_z, _LEAST_UPRIGHT)
    across = -up_x * up_y / upright
    return (1.0 - up_x * up_x / upright, across), (across, 1.0 - up_y * up_y / upright), (-up_x, -up_y)
