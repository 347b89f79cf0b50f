"""Find out what the columns of a plain table mean, by its header line.

The project's own header tells everything: quantity, axis and unit (`CANONICAL`). Besides, common titles of other
recorders are understood through one table of aliases, compared without case, blanks, underscores and punctuation. A
known unit in brackets at the end of a title is used, else the unit is detected from the values.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from pdr_est.frames import STANDARD_GRAVITY_MPS2


class Quantity(StrEnum):
    """Quantity that a group of columns holds."""

    TIME = "time"
    FORCE = "specific force"
    RATE = "rotation rate"
    FIELD = "magnetic field"
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

_STEMS: Mapping[Quantity, tuple[str, ...]] = {
    Quantity.FORCE: ("acc", "accel", "acceleration", "accelerometer", "accelerometeracceleration", "a"),
    Quantity.RATE: ("gyr", "gyro", "gyroscope", "rotationrate", "motionrotationrate", "gyrorotation"),
    Quantity.FIELD: ("mag", "magn", "magnetometer", "magneticfield", "motionmagneticfield"),
    Quantity.ATTITUDE: ("q", "quat", "quaternion", "motionquaternion"),
    Quantity.ROTATION_VECTOR: ("orient", "rotvec", "rotationvector"),
}
_AXES: Mapping[Quantity, tuple[str, ...]] = {
    quantity: ("w", "x", "y", "z") if quantity is Quantity.ATTITUDE else ("x", "y", "z") for quantity in _STEMS
}
_TITLES: Mapping[Quantity, tuple[tuple[str, ...], ...]] = {
    Quantity.TIME: tuple(
        (name,) for name in ("timestamp", "time", "t", "seconds", "secondselapsed", "datetime", "loggingtime")
    ),
    Quantity.PRESSURE: tuple((name,) for name in ("press", "pressure", "barometer", "altimeterpressure")),
    Quantity.LATITUDE_LONGITUDE: (
        ("latitude", "longitude"),
        ("lat", "lng"),
        ("lat", "lon"),
        ("locationlatitude", "locationlongitude"),
    ),
    Quantity.ACCURACY: tuple((name,) for name in ("horizontalaccuracy", "locationhorizontalaccuracy")),
}
_APPLE_STEM = "accelerometeracceleration"  # SensorLog: Core Motion's own signs

_UNITS: Mapping[Quantity, Mapping[str, float]] = {
    Quantity.TIME: {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9},
    Quantity.FORCE: {"m/s^2": 1.0, "m/s2": 1.0, "g": STANDARD_GRAVITY_MPS2},
    Quantity.RATE: {"rad/s": 1.0, "deg/s": np.pi / 180, "°/s": np.pi / 180, "dps": np.pi / 180},
    Quantity.FIELD: {"ut": 1.0},
    Quantity.PRESSURE: {"pa": 1.0, "hpa": 1e2, "mbar": 1e2, "kpa": 1e3},
    Quantity.ACCURACY: {"m": 1.0},
}
_TITLE = re.compile(r"^(?P<stem>.*?)\s*(?:[\[(](?P<unit>[^\])]*)[\])])?$")


@dataclass(frozen=True)
class QuantityColumns:
    """Columns of one quantity.

    Attributes
    ----------
    titles
        Titles as in the file, in the order of the axes.
    factor
        Factor to SI units where the header tells the unit, else None.
    canonical
        True for the documented header.
    apple
        True where the titles imply Core Motion's signs.
    """

    titles: tuple[str, ...]
    factor: float | None = None
    canonical: bool = False
    apple: bool = False


def parse_header(titles: Sequence[str]) -> Mapping[Quantity, QuantityColumns]:
    """Find the quantities that a header names with all of their axes.

    The documented titles have priority, then the aliases in order.
    """
    found: dict[Quantity, QuantityColumns] = {}
    by_name = {title.casefold(): title for title in titles}
    for quantity, names in CANONICAL.items():
        if all(name in by_name for name in names):
            found[quantity] = QuantityColumns(tuple(by_name[name] for name in names), 1.0, canonical=True)
    stems: dict[str, str] = {}
    for title in titles:
        stems.setdefault(_plain(_split(title)[0]), title)
    for quantity in Quantity:
        if quantity in found:
            continue
        for names in _spellings(quantity):
            if all(name in stems for name in names):
                chosen = tuple(stems[name] for name in names)
                apple = names[0].startswith(_APPLE_STEM)
                found[quantity] = QuantityColumns(chosen, _unit_factor(quantity, chosen), apple=apple)
                break
    return found


def _spellings(quantity: Quantity) -> Sequence[tuple[str, ...]]:
    """List the plain titles of the columns of a quantity, one tuple for each alias."""
    if quantity in _STEMS:
        return [tuple(member_stem + axis for axis in _AXES[quantity]) for member_stem in _STEMS[quantity]]
    return _TITLES.get(quantity, ())


def _split(title: str) -> tuple[str, str]:
    """Split a title from the unit in brackets at its end."""
    match = _TITLE.match(title.strip())
    return (match["stem"], match["unit"] or "") if match else (title, "")


def _plain(member_stem: str) -> str:
    return re.sub(r"[\W_]", "", member_stem.casefold())


def _unit_factor(quantity: Quantity, titles: Sequence[str]) -> float | None:
    """Find the factor to SI of the unit that all titles agree on; None when they do not tell a known one."""
    units = {_split(title)[1].casefold().replace("µ", "u").replace("μ", "u").replace("²", "^2") for title in titles}
    return _UNITS.get(quantity, {}).get(units.pop()) if len(units) == 1 else None
