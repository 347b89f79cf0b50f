"""Products of rows of vectors, the same to the last bit in whatever block a row lies.

The sums are written out: in batched products (`@`, einsum, norm) the order of additions depends on the number of
rows.
"""

import numpy as np

from pdr_est.frames import Array


def dot(a: Array, b: Array) -> Array:
    """Scalar products (n,) of the rows of a and b, (n, 3) each."""
    x, y, z = (a * b).T
    product: Array = x + y + z
    return product


def norm(vectors: Array) -> Array:
    """Lengths (n,) of the rows of (n, 3)."""
    length: Array = np.sqrt(dot(vectors, vectors))
    return length
