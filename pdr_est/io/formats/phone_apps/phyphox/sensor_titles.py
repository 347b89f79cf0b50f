"""Recognise the sensors of a phyphox table by the titles of its columns, else by the name of its file."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from pdr_est.io.text.container import Source
from pdr_est.io.text.members import member_stem
from pdr_est.io.text.table_layout import detect_header

TIME_TITLE = "Time (s)"
_AXIS_TITLE = re.compile(r"^(?P<what>.*?)\s*\b(?P<axis>[xyz]) \((?P<unit>[^)]*)\)$", re.IGNORECASE)
_SENSOR_BY_NAME = {
    "acceleration": "acceleration",
    "accelerometer": "acceleration",
    "linear acceleration": "linear acceleration",
    "linear accelerometer": "linear acceleration",
    "gravity": "gravity",
    "gyroscope": "gyroscope",
    "magnetic field": "magnetometer",
    "magnetometer": "magnetometer",
}
_UNIT_OF_SENSOR = {
    "acceleration": "m/s^2",
    "linear acceleration": "m/s^2",
    "gravity": "m/s^2",
    "gyroscope": "rad/s",
    "magnetometer": "uT",
}
_QUATERNION = ("w", "x", "y", "z")
FIX_TITLES = ("Latitude (°)", "Longitude (°)", "Horizontal Accuracy (m)")
_PRESSURE_TITLES = ("Pressure (hPa)", "X (hPa)")


@dataclass(frozen=True)
class SensorColumns:
    """Member and titles, in the order of the axes, of the columns of a sensor."""

    member: str
    titles: tuple[str, ...]


def find_sensors(source: Source, members: tuple[str, ...]) -> Mapping[str, SensorColumns]:
    """Find the first table of each sensor."""
    found: dict[str, SensorColumns] = {}
    for member in members:
        for sensor, titles in sensors_of(source, member):
            found.setdefault(sensor, SensorColumns(member, titles))
    return found


def sensors_of(source: Source, member: str) -> Iterator[tuple[str, tuple[str, ...]]]:
    """List the sensors of a table with the titles of their columns."""
    dialect = detect_header(source.head(member))
    if dialect is None or TIME_TITLE not in dialect.titles:
        return
    yield from _three_axes(dialect.titles, member_stem(member).casefold())
    if set(FIX_TITLES) <= set(dialect.titles):
        yield "location", FIX_TITLES
    if set(_QUATERNION) <= set(dialect.titles):
        yield "orientation", _QUATERNION
    for title in _PRESSURE_TITLES:
        if title in dialect.titles:
            yield "pressure", (title,)


def _three_axes(titles: tuple[str, ...], file_name: str) -> Iterator[tuple[str, tuple[str, ...]]]:
    axes: dict[str, dict[str, str]] = {}
    for title in titles:
        match = _AXIS_TITLE.match(title)
        if match is None:
            continue
        sensor = _SENSOR_BY_NAME.get(match["what"].casefold() or file_name)
        if sensor is not None and _plain_unit(match["unit"]) == _UNIT_OF_SENSOR[sensor]:
            axes.setdefault(sensor, {})[match["axis"].casefold()] = title
    for sensor, by_axis in axes.items():
        if len(by_axis) == 3:
            yield sensor, (by_axis["x"], by_axis["y"], by_axis["z"])


def _plain_unit(unit: str) -> str:
    """Replace both Unicode letters for micro, and the superscript, by ASCII."""
    return unit.replace("µ", "u").replace("μ", "u").replace("²", "^2")


def unused_columns(source: Source, sensors: Mapping[str, SensorColumns]) -> tuple[str, ...]:
    """List the columns of the tables of some sensors that belong to none of them."""
    known = {TIME_TITLE} | {title for columns in sensors.values() for title in columns.titles}
    unused: dict[str, None] = {}
    for member in dict.fromkeys(columns.member for columns in sensors.values()):
        dialect = detect_header(source.head(member))
        unused |= dict.fromkeys(title for title in (dialect.titles if dialect else ()) if title not in known)
    return tuple(unused)
