"""Quantities that columns can hold, the project's own titles for them, and the names of their units."""

from collections.abc import Mapping
from enum import StrEnum
from functools import cache

import numpy as np

from pdr_est.io.conversion.units import ACCELERATION_UNITS, CLOCK_UNITS, PRESSURE_UNITS, ROTATION_RATE_UNITS
from pdr_est.io.tables.words.units import (
    ACCELERATION_SPELLINGS,
    FIELD_SPELLINGS,
    LENGTH_SPELLINGS,
    PRESSURE_SPELLINGS,
    RATE_SPELLINGS,
    TIME_SPELLINGS,
    WITHOUT_MEANING,
    plain_unit,
)


class Quantity(StrEnum):
    """Quantity that a group of columns holds."""

    TIME = "time"
    FORCE = "specific force"
    RATE = "rotation rate"
    FIELD = "magnetic field"
    GRAVITY = "gravity"
    LINEAR = "acceleration without gravity"
    ATTITUDE = "attitude"
    ROTATION_VECTOR = "rotation vector"
    PRESSURE = "air pressure"
    TRUE_POSITION = "true position"
    LATITUDE_LONGITUDE = "latitude and longitude"
    ACCURACY = "horizontal accuracy"


CANONICAL: Mapping[Quantity, tuple[str, ...]] = {
    Quantity.TIME: ("time_s",),
    Quantity.FORCE: ("acc_x_mps2", "acc_y_mps2", "acc_z_mps2"),
    Quantity.RATE: ("gyr_x_radps", "gyr_y_radps", "gyr_z_radps"),
    Quantity.FIELD: ("mag_x_ut", "mag_y_ut", "mag_z_ut"),
    Quantity.ATTITUDE: ("qw", "qx", "qy", "qz"),
    Quantity.PRESSURE: ("pressure_pa",),
    Quantity.TRUE_POSITION: ("true_x_m", "true_y_m"),
}
"""The documented header. A cell is empty where a sensor has no sample at that time."""

AXES: Mapping[Quantity, tuple[str, ...]] = {
    Quantity.TIME: ("",),
    Quantity.FORCE: ("x", "y", "z"),
    Quantity.RATE: ("x", "y", "z"),
    Quantity.FIELD: ("x", "y", "z"),
    Quantity.GRAVITY: ("x", "y", "z"),
    Quantity.LINEAR: ("x", "y", "z"),
    Quantity.ATTITUDE: ("w", "x", "y", "z"),
    Quantity.ROTATION_VECTOR: ("x", "y", "z"),
    Quantity.PRESSURE: ("",),
    Quantity.TRUE_POSITION: ("x", "y"),
    Quantity.LATITUDE_LONGITUDE: ("latitude", "longitude"),
    Quantity.ACCURACY: ("",),
}
"""Names of the columns of each quantity, in their order."""

MOTION = (Quantity.FORCE, Quantity.LINEAR, Quantity.RATE)
"""Quantities of which a recording needs at least one; the first that is there gives its time."""

LENGTH_UNITS: Mapping[str, float] = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "km": 1e3, "ft": 0.3048}
"""Units of length with their factors to m."""

USUAL_UNITS: Mapping[Quantity, Mapping[str, float]] = {
    Quantity.TIME: {unit: 1.0 / per_s for unit, per_s in CLOCK_UNITS.items()}
    | {"100ns": 1e-7, "min": 60.0, "h": 3600.0},
    Quantity.FORCE: ACCELERATION_UNITS,
    Quantity.LINEAR: ACCELERATION_UNITS,
    Quantity.GRAVITY: ACCELERATION_UNITS,
    Quantity.RATE: ROTATION_RATE_UNITS,
    Quantity.FIELD: {"uT": 1.0, "nT": 1e-3, "mT": 1e3, "T": 1e6, "gauss": 100.0, "mgauss": 0.1},
    Quantity.PRESSURE: PRESSURE_UNITS,
    Quantity.ACCURACY: LENGTH_UNITS,
}
"""Units of each quantity by their usual names, with the factors to SI units (of a magnetic field to µT)."""

_RARE_UNITS: Mapping[str, float] = {
    "cm/s^2": 1e-2,
    "mm/s^2": 1e-3,
    "ft/s^2": 0.3048,
    "ug": 1e-3 * ACCELERATION_UNITS["mg"],
    "mrad/s": 1e-3,
    "rpm": 2.0 * np.pi / 60.0,
    "rev/s": 2.0 * np.pi,
    "mbar": 1e2,
    "bar": 1e5,
}
# Usual name of each unit -> its other spellings, as `plain_unit` writes them.
_SPELLINGS: Mapping[Quantity, Mapping[str, str]] = {
    Quantity.TIME: TIME_SPELLINGS,
    Quantity.FORCE: ACCELERATION_SPELLINGS,
    Quantity.LINEAR: ACCELERATION_SPELLINGS,
    Quantity.GRAVITY: ACCELERATION_SPELLINGS,
    Quantity.RATE: RATE_SPELLINGS,
    Quantity.FIELD: FIELD_SPELLINGS,
    Quantity.PRESSURE: PRESSURE_SPELLINGS,
    Quantity.ACCURACY: LENGTH_SPELLINGS,
}


def unit_factor(quantity: Quantity, unit: str) -> float | None:
    """Return the factor to SI units of a unit as it is written in a title; None for one that is not known."""
    return unit_spellings(quantity).get(plain_unit(unit))


def usual_unit(quantity: Quantity, factor: float) -> str | None:
    """Return the usual name of the unit with a factor to SI units; None where there is none."""
    return next((name for name, other in USUAL_UNITS.get(quantity, {}).items() if other == factor), None)


def known_units(quantity: Quantity) -> Mapping[str, float]:
    """List the units of a quantity, the usual and the rare ones, with their factors to SI units."""
    usual = USUAL_UNITS.get(quantity, {})
    return {**usual, **{name: _RARE_UNITS[name] for name in _SPELLINGS.get(quantity, {}) if name not in usual}}


def quantities_of_unit(unit: str) -> tuple[Quantity, ...]:
    """List the quantities that a unit can belong to, those with an acceleration first."""
    plain = plain_unit(unit)
    return tuple(quantity for quantity in _SPELLINGS if plain in unit_spellings(quantity))


def is_unit(text: str) -> bool:
    """Tell whether a cell holds the name of a unit, or nothing."""
    return plain_unit(text) in WITHOUT_MEANING or bool(quantities_of_unit(text))


@cache
def unit_spellings(quantity: Quantity) -> Mapping[str, float]:
    """List the units of a quantity in all spellings, as `plain_unit` writes them, with their factors to SI units."""
    usual = USUAL_UNITS.get(quantity, {})
    return {
        plain_unit(spelling): usual[name] if name in usual else _RARE_UNITS[name]
        for name, others in _SPELLINGS.get(quantity, {}).items()
        for spelling in (name, *others.split())
    }
