"""Read exports of Sensor Logger: folder, zip or JSON, from Android and iOS, of 2021 and today.

`Accelerometer` is the acceleration without gravity, m/s^2. On Android gravity points up at rest; iOS negates
acceleration and gravity unless `standardisation` was switched on, and gives uncalibrated acceleration in g. Columns
come in any order and are read by name.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from pdr_est.errors import RecordingError
from pdr_est.frames import STANDARD_GRAVITY_MPS2, up_in_device
from pdr_est.io.conversion import signs, units
from pdr_est.io.conversion.axes import add_gravity, turned_to_east
from pdr_est.io.conversion.gnss import GnssFixes, drop_fixes_outside, gnss_fixes
from pdr_est.io.formats.phone_apps.sensor_logger.clock import align_fix_times, seconds_since
from pdr_est.io.formats.phone_apps.sensor_logger.export import (
    Export,
    FolderExport,
    JsonExport,
    looks_like_json,
    looks_like_sensor,
)
from pdr_est.io.text.container import Source, SourceKind
from pdr_est.io.text.finite_values import finite_signal_or_none
from pdr_est.io.text.members import find_members, require_single_walk
from pdr_est.types.recording import DeviceRecording, Recording, Signal
from pdr_est.types.sensors import AttitudeReference

NAME = "Sensor Logger"

_LATEST_NS = 2**63 - 1
_AXES = ("x", "y", "z")
_QUATERNION = ("qw", "qx", "qy", "qz")
_FIX = ("latitude", "longitude", "horizontalAccuracy")
_METADATA = ("platform", "device name", "recording time", "recording epoch time", "standardisation", "appVersion")
_FORCE_SENSORS = ("TotalAcceleration", "Accelerometer", "AccelerometerUncalibrated")
_CLOCK_SENSORS = (*_FORCE_SENSORS, "Gyroscope", "GyroscopeUncalibrated")


@dataclass
class _Reading:
    """Export while it is read, with the decisions and warnings so far."""

    export: Export
    metadata: Mapping[str, str]
    zero_ns: int
    decisions: list[str] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)

    def signal(self, sensor: str, columns: tuple[str, ...] = _AXES) -> Signal | None:
        """Read the finite rows of a sensor; None when it has none."""
        table = self.export.table(sensor, columns)
        if table is None:
            return None
        time_s = seconds_since(table, self.zero_ns)
        signal, dropped = finite_signal_or_none(time_s, table.stack(columns), sensor, table.place)
        self.warnings.extend(dropped)
        return signal

    def add_gravity(self, linear: Signal, gravity: Signal) -> Signal:
        """Add gravity to an acceleration and keep the warnings."""
        total, warnings = add_gravity(linear, gravity)
        self.warnings.extend(warnings)
        return total

    def note(self, conversion: units.Conversion) -> float:
        """Keep the decision and the warning of a conversion; return its factor."""
        self.decisions.append(conversion.decision)
        self.warnings.extend(conversion.warnings)
        return conversion.factor


def sniff(source: Source) -> bool:
    """Tell whether the source has a JSON export or the CSV file of a three-axis sensor."""
    return bool(_walks(source))


def read_source(source: Source) -> Recording:
    """Read the walk of an export. Time zero is the first sample of accelerometer or gyroscope.

    Raises
    ------
    RecordingError
        For several walks, the file of a single sensor, no motion sensor at all, or an accelerometer without rows that
        no other sensor replaces.
    """
    export = _open(source)
    reading = _Reading(export, _metadata(export), _zero_ns(export))
    reading.warnings += [f"{sensor} is in the export but has no rows" for sensor in export.empty]
    device = _device(reading)
    gnss, epoch_s = _fixes(reading, _end_s(device))
    return Recording(
        name=source.path.name.split(".", 1)[0],
        format=NAME,
        devices=(replace(device, decisions=tuple(reading.decisions), warnings=tuple(reading.warnings)),),
        fixes=gnss.fixes,
        origin=gnss.origin,
        epoch_s=epoch_s,
        notes=_notes(reading),
    )


def _walks(source: Source) -> tuple[str, ...]:
    """List JSON members, and folders with at least one CSV file of a sensor."""
    documents = find_members(source, looks_like_json)
    tables = find_members(source, looks_like_sensor)
    return (*documents, *dict.fromkeys(member.rpartition("/")[0] for member in tables))


def _open(source: Source) -> Export:
    walk = require_single_walk(source, _walks(source), NAME)
    if walk in source.members:
        return JsonExport.parse(source.read(walk), source.place(walk))
    if source.kind is SourceKind.FILE:
        raise RecordingError(
            f"{source.path}: this is one sensor of a {NAME} export; give the folder or zip of the export"
        )
    return FolderExport.from_folder(source, walk)


def _metadata(export: Export) -> Mapping[str, str]:
    """Read the first row of the metadata by column name; empty when there is none."""
    table = export.table("Metadata", (), _METADATA)
    if table is None:
        return {}
    return {name: str(table.texts(name)[0]) for name in _METADATA if name in table}


def _zero_ns(export: Export) -> int:
    """Find the Unix time, ns, of the first motion sample."""
    tables = (export.table(sensor, ()) for sensor in _CLOCK_SENSORS)
    starts = [table.columns["time"][0] for table in tables if table is not None and "time" in table]
    if not starts:
        present = ", ".join(sorted(export.sensors))
        raise RecordingError(
            f"{export.place}: neither accelerometer nor gyroscope has rows; found {present}; "
            "record again with both switched on"
        )
    if not all(0 <= start < _LATEST_NS for start in starts):  # NaN is not either
        raise RecordingError(f"{export.place}: the first row of a motion sensor has no Unix time; remove that row")
    return int(min(starts))


def _device(reading: _Reading) -> DeviceRecording:
    attitude = reading.signal("Orientation", _QUATERNION)
    sign, reason = _expected_sign(reading.metadata)
    raw = _force_with_gravity(reading, attitude, sign)
    if raw is not None and not len(raw):
        reading.warnings.append("accelerometer and gravity do not overlap in time: no specific force")
        raw = None
    if raw is not None and attitude is not None:
        attitude, conversion = signs.resolve_attitude_direction(raw, attitude)
        reading.note(conversion)
    attitude, reference = _to_east(reading, attitude)
    return DeviceRecording(
        model=reading.metadata.get("device name", ""),
        platform=reading.metadata.get("platform", "").lower(),
        specific_force=None if raw is None else _upwards(reading, raw, attitude, sign, reason),
        rotation_rate=_calibrated_or_raw(reading, "Gyroscope"),
        magnetic_field=_calibrated_or_raw(reading, "Magnetometer"),
        attitude=attitude,
        attitude_reference=reference,
        pressure=_pressure(reading),
    )


def _to_east(reading: _Reading, attitude: Signal | None) -> tuple[Signal | None, AttitudeReference]:
    """Turn the attitude to x east, and tell what its yaw counts from, as the app's reference of coordinates states.

    Exports of 2021 name no version of the app, and that reference is newer than they are.
    """
    platform = reading.metadata.get("platform", "").lower()
    if attitude is None or not reading.metadata.get("appVersion") or platform not in ("android", "ios"):
        return attitude, AttitudeReference.UNKNOWN
    if platform == "android":
        return attitude, AttitudeReference.MAGNETIC_NORTH
    if reading.metadata.get("standardisation", "").lower() != "true":
        reading.decisions.append("attitude: turned by a quarter, because its x axis points north on iOS")
        attitude = Signal(attitude.time_s, turned_to_east(attitude.values))
    return attitude, AttitudeReference.TRUE_NORTH


def _expected_sign(metadata: Mapping[str, str]) -> tuple[float | None, str]:
    """Find the sign of the acceleration that the metadata imply, and why."""
    platform = metadata.get("platform", "").lower()
    if platform == "android":
        return 1.0, "the metadata name Android"
    if platform == "ios":
        standardised = metadata.get("standardisation", "").lower() == "true"
        return (1.0, "iOS with standardisation") if standardised else (-1.0, "iOS without standardisation")
    return None, "the metadata name no platform"


def _force_with_gravity(reading: _Reading, attitude: Signal | None, sign: float | None) -> Signal | None:
    """Read the acceleration with gravity, m/s^2, still with the recorder's sign."""
    total = reading.signal("TotalAcceleration")
    if total is not None:
        reading.decisions.append("specific force is TotalAcceleration")
        return total
    user = reading.signal("Accelerometer")
    gravity = None if user is None else reading.signal("Gravity")
    if user is not None and gravity is not None:
        reading.decisions.append("specific force is Accelerometer + Gravity")
        return reading.add_gravity(user, gravity)
    raw = reading.signal("AccelerometerUncalibrated")
    if raw is not None:
        reading.decisions.append(
            "specific force is AccelerometerUncalibrated, because there is no accelerometer with gravity"
        )
        return Signal(raw.time_s, raw.values * reading.note(units.detect_acceleration_unit(raw.values)))
    if user is not None and attitude is not None:
        reading.decisions.append(
            "specific force is Accelerometer + gravity along the attitude, because there is no Gravity"
        )
        up = up_in_device(attitude.values) * (STANDARD_GRAVITY_MPS2 * (1.0 if sign is None else sign))
        return reading.add_gravity(user, Signal(attitude.time_s, up))
    _explain_missing_force(reading, user is not None)
    return None


def _explain_missing_force(reading: _Reading, without_gravity: bool) -> None:
    place = reading.export.place
    if without_gravity:
        raise RecordingError(
            f"{place}: Accelerometer is without gravity, and Gravity, TotalAcceleration, AccelerometerUncalibrated "
            "and Orientation are absent; record again with one of them"
        )
    empty = [sensor for sensor in _FORCE_SENSORS if sensor in reading.export.empty]
    if empty:
        raise RecordingError(
            f"{place}: {empty[0]} has no rows and no other sensor replaces it; export the recording again"
        )
    reading.warnings.append("no accelerometer in the export")


def _upwards(reading: _Reading, raw: Signal, attitude: Signal | None, sign: float | None, reason: str) -> Signal:
    """Give the acceleration the sign that points up at rest."""
    factor = reading.note(signs.detect_force_sign(raw, attitude, sign, reason))
    check = units.detect_acceleration_unit(raw.values)
    reading.note(check)
    return Signal(raw.time_s, raw.values * factor)


def _calibrated_or_raw(reading: _Reading, sensor: str) -> Signal | None:
    """Read a sensor, or its uncalibrated version (same unit and signs) when there is only that."""
    signal = reading.signal(sensor)
    if signal is None:
        signal = reading.signal(f"{sensor}Uncalibrated")
        if signal is not None:
            reading.decisions.append(f"{sensor} is absent, {sensor}Uncalibrated is used")
    return signal


def _pressure(reading: _Reading) -> Signal | None:
    signal = reading.signal("Barometer", ("pressure",))
    if signal is None:
        return None
    return Signal(signal.time_s, signal.values * reading.note(units.detect_pressure_unit(signal.values)))


def _end_s(device: DeviceRecording) -> float:
    return max((float(block.time_s.max()) for block in device.blocks()), default=0.0)


def _fixes(reading: _Reading, end_s: float) -> tuple[GnssFixes, float]:
    """Make the fixes on the recording's clock, and find the Unix time of its zero."""
    location = reading.export.table("Location", _FIX)
    if location is None:
        return GnssFixes((), None), reading.zero_ns / 1e9
    clock = align_fix_times(location, reading.zero_ns, end_s, reading.metadata)
    latitude, longitude, accuracy = (location.numbers(name) for name in _FIX)
    gnss = drop_fixes_outside(gnss_fixes(clock.time_s, latitude, longitude, accuracy), 0.0, end_s)
    reading.warnings += [*((clock.warning,) if clock.warning else ()), *gnss.warnings]
    return gnss, clock.epoch_s


def _notes(reading: _Reading) -> tuple[str, ...]:
    """Note the count of the pedometer, and annotations."""
    notes = []
    pedometer = reading.export.table("Pedometer", ("steps",))
    if pedometer is not None:
        notes.append(f"the phone's pedometer counted {pedometer.numbers('steps')[-1]:.0f} steps")
    annotations = reading.export.table("Annotation", (), ("text",))
    if annotations is not None:
        times_s = seconds_since(annotations, reading.zero_ns)
        notes += [f"{t:.2f} s: {text}" for t, text in zip(times_s, annotations.texts("text"), strict=True)]
    return tuple(notes)
