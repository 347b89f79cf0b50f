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


def axes_upright(up: Array, vector: Array) -> tuple[Array, Array]:
    """Turn the three device axes, and a vector, by the smallest rotation that takes `up` to the z axis.

    Parameters
    ----------
    up : ndarray, shape (3, n)
        Unit vector upwards in device axes, by component.
    vector : ndarray, shape (3, n)
        Vector in device axes, by component.

    Returns
    -------
    x, y : ndarray, shape (4, n)
        Horizontal components of the axes and of the vector, as `turn_upright` gives them.
    """
    x, y = np.empty((2, 4, up.shape[1]))
    lean = up[:2] / np.maximum(1.0 + up[2], _LEAST_UPRIGHT)
    np.multiply(up[:2], -lean[0], out=x[:2])
    y[0] = x[1]
    x[0] += 1.0
    y[1] = 1.0 - up[1] * lean[1]
    x[2], y[2] = -up[0], -up[1]
    tilted = vector[2] + (lean[0] * vector[0] + lean[1] * vector[1])
    x[3], y[3] = vector[0] - up[0] * tilted, vector[1] - up[1] * tilted
    return x, y
