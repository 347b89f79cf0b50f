"""Read walks with one file for each sensor: `Accelerometer.csv` and `Gyroscope.csv`, or `acce.txt` and `gyro.txt`.

The name of a file tells its sensor, its titles tell time and axes. Where there is no header, the rising column is the
clock and the others are x, y and z in this order. All files must count on one clock, or tell the Unix time.
"""

from collections.abc import Sequence
from dataclasses import replace

from pdr_est.errors import RecordingError
from pdr_est.io.conversion.gnss import drop_fixes_outside
from pdr_est.io.conversion.raw_device import RawDevice
from pdr_est.io.formats.sensor_files.grouping import SensorFile, sensor_file_walks
from pdr_est.io.formats.sensor_files.known_apps import app_of_files
from pdr_est.io.tables.device import read_device
from pdr_est.io.tables.quantities import Quantity
from pdr_est.io.tables.signals import TableSignals, read_table_signals
from pdr_est.io.text.container import Source
from pdr_est.io.text.members import member_stem, require_single_walk
from pdr_est.types.recording import Recording

NAME = "one file a sensor"

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
    walks = sensor_file_walks(source)
    return read_sensor_files(source, walks[require_single_walk(source, tuple(walks), NAME)])


def read_sensor_files(source: Source, files: Sequence[SensorFile]) -> Recording:
    """Read the files of one walk.

    Raises
    ------
    RecordingError
        When two files hold one sensor, or no motion sensor has a finite row.
    """
    chosen = _one_per_sensor(source, files)
    app = app_of_files(chosen, [source.head(file.member, 256) for file in chosen])
    device = RawDevice({}, platform=app.platform, sign=app.sign, sign_reason=f"the sign of {app.name}")
    tables = [_read(source, file) for file in chosen]
    read = {file.member for file in chosen}
    unused = [member for member in source.members if member not in read]
    if unused:
        device.decisions.append(f"files not used: {', '.join(unused)}")
    reading = read_device(tables, device)
    span = reading.device.span_s
    gnss = reading.gnss if span is None else drop_fixes_outside(reading.gnss, *span)
    return Recording(
        name=member_stem(source.name) if source.path.is_file() else source.name,
        format=app.name,
        devices=(reading.device,),
        fixes=gnss.fixes,
        origin=gnss.origin,
        epoch_s=reading.epoch_s,
        local_epoch_s=reading.local_epoch_s,
    )


def _read(source: Source, file: SensorFile) -> TableSignals:
    """Read a file, whose name names its signals; columns without titles are no fault where it tells the sensor."""
    table = read_table_signals(source.read(file.member), source.place(file.member), hint=file.quantity)
    stem = member_stem(file.member)
    table = replace(table, signals={q: replace(raw, title=stem) for q, raw in table.signals.items()})
    if file.layout.has_header:
        return table
    expected = tuple(text for text in table.warnings if text.startswith(_NO_HEADER))
    told = tuple(text.rpartition(":")[0] for text in expected)  # without the advice to name the columns
    others = tuple(text for text in table.warnings if text not in expected)
    return replace(table, decisions=(*table.decisions, *told), warnings=others)


def _one_per_sensor(source: Source, files: Sequence[SensorFile]) -> tuple[SensorFile, ...]:
    """Choose one file for each sensor, the calibrated one."""
    chosen: dict[Quantity, SensorFile] = {}
    for file in sorted(files, key=lambda file: file.is_second_choice):
        other = chosen.setdefault(file.quantity, file)
        if other is not file and other.is_second_choice == file.is_second_choice:
            raise RecordingError(
                f"{source.path}: {other.member} and {file.member} both hold the {file.quantity}; put the files of "
                "each walk into a folder of its own"
            )
    return tuple(chosen.values())
