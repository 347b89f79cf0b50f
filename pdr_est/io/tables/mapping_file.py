"""Read the YAML file in which a person states what the columns of a table mean (`--map`).

An example with everything that may stand in it::

    time: {column: "Zeit [ms]", unit: ms}      # or  time: {rate_hz: 50}
    accelerometer: {x: ax, y: -az, z: ay, unit: g, sign: down}
    gyroscope: {x: wx, y: -wz, z: wy, unit: deg/s}
    linear_acceleration: {x: lx, y: ly, z: lz, unit: m/s^2, sign: up}
    gravity: {x: gx, y: gy, z: gz, unit: m/s^2}
    magnetometer: {x: mx, y: my, z: mz, unit: uT}
    quaternion: {w: qw, x: qx, y: qy, z: qz}
    rotation_vector: {x: rx, y: ry, z: rz}
    pressure: {column: p, unit: hPa}
    location: {latitude: lat, longitude: lon, accuracy: acc}

A column may be given by its number, from 1. A minus in front of it turns the axis round. Without a unit or a sign the
values decide. A unit is a usual one or the number of SI units in one, such as 0.00980665 for mg. `sign: up` says that
the acceleration points up when the device lies still (Android), `down` that it points down (Apple).

Where the rows of a table are of several sensors, `sensor` names the column that tells which, and `rows` its name for
each. A sensor may have a `time` of its own::

    time: {column: t, unit: ms}
    sensor: {column: name}
    accelerometer: {rows: acc, x: v1, y: v2, z: v3}
    gyroscope: {rows: gyr, x: v1, y: v2, z: v3, unit: deg/s}

A folder with a file for each sensor has such sections for each file::

    files:
      acc.csv:
        time: {rate_hz: 50}
        accelerometer: {x: 1, y: 2, z: 3, unit: g}
      gyro.csv:
        time: {rate_hz: 50}
        gyroscope: {x: 1, y: 2, z: 3}
"""

import math
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from pdr_est.errors import ConfigError
from pdr_est.io.tables.mapping import ClockColumn, QuantityColumns, TableMapping
from pdr_est.io.tables.quantities import AXES, Quantity, unit_factor
from pdr_est.params.yaml_lines import load_yaml

SECTIONS: Mapping[str, Quantity] = {
    "accelerometer": Quantity.FORCE,
    "linear_acceleration": Quantity.LINEAR,
    "gravity": Quantity.GRAVITY,
    "gyroscope": Quantity.RATE,
    "magnetometer": Quantity.FIELD,
    "quaternion": Quantity.ATTITUDE,
    "rotation_vector": Quantity.ROTATION_VECTOR,
    "pressure": Quantity.PRESSURE,
}
"""Section of a mapping file -> quantity that it describes."""
SIGNS: Mapping[str, float] = {"up": 1.0, "down": -1.0}
"""Direction of the acceleration of a device that lies still -> factor to specific force."""
_SIGNED = (Quantity.FORCE, Quantity.LINEAR)
LOCATION = ("latitude", "longitude")
"""Keys of the section `location` for the columns of a position."""


def load_mapping(path: Path) -> TableMapping:
    """Read a mapping file.

    Raises
    ------
    ConfigError
        When it cannot be read, states a key twice, or has an unknown key, unit or sign; the message names them.
    """
    return mapping_from_dict(load_yaml(path), str(path))


def mapping_from_dict(document: Any, place: str = "mapping") -> TableMapping:
    """Make a mapping of a dictionary with the content of a mapping file.

    Parameters
    ----------
    document
        Section -> its settings, as in the example of this module.
    place
        Name of the file, for messages.

    Raises
    ------
    ConfigError
        For an unknown key, unit or sign, and without a time or a sensor.
    """
    if isinstance(document, dict) and "files" in document:
        return _mapping_of_files(document, place)
    mapping = _mapping_of_table(document, place)
    if not mapping.has_time or not mapping.has_motion:
        missing = "time" if not mapping.has_time else "accelerometer, linear_acceleration or gyroscope"
        raise ConfigError(f"{place}: no section {missing}; add it")
    return mapping


def _mapping_of_files(document: dict[Any, Any], place: str) -> TableMapping:
    """Make a mapping with a part for each file, or for each sensor in it."""
    files = _section(document, place, {"files"})["files"]
    if not isinstance(files, dict) or not files:
        raise ConfigError(f"{place}, files: names no file; write NAME: and the sections of each file below it")
    parts: list[TableMapping] = []
    for name, sections in files.items():
        mapping = _mapping_of_table(sections, f"{place}, {name}")
        if not mapping.has_time or not (mapping.columns or mapping.parts):
            raise ConfigError(f"{place}, {name}: no section {'time' if mapping.columns else 'of a sensor'}; add it")
        parts += [replace(part, file=str(name)) for part in mapping.parts or (mapping,)]
    if len({part.force_sign for part in parts if part.force_sign is not None}) > 1:
        raise ConfigError(f"{place}: the signs of its files contradict each other; a device has one sign")
    mapping = TableMapping(parts=tuple(parts), given=True)
    if not mapping.has_motion:
        raise ConfigError(f"{place}: no section accelerometer, linear_acceleration or gyroscope in any file; add it")
    return mapping


def _mapping_of_table(document: Any, place: str) -> TableMapping:
    """Make the mapping of one table, with a part for each sensor whose rows or time are its own."""
    sections = _section(document, place, {"time", "sensor", "location", *SECTIONS})
    clocks, rate_hz = _clock(sections.get("time"), f"{place}, time")
    names = _section(sections.get("sensor") or {}, f"{place}, sensor", {"column"})
    column = _title(names["column"], f"{place}, sensor") if names.get("column") is not None else ""
    sign = _sign(sections, place)
    base = TableMapping(clocks, {}, rate_hz, sign, f"the mapping {place}", given=True)
    shared: dict[Quantity, QuantityColumns] = {}
    parts = []
    for name, quantity in SECTIONS.items():
        if not sections.get(name):
            continue
        columns = _columns(sections[name], quantity, f"{place}, {name}")
        part = _own_part(base, sections[name], column, f"{place}, {name}")
        if part is base:
            shared[quantity] = columns
        else:
            parts.append(replace(part, columns={quantity: columns}))
    if sections.get("location"):
        shared |= _location(sections["location"], f"{place}, location")
    if not parts:
        return replace(base, columns=shared)
    return TableMapping(parts=(*((replace(base, columns=shared),) if shared else ()), *parts), given=True)


def _own_part(base: TableMapping, settings: Mapping[str, Any], column: str, place: str) -> TableMapping:
    """Return the mapping of a sensor with rows or a time of its own; the common one where it has none."""
    part = base
    if settings.get("time") is not None:
        clocks, rate_hz = _clock(settings["time"], f"{place}, time")
        part = replace(part, clocks=clocks, rate_hz=rate_hz)
    if settings.get("rows") is not None:
        if not column:
            raise ConfigError(f"{place}: rows without a column that names them; add sensor: {{column: NAME}}")
        part = replace(part, rows=(column, str(settings["rows"])))
    elif column:
        raise ConfigError(f"{place}: no rows; say which name its rows have in the column {column!r}")
    return part


def _section(document: Any, place: str, known: set[str]) -> dict[str, Any]:
    if not isinstance(document, dict):
        raise ConfigError(f"{place}: not a list of keys with values; write it as docs/recorder-formats.md shows")
    unknown = [str(key) for key in document if key not in known]
    if unknown:
        raise ConfigError(f"{place}: unknown key {unknown[0]!r}; known are {', '.join(sorted(known))}")
    return document


def _clock(document: Any, place: str) -> tuple[tuple[ClockColumn, ...], float | None]:
    settings = _section(document or {}, place, {"column", "unit", "fraction", "rate_hz"})
    rate_hz = settings.get("rate_hz")
    if rate_hz is not None:
        if isinstance(rate_hz, bool) or not isinstance(rate_hz, int | float) or not 0.0 < rate_hz < 1e5:
            raise ConfigError(f"{place}: rate_hz {rate_hz!r} is not a rate; give samples a second, such as 50")
        if settings.get("column") is not None:
            raise ConfigError(f"{place}: both column and rate_hz; give one of them")
        return (), float(rate_hz)
    if settings.get("column") is None:
        return (), None
    factor = _factor(Quantity.TIME, settings.get("unit"), place)
    fraction = _title(settings["fraction"], place) if settings.get("fraction") is not None else ""
    return (ClockColumn(_title(settings["column"], place), factor, fraction),), None


def _columns(settings: Any, quantity: Quantity, place: str) -> QuantityColumns:
    axes = tuple(axis or "column" for axis in AXES[quantity])
    others = {"unit", "rows", "time", *(("sign",) if quantity in _SIGNED else ())}
    values = _section(settings, place, {*axes, *others})
    missing = [axis for axis in axes if values.get(axis) is None]
    if missing:
        raise ConfigError(f"{place}: no {missing[0]}; name the column of each of {', '.join(axes)}")
    factor = _factor(quantity, values.get("unit"), place)
    turned, titles = zip(*(_signed_title(values[axis], place) for axis in axes), strict=True)
    if len(set(titles)) < len(titles):
        raise ConfigError(f"{place}: one column for two of {', '.join(axes)}; correct one of them")
    return QuantityColumns(titles, (factor,) * len(titles), turned=turned)


def _sign(sections: Mapping[str, Any], place: str) -> float | None:
    """Return the sign that the accelerations state, which is one property of the device; None where none does."""
    stated = {
        name: sections[name]["sign"]
        for name, quantity in SECTIONS.items()
        if quantity in _SIGNED and isinstance(sections.get(name), dict) and sections[name].get("sign") is not None
    }
    for name, sign in stated.items():
        if not isinstance(sign, str) or sign not in SIGNS:
            raise ConfigError(f"{place}, {name}: unknown sign {sign!r}; known are up and down")
    if len(set(stated.values())) > 1:
        said = " and ".join(f"sign {sign} of {name}" for name, sign in stated.items())
        raise ConfigError(f"{place}: {said} contradict each other; a device has one sign, so correct one of them")
    return next((SIGNS[sign] for sign in stated.values()), None)


def _location(settings: Any, place: str) -> dict[Quantity, QuantityColumns]:
    values = _section(settings, place, {*LOCATION, "accuracy"})
    missing = [name for name in LOCATION if values.get(name) is None]
    if missing:
        raise ConfigError(f"{place}: no {missing[0]}; name the columns of latitude and longitude")
    columns = {
        Quantity.LATITUDE_LONGITUDE: QuantityColumns(tuple(_title(values[n], place) for n in LOCATION), (None, None))
    }
    if values.get("accuracy") is not None:
        columns[Quantity.ACCURACY] = QuantityColumns((_title(values["accuracy"], place),), (1.0,))
    return columns


def _factor(quantity: Quantity, unit: Any, place: str) -> float | None:
    """Return the SI units in one unit that is given by its name or by this number; None without one."""
    if unit is None:
        return None
    if isinstance(unit, int | float) and not isinstance(unit, bool):
        if not 0.0 < unit < math.inf:
            raise ConfigError(f"{place}: unit {unit!r} is no number of SI units; give a positive one, or a name")
        return float(unit)
    factor = unit_factor(quantity, str(unit))
    if factor is None:
        raise ConfigError(
            f"{place}: unknown unit {unit!r} of the {quantity}; give a usual one, the number of SI units in one, or "
            "none to use the values"
        )
    return factor


def _title(column: Any, place: str) -> str:
    """Return the title of a column that is given by its title or number."""
    if isinstance(column, bool) or not isinstance(column, str | int | float):
        raise ConfigError(f"{place}: {column!r} is no column; give its title, in quotation marks, or its number")
    title = f"column {column}" if isinstance(column, int) else str(column).strip()
    if title in ("?", "-?", ""):
        raise ConfigError(f"{place}: {title!r} is left over from the draft; write the title of the column there")
    return title


def _signed_title(column: Any, place: str) -> tuple[float, str]:
    """Return -1 for a column with a minus in front of its title or number, else 1, and the title without it."""
    if isinstance(column, int) and not isinstance(column, bool):
        return (-1.0 if column < 0 else 1.0), _title(abs(column), place)
    title = _title(column, place)
    if not title.startswith("-"):
        return 1.0, title
    rest = title.removeprefix("-").strip()
    return -1.0, _title(int(rest) if rest.isdecimal() else rest, place)
