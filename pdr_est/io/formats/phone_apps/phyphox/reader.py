"""Read phyphox exports: zip or folder of tables, or one table, from Android and iOS, in all five CSV variants.

Sensors are recognised by the column titles; the titles "X (m/s^2)" of iOS do not tell the sensor, there the name of
the file does. Both platforms write Android's units and signs (m/s^2 up at rest, rad/s, uT; pressure in hPa). Every
sensor has its own time stamps on one clock, "Time (s)".
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from pdr_est.errors import RecordingError
from pdr_est.io.conversion.gnss import GnssFixes, drop_fixes_outside, gnss_fixes
from pdr_est.io.conversion.raw_device import RawDevice, RawSensor, RawSignal
from pdr_est.io.formats.phone_apps.phyphox.metadata import (
    ExperimentClock,
    read_device_properties,
    read_experiment_clock,
)
from pdr_est.io.formats.phone_apps.phyphox.sensor_titles import (
    FIX_TITLES,
    TIME_TITLE,
    SensorColumns,
    find_sensors,
    sensors_of,
    unused_columns,
)
from pdr_est.io.tables.split.owners import names_owners
from pdr_est.io.text.container import Source
from pdr_est.io.text.finite_values import finite_signal_or_none
from pdr_est.io.text.members import find_members, member_stem, require_single_walk
from pdr_est.io.text.number_table import NumberTable, read_table
from pdr_est.io.text.table_layout import detect_header
from pdr_est.types.recording import DeviceRecording, Recording, Signal

NAME = "phyphox"

_PA_PER_HPA = 100.0

_Sensor = tuple[RawSensor, str, str, float]  # sensor, its name in the export and in messages, factor to SI units
_ACCELEROMETER: _Sensor = (RawSensor.FORCE, "acceleration", "the accelerometer", 1.0)
_WITHOUT_ACCELEROMETER: tuple[_Sensor, ...] = (
    (RawSensor.LINEAR, "linear acceleration", "linear acceleration", 1.0),
    (RawSensor.GRAVITY, "gravity", "gravity", 1.0),
)
_OTHER_SENSORS: tuple[_Sensor, ...] = (
    (RawSensor.RATE, "gyroscope", "gyroscope", 1.0),
    (RawSensor.FIELD, "magnetometer", "magnetometer", 1.0),
    (RawSensor.ATTITUDE, "orientation", "orientation", 1.0),
    (RawSensor.PRESSURE, "pressure", "pressure", _PA_PER_HPA),
)


@dataclass
class _Reading:
    """Export while it is read."""

    source: Source
    sensors: Mapping[str, SensorColumns]
    clock: ExperimentClock
    decisions: list[str] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)
    used: set[str] = field(default_factory=set)

    def table(self, sensor: str) -> NumberTable | None:
        """Read time and columns of a sensor; None when it is absent or has no rows."""
        if sensor not in self.sensors:
            return None
        self.used.add(sensor)
        where = self.sensors[sensor]
        head = self.source.head(where.member)
        dialect = detect_header(head)
        if dialect is None or b"\n" not in head.strip():
            self.warnings.append(f"{sensor}: {where.member} has no rows")
            return None
        return read_table(
            self.source.read(where.member),
            self.source.place(where.member),
            separator=dialect.separator,
            decimal_comma=dialect.decimal_comma,
            columns=(TIME_TITLE, *where.titles),
        )

    def signal(self, sensor: str) -> Signal | None:
        """Read the finite rows of a sensor, on the clock that runs through pauses."""
        table = self.table(sensor)
        if table is None:
            return None
        values = table.stack(self.sensors[sensor].titles)
        signal, dropped = finite_signal_or_none(table.numbers(TIME_TITLE), values, sensor, table.place)
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
    clock = read_experiment_clock(source, prefix)
    properties = read_device_properties(source, prefix)
    reading = _Reading(source, find_sensors(source, members), clock)
    reading.warnings += [f"{member} is empty" for member in members if not source.head(member).strip()]
    reading.warnings += clock.warnings
    device = _device(reading, properties)
    gnss = _fixes(reading, device)
    _name_unused(reading, members)
    return Recording(
        name=member_stem(source.name) if source.path.is_file() else source.name,
        format=NAME,
        devices=(replace(device, decisions=tuple(reading.decisions), warnings=tuple(reading.warnings)),),
        fixes=gnss.fixes,
        origin=gnss.origin,
        epoch_s=clock.epoch_s,
    )


def _name_unused(reading: _Reading, members: tuple[str, ...]) -> None:
    """Add the sensors, columns and files that were not used to the decisions."""
    used_members = {columns.member for columns in reading.sensors.values()}
    groups = (
        ("sensors", sorted(set(reading.sensors) - reading.used)),
        ("columns", unused_columns(reading.source, reading.sensors)),
        ("files", [m for m in members if m not in used_members and not member_stem(m).startswith("Metadata ")]),
    )
    reading.decisions += [f"{what} not used: {', '.join(names)}" for what, names in groups if names]


def _walks(source: Source) -> tuple[str, ...]:
    """Find the folders with at least one table of a known sensor ("" is the top)."""
    tables = find_members(source, _is_table)
    return tuple(dict.fromkeys(_folder(member) for member in tables if any(sensors_of(source, member))))


def _is_table(head: bytes) -> bool:
    """Look for the time column of this app, in a table that nobody has joined from several devices or persons."""
    dialect = detect_header(head) if TIME_TITLE.encode() in head[:64] else None
    return dialect is not None and not names_owners(dialect.titles)


def _folder(member: str) -> str:
    return member.rpartition("/")[0]


def _device(reading: _Reading, properties: Mapping[str, str]) -> DeviceRecording:
    """Convert the sensors of the device.

    Raises
    ------
    RecordingError
        When neither accelerometer nor gyroscope has rows.
    """
    device = RawDevice(
        {},
        model=" ".join(properties[key] for key in ("deviceBrand", "deviceModel") if properties.get(key)),
        platform=_platform(reading, properties),
        sign=1.0,
        sign_reason="phyphox writes Android's signs on every platform",
        without_gravity='record with "Acceleration with g" (the sensor Accelerometer) and the gyroscope',
        decisions=reading.decisions,
        warnings=reading.warnings,
    )
    if not _add(reading, device, (_ACCELEROMETER,)):
        _add(reading, device, _WITHOUT_ACCELEROMETER)
    _add(reading, device, _OTHER_SENSORS)
    if not device.signals.keys() & {RawSensor.FORCE, RawSensor.LINEAR, RawSensor.RATE}:
        found = ", ".join(sorted(reading.sensors))
        raise RecordingError(
            f"{reading.source.path}: neither accelerometer nor gyroscope has rows; found {found}; "
            "record again with both switched on"
        )
    if not device.signals.keys() & {RawSensor.FORCE, RawSensor.LINEAR}:
        reading.warnings.append("no accelerometer in the export")
    return device.convert()


def _add(reading: _Reading, device: RawDevice, sensors: Sequence[_Sensor]) -> bool:
    """Give the device those of some sensors that have rows; tell whether any has."""
    added = False
    for sensor, name, title, factor in sensors:
        signal = reading.signal(name)
        if signal is not None:
            device.signals[sensor] = RawSignal(signal, title, factor)
            added = True
    return added


def _fixes(reading: _Reading, device: DeviceRecording) -> GnssFixes:
    table = reading.table("location")
    if table is None:
        return GnssFixes((), None)
    latitude, longitude, accuracy = (table.numbers(title) for title in FIX_TITLES)
    time_s = reading.clock.to_continuous_time(table.numbers(TIME_TITLE))
    gnss = gnss_fixes(time_s, latitude, longitude, accuracy)
    signals = (device.specific_force, device.linear_acceleration, device.rotation_rate)
    motion = [signal.time_s for signal in signals if signal is not None]
    gnss = drop_fixes_outside(gnss, min(t.min() for t in motion), max(t.max() for t in motion))
    reading.warnings += gnss.warnings
    return gnss


def _platform(reading: _Reading, properties: Mapping[str, str]) -> str:
    """Find the platform by the brand in the metadata, else by the wording of the titles."""
    if properties:
        brand = f"{properties.get('deviceBrand', '')} {properties.get('deviceModel', '')}".casefold()
        return "ios" if any(name in brand for name in ("apple", "iphone", "ipad")) else "android"
    titles = {title for where in reading.sensors.values() for title in where.titles}
    return "ios" if titles & {"X (m/s^2)", "X (rad/s)", "X (µT)", "Gravity X (m/s^2)"} else ""
