"""Products of rows of vectors, and the specific force; bit-identical in whatever block a row lies.

The sums are written out, because in batched products (`@`, einsum, norm) the order of the additions depends on the
number of rows.
"""

import numpy as np

from pdr_est.frames import STANDARD_GRAVITY_MPS2, Array


def dot(a: Array, b: Array) -> Array:
    """Compute the scalar products (n,) of the rows of `a` and `b`, (n, 3) each."""
    x, y, z = (a * b).T
    product: Array = x + y + z
    return product


def norm(vectors: Array) -> Array:
    """Compute the lengths (n,) of the rows of an array (n, 3)."""
    length: Array = np.sqrt(dot(vectors, vectors))
    return length


def specific_force(up: Array, acceleration_mps2: Array) -> Array:
    """Compute the accelerometer's reading (n, 3), m/s^2, in device axes, gravity included.

    Parameters
    ----------
    up : ndarray, shape (n, 3)
        Unit vector upwards in device axes.
    acceleration_mps2 : ndarray, shape (n, 3)
        Acceleration without gravity in device axes.
    """
    return acceleration_mps2 + STANDARD_GRAVITY_MPS2 * up


def excess_magnitude(up: Array, acceleration_mps2: Array) -> Array:
    """Compute the length of the specific force less standard gravity, (n,) m/s^2.

    It is the same for every orientation of the phone. See `specific_force` for the arguments.
    """
    return norm(specific_force(up, acceleration_mps2)) - STANDARD_GRAVITY_MPS2
