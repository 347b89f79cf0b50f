"""Quantities that columns can hold, the project's own titles for them, and the names of their units."""

import re
from collections.abc import Mapping
from enum import StrEnum

import numpy as np

from pdr_est.frames import STANDARD_GRAVITY_MPS2


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

_ACCELERATION_UNITS = {
    "m/s2": 1.0,
    "m/s/s": 1.0,
    "ms-2": 1.0,
    "mps2": 1.0,
    "ms2": 1.0,
    "mpss": 1.0,
    "mpersec2": 1.0,
    "mpers2": 1.0,
    "mss": 1.0,
    "g": STANDARD_GRAVITY_MPS2,
    "gs": STANDARD_GRAVITY_MPS2,
    "gn": STANDARD_GRAVITY_MPS2,
    "g0": STANDARD_GRAVITY_MPS2,
    "gforce": STANDARD_GRAVITY_MPS2,
    "mg": 1e-3 * STANDARD_GRAVITY_MPS2,
    "milli-g": 1e-3 * STANDARD_GRAVITY_MPS2,
    "millig": 1e-3 * STANDARD_GRAVITY_MPS2,
    "cm/s2": 1e-2,
}
_DEGREE = np.pi / 180.0
_UNITS: Mapping[Quantity, Mapping[str, float]] = {
    Quantity.TIME: {
        **dict.fromkeys(("s", "sec", "secs", "second", "seconds", "sekunden", "秒"), 1.0),
        **dict.fromkeys(("ms", "msec", "msecs", "millis", "milli", "millisecond", "milliseconds", "毫秒"), 1e-3),
        **dict.fromkeys(("us", "usec", "usecs", "micros", "microsecond", "microseconds", "微秒"), 1e-6),
        **dict.fromkeys(("ns", "nsec", "nsecs", "nanos", "nano", "nanosecond", "nanoseconds", "纳秒"), 1e-9),
    },
    Quantity.FORCE: _ACCELERATION_UNITS,
    Quantity.LINEAR: _ACCELERATION_UNITS,
    Quantity.GRAVITY: _ACCELERATION_UNITS,
    Quantity.RATE: {
        **dict.fromkeys(("rad/s", "rads-1", "radps", "rads", "rad/sec", "radpersec", "radpers"), 1.0),
        **dict.fromkeys(("deg/s", "degs-1", "degps", "degs", "deg/sec", "degpersec", "°/s", "°s-1", "dps"), _DEGREE),
        **dict.fromkeys(("degrees/s", "degree/s", "grad/s", "º/s", "°/sec", "deg.s-1"), _DEGREE),
        **dict.fromkeys(("mdps", "mdeg/s", "m°/s", "millidps"), 1e-3 * _DEGREE),
        **dict.fromkeys(("mrad/s", "mradps"), 1e-3),
        **dict.fromkeys(("rpm", "r/min"), 2.0 * np.pi / 60.0),
    },
    Quantity.FIELD: {
        **dict.fromkeys(("ut", "microtesla", "microt"), 1.0),
        **dict.fromkeys(("nt", "nanotesla"), 1e-3),
        **dict.fromkeys(("mt", "millitesla"), 1e3),
        **dict.fromkeys(("t", "tesla"), 1e6),
        **dict.fromkeys(("gauss", "g", "gs"), 100.0),
        **dict.fromkeys(("mgauss", "mg", "milligauss"), 0.1),
    },
    Quantity.PRESSURE: {"pa": 1.0, "hpa": 1e2, "mbar": 1e2, "mb": 1e2, "kpa": 1e3, "bar": 1e5},
    Quantity.ACCURACY: {"m": 1.0, "meter": 1.0, "meters": 1.0},
}
_DROPPED_FROM_UNITS = re.compile(r"[\s^*·()]|_")
_NO_UNITS = frozenset(
    {"", "-", "1", "none", "txt", "deg", "°", "degc", "°c", "c", "%", "lux", "lx", "cm", "bool", "n"}
)


def unit_factor(quantity: Quantity, unit: str) -> float | None:
    """Return the factor to SI units of a unit as it is written in a title; None for one that is not known."""
    return _UNITS.get(quantity, {}).get(plain_unit(unit))


def quantities_of_unit(unit: str) -> tuple[Quantity, ...]:
    """List the quantities that a unit can belong to, those with an acceleration first."""
    plain = plain_unit(unit)
    return tuple(quantity for quantity, known in _UNITS.items() if plain in known)


def is_unit(text: str) -> bool:
    """Tell whether a cell holds the name of a unit, or nothing."""
    return plain_unit(text) in _NO_UNITS or bool(quantities_of_unit(text))


def plain_unit(unit: str) -> str:
    """Write a unit without blanks, powers and case, with the micro sign as u."""
    text = unit.strip().replace("µ", "u").replace("μ", "u").replace("²", "2").replace("⁻¹", "-1").replace("⁻²", "-2")
    return _DROPPED_FROM_UNITS.sub("", text.casefold())
