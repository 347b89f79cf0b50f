"""Tell whether an acceleration contains gravity, and the unit of one that does not."""

import numpy as np

from pdr_est.frames import STANDARD_GRAVITY_MPS2, Array
from pdr_est.io.conversion.units import Conversion, detect_acceleration_unit

_PEAK_PERCENTILE = 99.0
# The 99th percentile of |acceleration - gravity| is 2.5 to 30 m/s^2 (0.25 to 3 g) from a calm walk to a run.
_SURELY_G = 0.9
_SURELY_MPS2 = 3.1


def has_gravity(values: Array) -> bool:
    """Tell whether the mean of an acceleration (n, 3), in g or m/s^2, is as long as gravity."""
    return not detect_acceleration_unit(values).warning


def detect_linear_acceleration_unit(values: Array) -> Conversion:
    """Detect whether an acceleration without gravity is in g or m/s^2, from its peaks while a person walks.

    Parameters
    ----------
    values
        (n, 3) acceleration without gravity of one walk.
    """
    peak = float(np.percentile(np.linalg.norm(values, axis=1), _PEAK_PERCENTILE))
    if peak >= _SURELY_MPS2:
        return Conversion(1.0, f"acceleration without gravity is in m/s^2: its peaks reach {peak:.3g}")
    unit, factor = ("g", STANDARD_GRAVITY_MPS2) if peak <= _SURELY_G else ("m/s^2", 1.0)
    decision = f"acceleration without gravity is taken as {unit}: its peaks reach {peak:.3g}"
    if peak <= _SURELY_G:
        return Conversion(factor, decision)
    return Conversion(factor, decision, f"{decision}, which would fit g as well; write the unit into the header")
