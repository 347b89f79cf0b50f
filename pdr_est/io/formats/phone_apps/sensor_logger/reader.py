"""Read exports of Sensor Logger: folder, zip, JSON, SQLite, combined or single CSV, from Android and iOS.

`Accelerometer` is the acceleration without gravity, m/s^2. On Android gravity points up at rest; iOS negates
acceleration and gravity unless `standardisation` was switched on, and gives uncalibrated acceleration in g. Columns
come in any order and are read by name. Where the phone recorded no motion, the watch is the device.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from pdr_est.errors import RecordingError
from pdr_est.frames import Array
from pdr_est.io.conversion.axes import turned_to_east
from pdr_est.io.conversion.gnss import GnssFixes, drop_fixes_outside, gnss_fixes
from pdr_est.io.conversion.gravity_content import has_gravity
from pdr_est.io.conversion.raw_device import RawDevice, RawSensor, RawSignal
from pdr_est.io.conversion.stale_samples import count_stale_samples
from pdr_est.io.formats.phone_apps.sensor_logger.acceleration import (
    WITHOUT_GRAVITY,
    add_acceleration,
    expected_sign,
)
from pdr_est.io.formats.phone_apps.sensor_logger.annotations import typed_positions
from pdr_est.io.formats.phone_apps.sensor_logger.clock import align_fix_times, seconds_since
from pdr_est.io.formats.phone_apps.sensor_logger.combined_export import CombinedExport, looks_combined
from pdr_est.io.formats.phone_apps.sensor_logger.database_export import DatabaseExport, looks_like_database
from pdr_est.io.formats.phone_apps.sensor_logger.export import (
    Export,
    FolderExport,
    JsonExport,
    looks_like_json,
    looks_like_sensor,
)
from pdr_est.io.formats.phone_apps.sensor_logger.reading import ExportReading
from pdr_est.io.formats.phone_apps.sensor_logger.sensor_names import KNOWN_SENSORS, MOTION_SENSORS, WATCH_SENSORS
from pdr_est.io.formats.phone_apps.sensor_logger.watch import WATCH_MOTION_SENSORS, read_watch
from pdr_est.io.tables.quantities import Quantity
from pdr_est.io.tables.signals import HEAD_BYTES
from pdr_est.io.tables.titles import sensor_by_name
from pdr_est.io.text.container import Source
from pdr_est.io.text.members import find_members, member_stem, require_single_walk
from pdr_est.io.text.number_table import NumberTable
from pdr_est.types.recording import DeviceRecording, Recording, Signal
from pdr_est.types.sensors import AttitudeReference

NAME = "Sensor Logger"

_LATEST_NS = 2**63 - 1
_QUATERNION = ("qw", "qx", "qy", "qz")
_ELAPSED = "seconds_elapsed"
_FIX = ("latitude", "longitude", "horizontalAccuracy")
_METADATA_TABLE = "Metadata"
_METADATA = ("platform", "device name", "recording time", "recording epoch time", "standardisation", "appVersion")
_PHONE_SENSORS = (
    "TotalAcceleration",
    "Accelerometer",
    "AccelerometerUncalibrated",
    "Gyroscope",
    "GyroscopeUncalibrated",
)
_SENSORS: Mapping[Quantity | None, str] = {
    Quantity.FORCE: "Accelerometer",  # which may be with or without gravity: the values tell
    Quantity.LINEAR: "Accelerometer",
    Quantity.GRAVITY: "Gravity",
    Quantity.RATE: "Gyroscope",
    Quantity.FIELD: "Magnetometer",
}
_LOCATION_SENSORS = ("Location", "LocationGps", "WatchLocation", "LocationNetwork")


def sniff(source: Source) -> bool:
    """Tell whether the source has an export of any layout."""
    return bool(_walks(source))


def read_source(source: Source) -> Recording:
    """Read the walk of an export. Time zero is the first sample of accelerometer or gyroscope.

    Raises
    ------
    RecordingError
        For several walks, for no motion sensor at all, or an accelerometer without rows that no other sensor
        replaces.
    """
    export = _open(source)
    sensors, zero_ns = _motion_sensors(export)
    reading = ExportReading(export, _metadata(export), zero_ns, used={_METADATA_TABLE: set(_METADATA)})
    reading.warnings += [f"{sensor} is in the export but has no rows" for sensor in export.empty]
    device = read_watch(reading) if sensors is WATCH_MOTION_SENSORS else _device(reading)
    if device.span_s is None:
        raise RecordingError(f"{export.place}: no motion sensor has a finite row; export the recording again")
    gnss, epoch_s = _fixes(reading, _end_s(device))
    notes = _notes(reading)
    reading.name_unused()
    return Recording(
        name=source.path.name.split(".", 1)[0],
        format=NAME,
        devices=(replace(device, decisions=tuple(reading.decisions), warnings=tuple(reading.warnings)),),
        fixes=gnss.fixes,
        origin=gnss.origin,
        epoch_s=epoch_s,
        notes=notes,
        waypoints=typed_positions(*_annotations(reading)),
    )


def _walks(source: Source) -> tuple[str, ...]:
    """List JSON, SQLite and combined members, and folders with at least one CSV file of a sensor."""
    whole = find_members(source, lambda h: looks_like_json(h) or looks_like_database(h) or looks_combined(h))
    tables = [one for one in source.members if looks_like_sensor(source.head(one, HEAD_BYTES), member_stem(one))]
    return (*whole, *dict.fromkeys(member.rpartition("/")[0] for member in tables))


def _open(source: Source) -> Export:
    walk = require_single_walk(source, _walks(source), NAME)
    if walk not in source.members:
        return _with_known_names(FolderExport.from_folder(source, walk))
    head = source.head(walk)
    if looks_like_database(head):
        return DatabaseExport(source.place(walk), source.read(walk))
    if looks_like_json(head):
        return JsonExport.parse(source.read(walk), source.place(walk))
    return CombinedExport.open(source, walk)


def _with_known_names(export: FolderExport) -> FolderExport:
    """Give files that were renamed the names of the sensors that they tell in other words.

    A single table of x, y and z whose name tells no sensor is TotalAcceleration if its values are gravity's.
    """
    known = dict(export.members)
    for name, member in export.members.items():
        sensor = _SENSORS.get(sensor_by_name(name))
        if name in KNOWN_SENSORS or sensor is None or sensor in known:
            continue
        if {"x", "y", "z"} <= set(export.titles(name)):
            known[sensor] = known.pop(name, member)
    export = replace(export, members=known)
    if set(export.sensors) & {*MOTION_SENSORS, *WATCH_SENSORS}:
        return export
    if len(export.sensors) == 1:
        table = export.table(export.sensors[0], ("x", "y", "z"))
        if table is not None and has_gravity(table.stack(("x", "y", "z"))):
            return replace(export, members={"TotalAcceleration": next(iter(export.members.values()))})
    named = ", ".join(export.sensors[:3])
    raise RecordingError(
        f"{export.place}: {named}: the name of the file does not tell the sensor; rename it as the app does, such as "
        "TotalAcceleration.csv or Gyroscope.csv"
    )


def _metadata(export: Export) -> Mapping[str, str]:
    """Read the first row of the metadata by column name; empty when there is none."""
    table = export.table(_METADATA_TABLE, (), _METADATA)
    if table is None:
        return {}
    return {name: str(table.texts(name)[0]) for name in _METADATA if name in table}


def _motion_sensors(export: Export) -> tuple[tuple[str, ...], int]:
    """Find the sensors of the device, the phone's if it has any, and the Unix time, ns, of their first sample."""
    for sensors in (_PHONE_SENSORS, WATCH_MOTION_SENSORS):
        tables = (export.table(sensor, ()) for sensor in sensors)
        starts = [_first_ns(table) for table in tables if table is not None and "time" in table]
        if not starts:
            continue
        if not all(0 <= start < _LATEST_NS for start in starts):  # NaN is not either
            raise RecordingError(
                f"{export.place}: the first row of a motion sensor has no Unix time; remove that row"
            )
        return sensors, int(min(starts))
    present = ", ".join(sorted(export.sensors))
    raise RecordingError(
        f"{export.place}: neither accelerometer nor gyroscope has rows; found {present}; "
        "record again with both switched on"
    )


def _first_ns(table: NumberTable) -> int | float:
    """Return the first time that belongs to the recording."""
    ticks = table.columns["time"]
    stale = count_stale_samples((ticks - ticks[0]).astype(np.float64) / 1e9)
    first: int | float = ticks[stale]
    return first


def _device(reading: ExportReading) -> DeviceRecording:
    sign, reason = expected_sign(reading.metadata)
    device = RawDevice(
        {},
        model=reading.metadata.get("device name", ""),
        platform=reading.metadata.get("platform", "").lower(),
        sign=sign,
        sign_reason=reason,
        without_gravity=WITHOUT_GRAVITY,
        decisions=reading.decisions,
        warnings=reading.warnings,
    )
    add_acceleration(reading, device)
    reading.add(device, RawSensor.ATTITUDE, "Orientation", _QUATERNION)
    reading.add(device, RawSensor.PRESSURE, "Barometer", ("pressure",))
    for sensor, name in ((RawSensor.RATE, "Gyroscope"), (RawSensor.FIELD, "Magnetometer")):
        signal = _calibrated_or_raw(reading, name)
        if signal is not None:
            device.signals[sensor] = RawSignal(signal, name, 1.0)
    converted = device.convert()
    attitude, reference = _to_east(reading, converted.attitude)
    return replace(converted, attitude=attitude, attitude_reference=reference)


def _to_east(reading: ExportReading, attitude: Signal | None) -> tuple[Signal | None, AttitudeReference]:
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


def _calibrated_or_raw(reading: ExportReading, sensor: str) -> Signal | None:
    """Read a sensor, or its uncalibrated version (same unit and signs) when there is only that."""
    signal = reading.signal(sensor)
    if signal is None:
        signal = reading.signal(f"{sensor}Uncalibrated")
        if signal is not None:
            reading.decisions.append(f"{sensor} is absent, {sensor}Uncalibrated is used")
    return signal


def _end_s(device: DeviceRecording) -> float:
    return 0.0 if device.span_s is None else device.span_s[1]


def _fixes(reading: ExportReading, end_s: float) -> tuple[GnssFixes, float]:
    """Make the fixes on the recording's clock, and find the Unix time of its zero."""
    tables = ((sensor, reading.export.table(sensor, (*_FIX, _ELAPSED))) for sensor in _LOCATION_SENSORS)
    found = next(((s, table) for s, table in tables if table is not None and all(n in table for n in _FIX)), None)
    if found is None:
        return GnssFixes((), None), reading.zero_ns / 1e9
    sensor, location = found
    reading.used[sensor] = set(_FIX)
    if sensor != _LOCATION_SENSORS[0]:
        reading.decisions.append(f"fixes are {sensor}, because there is no Location")
    clock = align_fix_times(location, reading.zero_ns, end_s, reading.metadata)
    latitude, longitude, accuracy = (location.numbers(name) for name in _FIX)
    gnss = drop_fixes_outside(gnss_fixes(clock.time_s, latitude, longitude, accuracy), 0.0, end_s)
    reading.warnings += [*((clock.warning,) if clock.warning else ()), *gnss.warnings]
    return gnss, clock.epoch_s


def _notes(reading: ExportReading) -> tuple[str, ...]:
    """Note the count of the pedometer, and annotations."""
    notes = []
    pedometer = reading.table("Pedometer", ("steps",))
    if pedometer is not None:
        notes.append(f"the phone's pedometer counted {pedometer.numbers('steps')[-1]:.0f} steps")
    notes += [f"{t:.2f} s: {text}" for t, text in zip(*_annotations(reading), strict=True)]
    return tuple(notes)


def _annotations(reading: ExportReading) -> tuple[Array, Sequence[str]]:
    """Return times (n,), s, and texts of the annotations."""
    table = reading.table("Annotation", (), ("text",))
    if table is None:
        return np.zeros(0), ()
    return seconds_since(table, reading.zero_ns), [str(text) for text in table.texts("text")]
