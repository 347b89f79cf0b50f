"""Axes for an attitude filter that do not depend on how those of the device lie."""

import numpy as np

from pdr_est.frames import Array

_LEAST_FORCE_MPS2 = 1e-9  # specific force below which a sample has no direction of gravity
_LEAST_RATE_RADPS = 1e-6  # rotation rate below which a sample has no direction of rotation


class AxisTurn:
    """Turn from the axes of the device into others, whose unit vectors are the rows of a matrix (3, 3)."""

    def __init__(self, matrix: Array) -> None:
        self._matrix = matrix
        w, x, y, z = _quaternion(matrix)
        self._right = np.array([[w, -x, -y, -z], [x, w, z, -y], [y, -z, w, x], [z, y, -x, w]])

    def vectors(self, values: Array) -> Array:
        """Turn vectors (n, 3) into the other axes."""
        return _multiplied(self._matrix, values)

    def vectors_back(self, values: Array) -> Array:
        """Turn vectors (n, 3) in the other axes into those of the device."""
        return _multiplied(self._matrix.T, values)

    def attitudes(self, quaternion: Array) -> Array:
        """Compute the attitudes (n, 4) of the device from those of the other axes."""
        return _multiplied(self._right, quaternion)


def _multiplied(matrix: Array, rows: Array) -> Array:
    """Multiply each of some rows (n, k) with a matrix (k, k); the rounding does not depend on their number."""
    columns = rows.T.copy()  # each in one piece of memory
    product = np.empty_like(columns)
    term = np.empty(len(rows))
    for own, factors in zip(product, matrix, strict=True):
        np.multiply(columns[0], factors[0], out=own)
        for column, factor in zip(columns[1:], factors[1:], strict=True):
            own += np.multiply(column, factor, out=term)
    return np.ascontiguousarray(product.T)


def _quaternion(matrix: Array) -> list[float]:
    """Compute the unit quaternion, w first, of a rotation matrix (3, 3)."""
    r = matrix
    # Each row is the quaternion times four times one of its elements; the longest is the most accurate.
    multiples = np.array(
        [
            [1.0 + r[0, 0] + r[1, 1] + r[2, 2], r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]],
            [r[2, 1] - r[1, 2], 1.0 + r[0, 0] - r[1, 1] - r[2, 2], r[1, 0] + r[0, 1], r[0, 2] + r[2, 0]],
            [r[0, 2] - r[2, 0], r[1, 0] + r[0, 1], 1.0 - r[0, 0] + r[1, 1] - r[2, 2], r[2, 1] + r[1, 2]],
            [r[1, 0] - r[0, 1], r[0, 2] + r[2, 0], r[2, 1] + r[1, 2], 1.0 - r[0, 0] - r[1, 1] + r[2, 2]],
        ]
    )
    longest = multiples[int(np.argmax(np.diagonal(multiples)))]
    quaternion: list[float] = (longest / np.linalg.norm(longest)).tolist()
    return quaternion


def axes_through(force: Array, rate: Array) -> Array:
    """Make axes, the rows of (3, 3), along a specific force and what is level of a rotation rate, (3,) each.

    A sample without rotation leaves the level axes to those of the device.
    """
    length = float(np.linalg.norm(force))
    up = force / length if length > _LEAST_FORCE_MPS2 else np.array([0.0, 0.0, 1.0])
    level = rate - (rate @ up) * up
    if float(np.linalg.norm(level)) < _LEAST_RATE_RADPS:
        axis = np.eye(3)[int(np.argmin(np.abs(up)))]
        level = axis - (axis @ up) * up
    first = level / np.linalg.norm(level)
    return np.stack([first, np.cross(up, first), up])
