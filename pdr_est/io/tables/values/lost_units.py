"""Refuse values whose unit is lost: the counts of a sensor chip, and values that were normalised for learning."""

from collections.abc import Mapping

import numpy as np

from pdr_est.errors import RecordingError
from pdr_est.frames import STANDARD_GRAVITY_MPS2, Array
from pdr_est.io.conversion.units import detect_acceleration_unit, mean_vector, sampled_rows
from pdr_est.io.tables.placed import PlacedSignal
from pdr_est.io.tables.quantities import MOTION, Quantity

_FEWEST_COUNTS = 20.0  # in gravity; fewer are m/s^2 or g
_GRAVITY_SHARE = 0.65  # length of the mean by that of the vectors, as in `units`
_FEWEST_ROWS = 50
_EXACT, _ALMOST = 1e-9, 2e-3
_ROUGHLY = 0.2  # by some of the rows of a long recording
_RANGES = ((0.0, 1.0), (-1.0, 1.0))


def refuse_unusable_values(placed: Mapping[Quantity, PlacedSignal], place: str) -> None:
    """Refuse accelerations in counts, how many of which are in a g depends on settings, and normalised values.

    Parameters
    ----------
    placed
        Signals of a device as they were recorded.
    place
        Name of the file, for messages.

    Raises
    ------
    RecordingError
        When the values of accelerometer or gyroscope have lost their unit.
    """
    for quantity in MOTION:
        one = placed.get(quantity)
        if one is not None and len(one.raw.signal) >= _FEWEST_ROWS:
            _refuse_normalised(one.raw.signal.values, one.raw.title, place)
    force = placed.get(Quantity.FORCE)
    if force is not None and force.raw.factor is None:
        _refuse_counts(force.raw.signal.values, force.raw.title, place)


def _refuse_normalised(values: Array, title: str, place: str) -> None:
    """Refuse values of which each axis was scaled by itself."""
    sample = sampled_rows(values)
    within = np.abs(sample).max() <= 1.0 + _EXACT
    standard = (np.abs(sample.mean(axis=0)) < _ROUGHLY).all() and (np.abs(sample.std(axis=0) - 1.0) < _ROUGHLY).all()
    if not within and not standard:
        return
    how = ""
    low, high = values.min(axis=0), values.max(axis=0)
    for lowest, highest in _RANGES:
        if (np.abs(low - lowest) < _EXACT).all() and (np.abs(high - highest) < _EXACT).all():
            how = f"each axis runs from {lowest:g} to {highest:g}"
    mean = mean_vector(values)
    if (np.abs(mean) < _ALMOST).all() and (np.abs(values.std(axis=0) - 1.0) < _ALMOST).all():
        how = "each axis has mean 0 and standard deviation 1"
    if how:
        raise RecordingError(
            f"{place}: {title} were normalised, because {how}: what the sensor measured cannot be recovered; use the "
            "values before normalisation, with gravity, in m/s^2 or g and rad/s or deg/s"
        )


def _refuse_counts(values: Array, title: str, place: str) -> None:
    """Refuse integers that are as long as gravity in no unit."""
    vector = mean_vector(values)
    length = float(np.linalg.norm(vector))
    if not length >= _FEWEST_COUNTS or (values != np.round(values)).any():
        return
    if not detect_acceleration_unit(values).warning:
        return
    if length < _GRAVITY_SHARE * float(np.median(np.linalg.norm(values, axis=1))):
        return  # no gravity in them
    raise RecordingError(
        f"{place}: {title} are integers whose mean has length {length:.0f}, which is no usual unit: if "
        "they are the counts of a sensor chip, state what one is with --map, such as unit: "
        f"{STANDARD_GRAVITY_MPS2 / length:.4g} for the accelerometer ({STANDARD_GRAVITY_MPS2:g} m/s^2 in "
        f"{length:.0f} counts; the chip's data sheet says how many) and unit: 0.0001332 for the gyroscope "
        "(131 counts in 1 deg/s)"
    )
