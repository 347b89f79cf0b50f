"""Read phyphox exports: zip or folder of tables, or one table, from Android and iOS, in all five CSV variants.

Sensors are recognised by the column titles; the titles "X (m/s^2)" of iOS do not tell the sensor, there the name of
the file does. Both platforms write Android's units and signs (m/s^2 up at rest, rad/s, uT; pressure in hPa). Every
sensor has its own time stamps on one clock, "Time (s)".
"""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from pdr_est.errors import RecordingError
from pdr_est.io.conversion import signs, units
from pdr_est.io.conversion.axes import add_gravity
from pdr_est.io.conversion.gnss import GnssFixes, drop_fixes_outside, gnss_fixes
from pdr_est.io.formats.phone_apps.phyphox.metadata import (
    ExperimentClock,
    read_device_properties,
    read_experiment_clock,
)
from pdr_est.io.text.container import Source
from pdr_est.io.text.csv_dialect import detect_dialect
from pdr_est.io.text.finite_values import finite_signal_or_none
from pdr_est.io.text.members import find_members, member_stem, require_single_walk
from pdr_est.io.text.number_table import NumberTable, read_table
from pdr_est.types.recording import DeviceRecording, Recording, Signal

NAME = "phyphox"

_TIME = "Time (s)"
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
_FIX_TITLES = ("Latitude (°)", "Longitude (°)", "Horizontal Accuracy (m)")
_PRESSURE_TITLES = ("Pressure (hPa)", "X (hPa)")
_PA_PER_HPA = 100.0


@dataclass(frozen=True)
class _SensorColumns:
    """Member and titles, in the order of the axes, of the columns of a sensor."""

    member: str
    titles: tuple[str, ...]


@dataclass
class _Reading:
    """Export while it is read."""

    source: Source
    sensors: Mapping[str, _SensorColumns]
    clock: ExperimentClock
    decisions: list[str] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)

    def table(self, sensor: str) -> NumberTable | None:
        """Read time and columns of a sensor; None when it is absent or has no rows."""
        if sensor not in self.sensors:
            return None
        where = self.sensors[sensor]
        head = self.source.head(where.member)
        dialect = detect_dialect(head)
        if dialect is None or b"\n" not in head.strip():
            self.warnings.append(f"{sensor}: {where.member} has no rows")
            return None
        return read_table(
            self.source.read(where.member),
            self.source.place(where.member),
            separator=dialect.separator,
            decimal_comma=dialect.decimal_comma,
            columns=(_TIME, *where.titles),
        )

    def signal(self, sensor: str) -> Signal | None:
        """Read the finite rows of a sensor, on the clock that runs through pauses."""
        table = self.table(sensor)
        if table is None:
            return None
        values = table.stack(self.sensors[sensor].titles)
        signal, dropped = finite_signal_or_none(table.numbers(_TIME), values, sensor, table.place)
        self.warnings += dropped
        return None if signal is None else Signal(self.clock.to_continuous_time(signal.time_s), signal.values)


def sniff(source: Source) -> bool:
    """Tell whether the source has a table with phyphox's time column and a known sensor."""
    return bool(_walks(source))


def read_source(source: Source) -> Recording:
    """Read the walk of a phyphox export. Time zero is the start of the experiment.

    Raises
    ------
    RecordingError
        For several walks, and when neither accelerometer nor gyroscope has rows.
    """
    walk = require_single_walk(source, _walks(source), NAME)
    members = tuple(member for member in source.members if _folder(member) == walk)
    prefix = f"{walk}/" if walk else ""
    clock = read_experiment_clock(source, f"{prefix}meta/time.csv")
    properties = read_device_properties(source, f"{prefix}meta/device.csv")
    reading = _Reading(source, _find_sensors(source, members), clock)
    reading.warnings += [f"{member} is empty" for member in members if not source.head(member).strip()]
    reading.warnings += clock.warnings
    signals = _signals(reading)
    gnss = _fixes(reading, signals)
    return Recording(
        name=member_stem(source.name) if source.path.is_file() else source.name,
        format=NAME,
        devices=(_device(reading, signals, properties),),
        fixes=gnss.fixes,
        origin=gnss.origin,
        epoch_s=clock.epoch_s,
    )


def _walks(source: Source) -> tuple[str, ...]:
    """Find the folders with at least one table of a known sensor ("" is the top)."""
    tables = find_members(source, lambda head: _TIME.encode() in head[:64])
    return tuple(dict.fromkeys(_folder(member) for member in tables if any(_sensors_of(source, member))))


def _folder(member: str) -> str:
    return member.rpartition("/")[0]


def _find_sensors(source: Source, members: tuple[str, ...]) -> Mapping[str, _SensorColumns]:
    """Find the first table of each sensor."""
    found: dict[str, _SensorColumns] = {}
    for member in members:
        for sensor, titles in _sensors_of(source, member):
            found.setdefault(sensor, _SensorColumns(member, titles))
    return found


def _sensors_of(source: Source, member: str) -> Iterator[tuple[str, tuple[str, ...]]]:
    """List the sensors of a table with the titles of their columns."""
    dialect = detect_dialect(source.head(member))
    if dialect is None or _TIME not in dialect.titles:
        return
    yield from _three_axes(dialect.titles, member_stem(member).casefold())
    if set(_FIX_TITLES) <= set(dialect.titles):
        yield "location", _FIX_TITLES
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


def _signals(reading: _Reading) -> Mapping[str, Signal | None]:
    force = _specific_force(reading)
    signals = {
        "force": force,
        "rate": reading.signal("gyroscope"),
        "field": reading.signal("magnetometer"),
        "attitude": reading.signal("orientation"),
        "pressure": reading.signal("pressure"),
    }
    if force is None and signals["rate"] is None:
        found = ", ".join(sorted(reading.sensors))
        raise RecordingError(
            f"{reading.source.path}: neither accelerometer nor gyroscope has rows; found {found}; "
            "record again with both switched on"
        )
    if force is None:
        reading.warnings.append("no accelerometer in the export")
    return signals


def _specific_force(reading: _Reading) -> Signal | None:
    """Read the accelerometer, or linear acceleration plus gravity where that is absent."""
    force = reading.signal("acceleration")
    if force is not None:
        reading.decisions.append("specific force is the accelerometer")
        return force
    linear, gravity = reading.signal("linear acceleration"), reading.signal("gravity")
    if linear is None:
        return None
    if gravity is None:
        raise RecordingError(
            f"{reading.source.path}: linear acceleration, but no gravity; "
            "record again with the accelerometer switched on"
        )
    reading.decisions.append("specific force is linear acceleration + gravity, because there is no accelerometer")
    total, warnings = add_gravity(linear, gravity)
    reading.warnings += warnings
    if not len(total):
        reading.warnings.append("linear acceleration and gravity do not overlap in time: no specific force")
        return None
    return total


def _fixes(reading: _Reading, signals: Mapping[str, Signal | None]) -> GnssFixes:
    table = reading.table("location")
    if table is None:
        return GnssFixes((), None)
    latitude, longitude, accuracy = (table.numbers(title) for title in _FIX_TITLES)
    time_s = reading.clock.to_continuous_time(table.numbers(_TIME))
    gnss = gnss_fixes(time_s, latitude, longitude, accuracy)
    motion = [signal.time_s for name in ("force", "rate") if (signal := signals[name]) is not None]
    gnss = drop_fixes_outside(gnss, min(t.min() for t in motion), max(t.max() for t in motion))
    reading.warnings += gnss.warnings
    return gnss


def _device(
    reading: _Reading, signals: Mapping[str, Signal | None], properties: Mapping[str, str]
) -> DeviceRecording:
    force, attitude, pressure = signals["force"], signals["attitude"], signals["pressure"]
    conversions = []
    if force is not None:
        conversions.append(units.detect_acceleration_unit(force.values))
        if attitude is not None:
            attitude, conversion = signs.resolve_attitude_direction(force, attitude)
            conversions.append(conversion)
        sign = signs.detect_force_sign(force, attitude, 1.0, "phyphox writes Android's signs on every platform")
        conversions.append(sign)
        force = Signal(force.time_s, force.values * sign.factor)
    return DeviceRecording(
        model=" ".join(properties[key] for key in ("deviceBrand", "deviceModel") if properties.get(key)),
        platform=_platform(reading, properties),
        specific_force=force,
        rotation_rate=signals["rate"],
        magnetic_field=signals["field"],
        attitude=attitude,
        pressure=None if pressure is None else Signal(pressure.time_s, pressure.values * _PA_PER_HPA),
        decisions=(*reading.decisions, *(conversion.decision for conversion in conversions)),
        warnings=(*reading.warnings, *(warning for conversion in conversions for warning in conversion.warnings)),
    )


def _platform(reading: _Reading, properties: Mapping[str, str]) -> str:
    """Find the platform by the brand in the metadata, else by the wording of the titles."""
    if properties:
        brand = f"{properties.get('deviceBrand', '')} {properties.get('deviceModel', '')}".casefold()
        return "ios" if any(name in brand for name in ("apple", "iphone", "ipad")) else "android"
    titles = {title for where in reading.sensors.values() for title in where.titles}
    return "ios" if titles & {"X (m/s^2)", "X (rad/s)", "X (µT)", "Gravity X (m/s^2)"} else ""
