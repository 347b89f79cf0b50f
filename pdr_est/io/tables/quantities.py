"""Quantities that columns can hold, the project's own titles for them, and the names of their units."""

import re
from collections.abc import Mapping
from enum import StrEnum
from functools import cache

import numpy as np

from pdr_est.io.conversion.units import ACCELERATION_UNITS, CLOCK_UNITS, PRESSURE_UNITS, ROTATION_RATE_UNITS


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

USUAL_UNITS: Mapping[Quantity, Mapping[str, float]] = {
    Quantity.TIME: {unit: 1.0 / per_s for unit, per_s in CLOCK_UNITS.items()}
    | {"100ns": 1e-7, "min": 60.0, "h": 3600.0},
    Quantity.FORCE: ACCELERATION_UNITS,
    Quantity.LINEAR: ACCELERATION_UNITS,
    Quantity.GRAVITY: ACCELERATION_UNITS,
    Quantity.RATE: ROTATION_RATE_UNITS,
    Quantity.FIELD: {"uT": 1.0, "nT": 1e-3, "mT": 1e3, "T": 1e6, "gauss": 100.0, "mgauss": 0.1},
    Quantity.PRESSURE: PRESSURE_UNITS,
    Quantity.ACCURACY: {"m": 1.0},
}
"""Units of each quantity by their usual names, with the factors to SI units (of a magnetic field to µT)."""

_RARE_UNITS: Mapping[str, float] = {
    "cm/s^2": 1e-2,
    "mrad/s": 1e-3,
    "rpm": 2.0 * np.pi / 60.0,
    "mbar": 1e2,
    "bar": 1e5,
}
_ACCELERATION_SPELLINGS = {
    "m/s^2": "m/s/s ms-2 mps2 ms2 mpss mpersec2 mpers2 mss",
    "g": "gs gn g0 gforce",
    "mg": "milli-g millig",
    "cm/s^2": "",
}
# Usual name of each unit -> its other spellings, as `plain_unit` writes them.
_SPELLINGS: Mapping[Quantity, Mapping[str, str]] = {
    Quantity.TIME: {
        "s": "sec secs second seconds sekunden 秒",
        "ms": "msec msecs millis milli millisecond milliseconds 毫秒",
        "us": "usec usecs micros microsecond microseconds 微秒",
        "ns": "nsec nsecs nanos nano nanosecond nanoseconds 纳秒",
        "100ns": "",
        "min": "minutes minuten minutos 分钟 分鐘",
        "h": "hr hrs hours stunden horas heures 小时 小時",
    },
    Quantity.FORCE: _ACCELERATION_SPELLINGS,
    Quantity.LINEAR: _ACCELERATION_SPELLINGS,
    Quantity.GRAVITY: _ACCELERATION_SPELLINGS,
    Quantity.RATE: {
        "rad/s": "rads-1 radps rads rad/sec radpersec radpers",
        "deg/s": "degs-1 degps degs deg/sec degpersec °/s °s-1 dps degrees/s degree/s grad/s º/s °/sec deg.s-1",
        "mdeg/s": "mdps m°/s millidps",
        "mrad/s": "mradps",
        "rpm": "r/min",
    },
    Quantity.FIELD: {
        "uT": "microtesla microt",
        "nT": "nanotesla",
        "mT": "millitesla",
        "T": "tesla",
        "gauss": "g gs",
        "mgauss": "mg milligauss",
    },
    Quantity.PRESSURE: {"Pa": "", "hPa": "", "kPa": "", "mbar": "mb", "bar": ""},
    Quantity.ACCURACY: {"m": "meter meters"},
}
_DROPPED_FROM_UNITS = re.compile(r"[\s^*·()]|_")
_NO_UNITS = frozenset(
    {"", "-", "1", "none", "txt", "deg", "°", "degc", "°c", "c", "%", "lux", "lx", "cm", "bool", "n"}
)


def unit_factor(quantity: Quantity, unit: str) -> float | None:
    """Return the factor to SI units of a unit as it is written in a title; None for one that is not known."""
    return unit_spellings(quantity).get(plain_unit(unit))


def usual_unit(quantity: Quantity, factor: float) -> str | None:
    """Return the usual name of the unit with a factor to SI units; None where there is none."""
    return next((name for name, other in USUAL_UNITS.get(quantity, {}).items() if other == factor), None)


def quantities_of_unit(unit: str) -> tuple[Quantity, ...]:
    """List the quantities that a unit can belong to, those with an acceleration first."""
    plain = plain_unit(unit)
    return tuple(quantity for quantity in _SPELLINGS if plain in unit_spellings(quantity))


def is_unit(text: str) -> bool:
    """Tell whether a cell holds the name of a unit, or nothing."""
    return plain_unit(text) in _NO_UNITS or bool(quantities_of_unit(text))


def plain_unit(unit: str) -> str:
    """Write a unit without blanks, powers and case, with the micro sign as u."""
    text = unit.strip().replace("µ", "u").replace("μ", "u").replace("²", "2").replace("⁻¹", "-1").replace("⁻²", "-2")
    return _DROPPED_FROM_UNITS.sub("", text.casefold())


@cache
def unit_spellings(quantity: Quantity) -> Mapping[str, float]:
    """List the units of a quantity in all spellings, as `plain_unit` writes them, with their factors to SI units."""
    usual = USUAL_UNITS.get(quantity, {})
    return {
        plain_unit(spelling): usual[name] if name in usual else _RARE_UNITS[name]
        for name, others in _SPELLINGS.get(quantity, {}).items()
        for spelling in (name, *others.split())
    }
