"""Read walks with one file for each sensor: `Accelerometer.csv` and `Gyroscope.csv`, or `acce.txt` and `gyro.txt`.

The name of a file tells its sensor, its titles tell time and axes. Where there is no header, the rising column is the
clock and the others are x, y and z in this order. All files must count on one clock, or each from its own start.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from pdr_est.errors import RecordingError
from pdr_est.frames import Array
from pdr_est.io.conversion.gnss import GnssFixes, drop_fixes_outside, gnss_fixes
from pdr_est.io.conversion.raw_device import RawDevice, RawSensor, RawSignal
from pdr_est.io.conversion.stale_samples import count_stale_samples, stale_warning
from pdr_est.io.formats.sensor_files.grouping import SensorFile, find_walks
from pdr_est.io.formats.sensor_files.known_apps import app_of_files
from pdr_est.io.tables.clock import TableClock, read_clock
from pdr_est.io.tables.quantities import Quantity
from pdr_est.io.text.container import Source
from pdr_est.io.text.encoding import as_utf8
from pdr_est.io.text.finite_values import finite_signal_or_none
from pdr_est.io.text.loose_table import LooseTable, read_loose_table
from pdr_est.io.text.members import member_stem, require_single_walk
from pdr_est.types.recording import Recording, Signal

NAME = "one file a sensor"

_SENSORS = {
    Quantity.FORCE: RawSensor.FORCE,
    Quantity.LINEAR: RawSensor.LINEAR,
    Quantity.GRAVITY: RawSensor.GRAVITY,
    Quantity.RATE: RawSensor.RATE,
    Quantity.FIELD: RawSensor.FIELD,
    Quantity.ATTITUDE: RawSensor.ATTITUDE,
    Quantity.ROTATION_VECTOR: RawSensor.ROTATION_VECTOR,
    Quantity.PRESSURE: RawSensor.PRESSURE,
}
_MOTION = (Quantity.FORCE, Quantity.LINEAR, Quantity.RATE)
_LONGEST_VECTOR = 1.01  # of a rotation vector; angles are longer
_FARTHEST_START_S = 600.0
_ASSUMED_FIX_SIGMA_M = 3.0


@dataclass(frozen=True)
class _Part:
    """File that has been read."""

    file: SensorFile
    loose: LooseTable
    clock: TableClock

    @property
    def title(self) -> str:
        return member_stem(self.file.member)

    @property
    def values(self) -> Array:
        return self.loose.table.stack(self.file.columns.titles)


def sniff(source: Source) -> bool:
    """Tell whether the source has files that are named by their sensors, one of them a motion sensor."""
    return bool(find_walks(source))


def read_source(source: Source) -> Recording:
    """Read the walk. Time zero is the first sample of the motion sensors.

    Raises
    ------
    RecordingError
        When there are several walks, two files of one sensor, or no finite rows of a motion sensor.
    """
    walks = find_walks(source)
    walk = require_single_walk(source, tuple(walks), NAME)
    files = _one_per_sensor(source, walks[walk])
    app = app_of_files(files, [source.head(file.member, 256) for file in files])
    parts = [part for file in files if (part := _read(source, file)) is not None]
    motion = [part for part in parts if part.file.quantity in _MOTION]
    if not motion:
        raise RecordingError(f"{source.path}: neither accelerometer nor gyroscope has rows; record again")
    raw = RawDevice({}, platform=app.platform, sign=app.sign, sign_reason=f"the sign of {app.name}")
    zero = min(part.clock.start for part in motion)
    for part in parts:
        _add(raw, part, zero)
    _name_unused(raw, source, parts, files)
    gnss = _fixes(raw, parts, zero)
    first = min(motion, key=lambda part: part.clock.start)
    return Recording(
        name=member_stem(source.name) if source.path.is_file() else source.name,
        format=app.name,
        devices=(raw.convert(),),
        fixes=gnss.fixes,
        origin=gnss.origin,
        epoch_s=first.clock.epoch_s,
    )


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


def _read(source: Source, file: SensorFile) -> _Part | None:
    columns = file.columns
    clocks = [title for clock in columns.mapping.clocks for title in (clock.title, clock.fraction) if title]
    numbers = [title for one in columns.mapping.columns.values() for title in one.titles]
    data = as_utf8(source.read(file.member))
    loose = read_loose_table(data, source.place(file.member), columns.layout, numbers, clocks)
    return _Part(file, loose, read_clock(loose, columns.mapping)) if len(loose.table) else None


def _add(raw: RawDevice, part: _Part, zero: Fraction) -> None:
    """Add the signal of a file to the device."""
    sensor = _SENSORS.get(part.file.quantity)
    raw.warnings += [f"{part.title}: {warning}" for warning in (*part.loose.warnings, *part.clock.warnings)]
    if sensor is None:
        return
    raw.decisions += [f"{part.title}: {decision}" for decision in part.clock.decisions]
    time_s, values = part.clock.time_s + _shift_s(raw, part, zero), part.values
    stale = count_stale_samples(time_s)
    if stale:
        raw.warnings.append(stale_warning(part.title, stale, len(time_s)))
    signal, dropped = finite_signal_or_none(time_s[stale:], values[stale:], part.title, part.loose.table.place)
    raw.warnings += dropped
    if signal is None:
        return
    longest = float(np.linalg.norm(signal.values, axis=1).max())
    if sensor is RawSensor.ROTATION_VECTOR and longest > _LONGEST_VECTOR:
        raw.decisions.append(f"{part.title} is not used: it holds angles, not a rotation vector")
        return
    factors = set(part.file.columns.mapping.columns[part.file.quantity].factors)
    factor = factors.pop() if len(factors) == 1 else None
    raw.signals[sensor] = RawSignal(Signal(signal.time_s, signal.values), part.title, factor)


def _shift_s(raw: RawDevice, part: _Part, zero: Fraction) -> float:
    """Find the start of a file after time zero; a file on another clock is put to the beginning."""
    shift_s = float(part.clock.start - zero)
    if abs(shift_s) <= _FARTHEST_START_S:
        return shift_s
    raw.warnings.append(
        f"{part.title} begins {abs(shift_s):.0f} s {'after' if shift_s > 0 else 'before'} the others, on another "
        "clock: it is put to their beginning"
    )
    return 0.0


def _name_unused(raw: RawDevice, source: Source, parts: Sequence[_Part], files: Sequence[SensorFile]) -> None:
    """Add columns and files that were not used to the decisions."""
    for part in parts:
        if part.file.columns.mapping.unused:
            raw.decisions.append(f"{part.title}: columns not used: {', '.join(part.file.columns.mapping.unused)}")
    read = {part.file.member for part in parts}
    unused = [member for member in source.members if member not in read]
    if unused:
        raw.decisions.append(f"files not used: {', '.join(unused)}")


def _fixes(raw: RawDevice, parts: Sequence[_Part], zero: Fraction) -> GnssFixes:
    """Read a file of positions."""
    part = next((part for part in parts if part.file.quantity is Quantity.LATITUDE_LONGITUDE), None)
    if part is None:
        return GnssFixes((), None)
    latitude, longitude = part.values.T
    accuracy = part.file.columns.mapping.columns.get(Quantity.ACCURACY)
    sigma_m = np.full(len(latitude), _ASSUMED_FIX_SIGMA_M)
    if accuracy is not None:
        sigma_m = part.loose.table.numbers(accuracy.titles[0])
    else:
        raw.decisions.append(f"{part.title}: no accuracy, so {_ASSUMED_FIX_SIGMA_M:g} m is assumed")
    gnss = gnss_fixes(part.clock.time_s + _shift_s(raw, part, zero), latitude, longitude, sigma_m)
    times = [raw_signal.signal.time_s for raw_signal in raw.signals.values()]
    gnss = drop_fixes_outside(gnss, min(t.min() for t in times), max(t.max() for t in times))
    raw.warnings += gnss.warnings
    return gnss
