"""Tell whether an acceleration contains gravity, and the unit of one that does not."""

import numpy as np

from pdr_est.frames import STANDARD_GRAVITY_MPS2, Array
from pdr_est.io.conversion.units import Conversion, detect_acceleration_unit, mean_vector, sampled_rows
from pdr_est.types.recording import Signal

_PEAK_PERCENTILE = 99.0
# The 99th percentile of |acceleration - gravity| is 2.5 to 30 m/s^2 (0.25 to 3 g) from a calm walk to a run.
_SURELY_G = 0.9
_SURELY_MPS2 = 3.1
_GRAVITY_SHARE = 0.65
_STATIC_MPS2 = (6.5, 20.0)  # as in `units`
_PARTS = 10
_FEWEST_SAMPLES, _SHORTEST_S = 50, 5.0
_GRAVITY_LENGTHS = (STANDARD_GRAVITY_MPS2, 1.0, 1000.0)


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


def lacks_gravity(signal: Signal, factor: float | None = None) -> bool:
    """Tell whether an acceleration is surely without gravity, in whatever unit it is.

    Its mean vector, in tenths of the recording, is then shorter than 65 % of the median norm
    (`units.detect_acceleration_unit` says where that number comes from), and not as long as gravity. A recording of
    less than 5 s or 50 samples does not tell.

    Parameters
    ----------
    signal
        (n, 3) acceleration.
    factor
        Factor to m/s²; None where the unit is not known.
    """
    if len(signal) < _FEWEST_SAMPLES or np.ptp(signal.time_s) < _SHORTEST_S:
        return False
    parts = [np.linalg.norm(mean_vector(part)) for part in np.array_split(signal.values, _PARTS)]
    norm = float(np.median(np.linalg.norm(sampled_rows(signal.values), axis=1)))
    mean = float(np.median(parts)) * (1.0 if factor is None else factor)
    return float(np.median(parts)) < _GRAVITY_SHARE * norm and not _STATIC_MPS2[0] <= mean <= _STATIC_MPS2[1]


def is_gravity(values: Array) -> bool:
    """Tell whether all vectors (n, 3) are as long as gravity in m/s^2, g or mg, as those of a gravity sensor are."""
    sample = sampled_rows(values)
    norm = np.linalg.norm(sample[np.isfinite(sample).all(axis=1)], axis=1)
    if not len(norm):
        return False
    low, middle, high = np.percentile(norm, (2.0, 50.0, 98.0))
    return bool(high - low < 0.02 * middle and any(abs(middle / unit - 1.0) < 0.02 for unit in _GRAVITY_LENGTHS))
