"""Rows of a linear least-squares problem in the changes of poses, many of one shape at once."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array


@dataclass(frozen=True)
class LinearRows:
    """Blocks of rows: m blocks of r rows, each in the changes of k poses.

    Attributes
    ----------
    pose
        Numbers (m, k) of the poses; a pose that appears twice has the sum of both parts.
    jacobian
        Coefficients (m, r, 3 k), in standard deviations.
    right
        Wanted values (m, r), in standard deviations.
    """

    pose: NDArray[np.int64]
    jacobian: Array
    right: Array

    def product(self, change: Array) -> Array:
        """Return the product (m, r) with changes (n, 3) of the poses."""
        own = change[self.pose].reshape(len(self.pose), -1, 1)
        return np.asarray((self.jacobian @ own)[..., 0])

    def left_over(self, change: Array) -> Array:
        """Return what is left (m, r) of the wanted values after changes (n, 3) of the poses."""
        return self.right - self.product(change)


def to_map(heading_rad: Array) -> Array:
    """Return the rotations (n, 3, 3) of (forward, left, heading) into (east, north, heading)."""
    c, s = np.cos(heading_rad), np.sin(heading_rad)
    rotation = np.zeros((len(heading_rad), 3, 3))
    rotation[:, 0, 0], rotation[:, 0, 1], rotation[:, 1, 0], rotation[:, 1, 1] = c, -s, s, c
    rotation[:, 2, 2] = 1.0
    return rotation
