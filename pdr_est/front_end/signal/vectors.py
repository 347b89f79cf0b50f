"""Products of rows of vectors, the same to the last bit in whatever block a row lies.

The sums are written out: in batched products (`@`, einsum, norm) the order of additions depends on the number of
rows.
"""

import numpy as np

from pdr_est.frames import STANDARD_GRAVITY_MPS2, Array


def dot(a: Array, b: Array) -> Array:
    """Scalar products (n,) of the rows of a and b, (n, 3) each."""
    x, y, z = (a * b).T
    product: Array = x + y + z
    return product


def norm(vectors: Array) -> Array:
    """Lengths (n,) of the rows of (n, 3)."""
    length: Array = np.sqrt(dot(vectors, vectors))
    return length


def specific_force(up: Array, acceleration_mps2: Array) -> Array:
    """The accelerometer's reading (n, 3) in device axes, gravity included.

    up: (n, 3) unit vector up; acceleration_mps2: (n, 3) without gravity; both in device axes.
    """
    return acceleration_mps2 + STANDARD_GRAVITY_MPS2 * up


def excess_magnitude(up: Array, acceleration_mps2: Array) -> Array:
    """Length of the specific force less standard gravity (n,), m/s^2: the same for every orientation of the phone."""
    return norm(specific_force(up, acceleration_mps2)) - STANDARD_GRAVITY_MPS2
