"""Read phyphox exports: zip or folder of tables, or one table, from Android and iOS, in all five CSV variants.

Sensors are recognised by the column titles; the titles "X (m/s^2)" of iOS do not tell the sensor, there the name of
the file does. Both platforms write Android's units and signs (m/s^2 up at rest, rad/s, uT; pressure in hPa). Every
sensor has its own time stamps on one clock, "Time (s)".
"""

from collections.abc import Mapping
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
from pdr_est.io.formats.phone_apps.phyphox.sensor_titles import (
    FIX_TITLES,
    TIME_TITLE,
    SensorColumns,
    find_sensors,
    sensors_of,
    unused_columns,
)
from pdr_est.io.text.container import Source
from pdr_est.io.text.csv_dialect import detect_dialect
from pdr_est.io.text.finite_values import finite_signal_or_none
from pdr_est.io.text.members import find_members, member_stem, require_single_walk
from pdr_est.io.text.number_table import NumberTable, read_table
from pdr_est.types.recording import DeviceRecording, Recording, Signal

NAME = "phyphox"

_PA_PER_HPA = 100.0


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
        dialect = detect_dialect(head)
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
    signals = _signals(reading)
    gnss = _fixes(reading, signals)
    _name_unused(reading, members)
    return Recording(
        name=member_stem(source.name) if source.path.is_file() else source.name,
        format=NAME,
        devices=(_device(reading, signals, properties),),
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
    tables = find_members(source, lambda head: TIME_TITLE.encode() in head[:64])
    return tuple(dict.fromkeys(_folder(member) for member in tables if any(sensors_of(source, member))))


def _folder(member: str) -> str:
    return member.rpartition("/")[0]


def _signals(reading: _Reading) -> Mapping[str, Signal | None]:
    force = _specific_force(reading)
    signals = {
        "force": force,
        "linear": _without_gravity(reading) if force is None else None,
        "rate": reading.signal("gyroscope"),
        "field": reading.signal("magnetometer"),
        "attitude": reading.signal("orientation"),
        "pressure": reading.signal("pressure"),
    }
    if force is None and signals["linear"] is None and signals["rate"] is None:
        found = ", ".join(sorted(reading.sensors))
        raise RecordingError(
            f"{reading.source.path}: neither accelerometer nor gyroscope has rows; found {found}; "
            "record again with both switched on"
        )
    if force is None and signals["linear"] is None:
        reading.warnings.append("no accelerometer in the export")
    return signals


def _specific_force(reading: _Reading) -> Signal | None:
    """Read the accelerometer, or linear acceleration plus gravity where that is absent."""
    force = reading.signal("acceleration")
    if force is not None:
        reading.decisions.append("specific force is the accelerometer")
        return force
    linear, gravity = reading.signal("linear acceleration"), reading.signal("gravity")
    if linear is None or gravity is None:
        return None
    reading.decisions.append("specific force is linear acceleration + gravity, because there is no accelerometer")
    total, warnings = add_gravity(linear, gravity)
    reading.warnings += warnings
    if not len(total):
        reading.warnings.append("linear acceleration and gravity do not overlap in time: no specific force")
        return None
    return total


def _without_gravity(reading: _Reading) -> Signal | None:
    """Read the linear acceleration, from which steps can be counted."""
    linear = reading.signal("linear acceleration")
    if linear is not None:
        reading.decisions.append("acceleration without gravity is the linear acceleration")
        reading.warnings.append(
            "the acceleration is without gravity: steps can be counted from it; for a track record with "
            '"Acceleration with g" (the sensor Accelerometer) and the gyroscope'
        )
    return linear


def _fixes(reading: _Reading, signals: Mapping[str, Signal | None]) -> GnssFixes:
    table = reading.table("location")
    if table is None:
        return GnssFixes((), None)
    latitude, longitude, accuracy = (table.numbers(title) for title in FIX_TITLES)
    time_s = reading.clock.to_continuous_time(table.numbers(TIME_TITLE))
    gnss = gnss_fixes(time_s, latitude, longitude, accuracy)
    motion = [signal.time_s for name in ("force", "linear", "rate") if (signal := signals[name]) is not None]
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
        linear_acceleration=signals["linear"],
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
