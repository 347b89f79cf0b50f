"""Read walks with one file for each sensor: `Accelerometer.csv` and `Gyroscope.csv`, or `acce.txt` and `gyro.txt`.

The name of a file tells its sensor, its titles tell time and axes. Where there is no header, the rising column is the
clock and the others are x, y and z in this order. All files must count on one clock, or tell the Unix time.
"""

from collections.abc import Sequence
from dataclasses import replace

from pdr_est.errors import RecordingError, SeveralWalksError
from pdr_est.io.conversion.gnss import drop_fixes_outside
from pdr_est.io.conversion.raw_device import RawDevice
from pdr_est.io.formats.sensor_files.grouping import SensorFile, SensorFiles, by_device, sensor_file_walks
from pdr_est.io.formats.sensor_files.known_apps import app_of_files
from pdr_est.io.tables.device import read_devices
from pdr_est.io.tables.quantities import MOTION, Quantity
from pdr_est.io.tables.signals import TableSignals
from pdr_est.io.tables.split.reader import DeviceTables, read_tables
from pdr_est.io.text.container import Source
from pdr_est.io.text.members import member_stem, require_single_walk
from pdr_est.types.recording import Recording

NAME = "one file a sensor"

_NAMED = 6
_NO_HEADER = "the table has no header"


def sniff(source: Source) -> bool:
    """Tell whether the source has files that are named by their sensors, one of them a motion sensor."""
    return bool(sensor_file_walks(source))


def read_source(source: Source) -> Recording:
    """Read the walk. Time zero is the first sample of the motion sensors.

    Raises
    ------
    RecordingError
        When there are several walks, two files of one sensor, or no finite rows of a motion sensor.
    """
    return read_chosen(source, ())


def read_chosen(source: Source, chosen: Sequence[str]) -> Recording:
    """Read the walk of the chosen name, or of the chosen devices or persons where the files have rows of several."""
    walks = sensor_file_walks(source)
    wanted = tuple(walk for walk in walks if walk in chosen) or tuple(walks)
    if len(wanted) > 1 and any(walks[walk].by_name for walk in wanted):
        named = ", ".join(wanted[:_NAMED]) + (", …" if len(wanted) > _NAMED else "")
        raise SeveralWalksError(
            f"{source.path}: by their names the files are of {len(wanted)} walks ({named}): choose one with --device "
            "NAME, or put the files of each into a folder of its own",
            wanted,
            by_device=True,
        )
    walk = require_single_walk(source, wanted, NAME)
    recording = read_sensor_files(source, walks[walk], chosen)
    if walk not in chosen or len(recording.devices) > 1:
        return recording
    return replace(recording, devices=(replace(recording.devices[0], name=walk),))


def read_sensor_files(source: Source, walk: SensorFiles, chosen: Sequence[str] = ()) -> Recording:
    """Read the files of one walk.

    Raises
    ------
    RecordingError
        When two files hold one sensor, or no motion sensor has a finite row.
    """
    files = _one_per_sensor(source, walk.files)
    app = app_of_files(files, [source.head(file.member, 256) for file in files])
    device = RawDevice({}, platform=app.platform, sign=app.sign, sign_reason=f"the sign of {app.name}")
    device.warnings += [f"{member} has no rows and is left out" for member in walk.empty]
    devices = by_device([_read(source, file, chosen) for file in files])
    read = {file.member for file in files} | set(walk.empty)
    unused = [member for member in source.members if member not in read]
    if unused:
        device.decisions.append(f"files not used: {', '.join(unused)}")
    readings = read_devices(devices, device)
    first = readings[0]
    span = first.device.span_s
    gnss = first.gnss if span is None else drop_fixes_outside(first.gnss, *span)
    return Recording(
        name=member_stem(source.name) if source.path.is_file() else source.name,
        format=app.name,
        devices=tuple(reading.device for reading in readings),
        fixes=gnss.fixes,
        origin=gnss.origin,
        epoch_s=first.epoch_s,
        local_epoch_s=first.local_epoch_s,
    )


def files_of_walk(source: Source) -> tuple[SensorFile, ...]:
    """Return the files that are read of the first walk, one for each sensor."""
    return _one_per_sensor(source, next(iter(sensor_file_walks(source).values())).files)


def sign_of(source: Source, files: Sequence[SensorFile]) -> float | None:
    """Return the sign of the acceleration by the app that wrote the files; None where it is not known."""
    return app_of_files(files, [source.head(file.member, 256) for file in files]).sign


def _read(source: Source, file: SensorFile, chosen: Sequence[str]) -> tuple[DeviceTables, ...]:
    """Read a file, whose name names its signals; columns without titles are no fault where it tells the sensor."""
    place, stem = source.place(file.member), member_stem(file.member)
    found = read_tables(source.read(file.member), place, hint=file.quantity, chosen=chosen)
    return tuple(replace(one, tables=tuple(_named(table, file, stem) for table in one.tables)) for one in found)


def _named(table: TableSignals, file: SensorFile, stem: str) -> TableSignals:
    table = replace(table, signals={q: replace(raw, title=stem) for q, raw in table.signals.items()})
    if file.layout.has_header:
        return table
    expected = tuple(text for text in table.warnings if text.startswith(_NO_HEADER))
    told = tuple(text.rpartition(":")[0] for text in expected)  # without the advice to name the columns
    others = tuple(text for text in table.warnings if text not in expected)
    return replace(table, decisions=(*table.decisions, *told), warnings=others)


def _one_per_sensor(source: Source, files: Sequence[SensorFile]) -> tuple[SensorFile, ...]:
    """Choose one file for each sensor: the calibrated one, and of those that a walk can do without the first."""
    chosen: dict[Quantity, SensorFile] = {}
    for file in sorted(files, key=lambda file: file.is_second_choice):
        other = chosen.setdefault(file.quantity, file)
        if file.quantity not in MOTION or other is file:
            continue
        if other.is_second_choice == file.is_second_choice:
            raise RecordingError(
                f"{source.path}: {other.member} and {file.member} both hold the {file.quantity}; put the files of "
                "each walk into a folder of its own"
            )
    return tuple(chosen.values())
