"""Published equations for the length of a step, as pure functions.

Accelerations are (n,) samples of one step in m/s^2, without gravity; lengths are in metres.

References
----------
MMPDR: Tian et al., IEEE Sensors Journal 2016, eqs. 2, 3, 4 and 9. UPTIME: Alzantot and Youssef, WCNC 2012, Table II.
Robust DR: Jin et al., WCNC 2011, eq. 3. Kim et al. 2004, which PSP (Hong et al. 2013) refers to.
"""

from types import MappingProxyType

import numpy as np

from pdr_est.frames import Array
from pdr_est.front_end.step_length.walker import Gender
from pdr_est.types.steps import Gait

STATIC_K1 = MappingProxyType({"male": 0.415, "female": 0.413})  # MMPDR eq. 2
MMPDR_K = MappingProxyType({"male": 0.3139, "female": 0.2975})  # MMPDR eq. 9
GAIT_LENGTH_M = MappingProxyType(  # UPTIME Table II: means of 100 steps, whatever the height and gender
    {Gait.UNKNOWN: 0.74, Gait.WALKING: 0.74, Gait.JOGGING: 1.01, Gait.RUNNING: 1.70}
)
KIM_K = 0.98  # Kim et al. (2004); m / (m/s^2)^(1/3)


def static_length_m(height_m: float, gender: Gender) -> float:
    """Compute MMPDR eq. 2: a constant share of the height."""
    return STATIC_K1[gender] * height_m


def weinberg_length_m(k2: float, vertical_mps2: Array) -> float:
    """Compute MMPDR eq. 3 (also Robust DR eq. 3): fourth root of the range of the vertical acceleration."""
    return range_power_length_m(k2, 0.25, vertical_mps2)


def range_power_length_m(k: float, exponent: float, vertical_mps2: Array) -> float:
    """Compute MMPDR eq. 3 with a free exponent."""
    return float(k * np.ptp(vertical_mps2) ** exponent)


def scarlett_length_m(k3: float, vertical_mps2: Array) -> float:
    """Compute MMPDR eq. 4: cube root of the mean absolute vertical acceleration."""
    return float(k3 * np.mean(np.abs(vertical_mps2)) ** (1.0 / 3.0))


def mmpdr_length_m(height_m: float, gender: Gender, frequency_hz: float) -> float:
    """Compute MMPDR eq. 9; a first step, whose frequency is 0, takes eq. 2 (section III-D)."""
    if frequency_hz == 0.0:
        return static_length_m(height_m, gender)
    return float(MMPDR_K[gender] * height_m * np.sqrt(frequency_hz))


def gait_table_length_m(gait: Gait) -> float:
    """Look up the mean step of a gait in UPTIME's Table II; an unknown gait counts as walking."""
    return GAIT_LENGTH_M[gait]


def kim_length_m(k: float, vertical_mps2: Array) -> float:
    """Compute the equation of Kim et al.: cube root of the mean absolute acceleration.

    PSP section III refers to it and gives neither the equation nor the axis; the vertical acceleration in m/s^2,
    unsmoothed, is taken. The published constant is not one for phones: on held ones it gives 1.3 to 2 times the true
    length.
    """
    return scarlett_length_m(k, vertical_mps2)
