"""Read and draft the YAML file in which a person states what the columns of a table mean (`--map`).

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
values decide. `sign: up` says that the acceleration points up when the device lies still (Android), `down` that it
points down (Apple).
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml

from pdr_est.errors import ConfigError
from pdr_est.io.tables.mapping import ClockColumn, QuantityColumns, TableMapping
from pdr_est.io.tables.quantities import AXES, Quantity, unit_factor, usual_unit
from pdr_est.params.yaml_lines import load_yaml

_SECTIONS: Mapping[str, Quantity] = {
    "accelerometer": Quantity.FORCE,
    "linear_acceleration": Quantity.LINEAR,
    "gravity": Quantity.GRAVITY,
    "gyroscope": Quantity.RATE,
    "magnetometer": Quantity.FIELD,
    "quaternion": Quantity.ATTITUDE,
    "rotation_vector": Quantity.ROTATION_VECTOR,
    "pressure": Quantity.PRESSURE,
}
_SIGNS = {"up": 1.0, "down": -1.0}
_SIGNED = (Quantity.FORCE, Quantity.LINEAR)
_LOCATION = ("latitude", "longitude")


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
    sections = _section(document, place, {"time", "location", *_SECTIONS})
    clocks, rate_hz = _clock(
        _section(sections.get("time") or {}, f"{place}, time", {"column", "unit", "fraction", "rate_hz"}), place
    )
    columns: dict[Quantity, QuantityColumns] = {}
    for name, quantity in _SECTIONS.items():
        if sections.get(name):
            columns[quantity] = _columns(sections[name], quantity, f"{place}, {name}")
    sign = _sign(sections, place)
    if sections.get("location"):
        columns |= _location(sections["location"], f"{place}, location")
    mapping = TableMapping(clocks, columns, rate_hz, sign, f"the mapping {place}", given=True)
    if not mapping.has_time or not mapping.has_motion:
        missing = "time" if not mapping.has_time else "accelerometer, linear_acceleration or gyroscope"
        raise ConfigError(f"{place}: no section {missing}; add it")
    return mapping


def draft_mapping(mapping: TableMapping, titles: tuple[str, ...], sample: tuple[str, ...]) -> str:
    """Write a mapping file with what was understood of a table, to be completed.

    Parameters
    ----------
    mapping
        Meaning of the columns as far as it is known.
    titles, sample
        All titles and the cells of the first row.
    """
    lines = [
        "# Meaning of the columns, for --map; docs/recorder-formats.md describes the file.",
        "# Columns and first row:",
    ]
    lines += [
        f"#   {number}: {title} = {cell}" for number, (title, cell) in enumerate(zip(titles, sample, strict=False), 1)
    ]
    if mapping.clocks:
        clock = mapping.clocks[0]
        settings = {"column": clock.title} | ({"fraction": clock.fraction} if clock.fraction else {})
        lines.append(_line("time", settings | _stated_unit(Quantity.TIME, (clock.factor,))))
    else:
        lines.append("# time: {column: ?, unit: s}   # or {rate_hz: 50}")
    for name, quantity in _SECTIONS.items():
        if quantity in mapping.columns:
            lines.append(_line(name, _settings(mapping.columns[quantity], quantity)))
        elif quantity in (Quantity.FORCE, Quantity.RATE):
            lines.append(f"# {name}: {{x: ?, y: ?, z: ?, unit: {usual_unit(quantity, 1.0)}}}")
    places = mapping.columns.get(Quantity.LATITUDE_LONGITUDE)
    if places is not None:
        accuracy = mapping.columns.get(Quantity.ACCURACY)
        settings = dict(zip(_LOCATION, places.titles, strict=True))
        lines.append(_line("location", settings | ({} if accuracy is None else {"accuracy": accuracy.titles[0]})))
    if mapping.unused:
        lines.append(f"# not used: {', '.join(mapping.unused)}")
    return "\n".join(lines) + "\n"


def _section(document: Any, place: str, known: set[str]) -> dict[str, Any]:
    if not isinstance(document, dict):
        raise ConfigError(f"{place}: not a list of keys with values; write it as docs/recorder-formats.md shows")
    unknown = [str(key) for key in document if key not in known]
    if unknown:
        raise ConfigError(f"{place}: unknown key {unknown[0]!r}; known are {', '.join(sorted(known))}")
    return document


def _clock(settings: Mapping[str, Any], place: str) -> tuple[tuple[ClockColumn, ...], float | None]:
    rate_hz = settings.get("rate_hz")
    if rate_hz is not None:
        if isinstance(rate_hz, bool) or not isinstance(rate_hz, int | float) or not 0.0 < rate_hz < 1e5:
            raise ConfigError(f"{place}, time: rate_hz {rate_hz!r} is not a rate; give samples a second, such as 50")
        return (), float(rate_hz)
    if "column" not in settings:
        return (), None
    factor = _factor(Quantity.TIME, settings.get("unit"), f"{place}, time")
    fraction = _title(settings["fraction"]) if settings.get("fraction") is not None else ""
    return (ClockColumn(_title(settings["column"]), factor, fraction),), None


def _columns(settings: Any, quantity: Quantity, place: str) -> QuantityColumns:
    axes = tuple(axis or "column" for axis in AXES[quantity])
    values = _section(settings, place, {*axes, "unit", *(("sign",) if quantity in _SIGNED else ())})
    missing = [axis for axis in axes if values.get(axis) is None]
    if missing:
        raise ConfigError(f"{place}: no {missing[0]}; name the column of each of {', '.join(axes)}")
    factor = _factor(quantity, values.get("unit"), place)
    turned, titles = zip(*(_signed_title(values[axis]) for axis in axes), strict=True)
    return QuantityColumns(titles, (factor,) * len(titles), turned=turned)


def _sign(sections: Mapping[str, Any], place: str) -> float | None:
    """Return the sign that the accelerations state, which is one property of the device; None where none does."""
    stated = {
        name: sections[name]["sign"]
        for name, quantity in _SECTIONS.items()
        if quantity in _SIGNED and sections.get(name) and sections[name].get("sign") is not None
    }
    for name, sign in stated.items():
        if not isinstance(sign, str) or sign not in _SIGNS:
            raise ConfigError(f"{place}, {name}: unknown sign {sign!r}; known are up and down")
    if len(set(stated.values())) > 1:
        said = " and ".join(f"sign {sign} of {name}" for name, sign in stated.items())
        raise ConfigError(f"{place}: {said} contradict each other; a device has one sign, so correct one of them")
    return next((_SIGNS[sign] for sign in stated.values()), None)


def _location(settings: Any, place: str) -> dict[Quantity, QuantityColumns]:
    values = _section(settings, place, {*_LOCATION, "accuracy"})
    missing = [name for name in _LOCATION if values.get(name) is None]
    if missing:
        raise ConfigError(f"{place}: no {missing[0]}; name the columns of latitude and longitude")
    columns = {
        Quantity.LATITUDE_LONGITUDE: QuantityColumns(tuple(_title(values[n]) for n in _LOCATION), (None, None))
    }
    if values.get("accuracy") is not None:
        columns[Quantity.ACCURACY] = QuantityColumns((_title(values["accuracy"]),), (1.0,))
    return columns


def _factor(quantity: Quantity, unit: Any, place: str) -> float | None:
    if unit is None:
        return None
    factor = unit_factor(quantity, str(unit))
    if factor is None:
        raise ConfigError(
            f"{place}: unknown unit {unit!r} of the {quantity}; give a usual one, or none to use the values"
        )
    return factor


def _title(column: Any) -> str:
    """Return the title of a column that is given by its title or number."""
    return f"column {column}" if isinstance(column, int) and not isinstance(column, bool) else str(column).strip()


def _signed_title(column: Any) -> tuple[float, str]:
    """Return -1 for a column with a minus in front of its title or number, else 1, and the title without it."""
    if isinstance(column, int) and not isinstance(column, bool):
        return (-1.0 if column < 0 else 1.0), _title(abs(column))
    title = _title(column)
    if not title.startswith("-"):
        return 1.0, title
    rest = title.removeprefix("-").strip()
    return -1.0, _title(int(rest)) if rest.isdecimal() else rest


def _settings(columns: QuantityColumns, quantity: Quantity) -> dict[str, str]:
    axes = (axis or "column" for axis in AXES[quantity])
    return dict(zip(axes, columns.titles, strict=True)) | _stated_unit(quantity, columns.factors)


def _stated_unit(quantity: Quantity, factors: tuple[float | None, ...]) -> dict[str, str]:
    """Name the unit of columns whose titles state it; nothing where they do not agree."""
    if len(set(factors)) != 1 or factors[0] is None:
        return {}
    name = usual_unit(quantity, factors[0])
    return {} if name is None else {"unit": name}


def _line(section: str, settings: Mapping[str, str]) -> str:
    text: str = yaml.safe_dump(
        dict(settings), default_flow_style=True, sort_keys=False, allow_unicode=True, width=10**6
    )
    return f"{section}: {text.strip()}"
