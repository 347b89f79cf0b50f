"""Heights by the barometric formula."""

import numpy as np
from numpy.typing import ArrayLike

from pdr_est.frames import Array

_SCALE_HEIGHT_M = 8435.0  # R T / g of the standard atmosphere at sea level (288.15 K)
_REFERENCE_PA = 101_325.0


def height_by_pressure(pressure_pa: ArrayLike) -> Array:
    """Compute heights, m, from an arbitrary level, by the barometric formula.

    In air that is warmer by 10 K, 1 m of them is 1.03 m.
    """
    return np.asarray(_SCALE_HEIGHT_M * np.log(_REFERENCE_PA / np.asarray(pressure_pa, dtype=np.float64)))
