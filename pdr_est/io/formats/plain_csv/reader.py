"""Read plain tables of one phone with a header line: the project's own format, and common titles of others.

The titles are described in `header.py`. There is one row for each time stamp; a cell is empty where a sensor has no
sample. Units and signs come from the documented header or a unit in the title, else they are detected from the
values.
"""

import csv
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from pdr_est.errors import RecordingError
from pdr_est.frames import Array
from pdr_est.io.conversion import signs, units
from pdr_est.io.conversion.axes import quaternion_from_rotation_vector
from pdr_est.io.conversion.gnss import GnssFixes, gnss_fixes
from pdr_est.io.formats.plain_csv.clock import TimeColumn, is_date_with_time, read_time_column
from pdr_est.io.formats.plain_csv.header import Quantity, QuantityColumns, parse_header
from pdr_est.io.text.container import Source
from pdr_est.io.text.csv_dialect import CsvDialect, detect_dialect
from pdr_est.io.text.finite_values import finite_signal_or_none
from pdr_est.io.text.members import find_members, member_stem, require_single_walk
from pdr_est.io.text.number_table import NumberTable, read_table
from pdr_est.types.ground_truth import TruePositions, Truth
from pdr_est.types.recording import DeviceRecording, Recording, Signal

NAME = "plain CSV"

_HEAD_BYTES = 8192
_DASH_CELL = re.compile(rb"(?<=[;,\t\n])-(?=[;,\t\r\n])")
_ASSUMED_FIX_SIGMA_M = 3.0
_LONGEST_ROTATION_VECTOR = 1.01


@dataclass
class _Reading:
    """Table while it is read."""

    table: NumberTable
    columns: Mapping[Quantity, QuantityColumns]
    clock: TimeColumn
    decisions: list[str] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)

    def signal(self, quantity: Quantity) -> Signal | None:
        """Read the rows of a quantity that have a finite value, unconverted; None when none has."""
        if quantity not in self.columns:
            return None
        titles = self.columns[quantity].titles
        values, sampled = self.table.stack(titles), self.table.has_values(titles)
        if not sampled.any():
            self.decisions.append(f"{quantity}: the columns are there but have no values")
            return None
        if not sampled.all():
            self.decisions.append(f"{quantity}: {int(sampled.sum())} of {len(sampled)} rows have values")
        signal, dropped = finite_signal_or_none(
            self.clock.time_s[sampled], values[sampled], quantity, self.table.place
        )
        self.warnings += dropped
        return signal

    def note(self, conversion: units.Conversion) -> float:
        """Keep the decision and the warning of a conversion; return its factor."""
        self.decisions.append(conversion.decision)
        self.warnings += conversion.warnings
        return conversion.factor


def sniff(source: Source) -> bool:
    """Tell whether a member is a table whose header names a time and all axes of accelerometer or gyroscope."""
    return bool(find_members(source, _is_table))


def _is_table(head: bytes) -> bool:
    dialect = detect_dialect(head)
    if dialect is None:
        return False
    columns = parse_header(dialect.titles)
    return Quantity.TIME in columns and (Quantity.FORCE in columns or Quantity.RATE in columns)


def read_source(source: Source) -> Recording:
    """Read the walk of a plain table.

    Raises
    ------
    RecordingError
        For several tables, and when neither accelerometer nor gyroscope has values.
    """
    member = require_single_walk(source, find_members(source, _is_table), NAME)
    data = source.read(member)
    dialect = detect_dialect(data[:_HEAD_BYTES])
    if dialect is None:
        raise RecordingError(f"{source.place(member)}: no header line; see docs/recorder-formats.md for the columns")
    columns = parse_header(dialect.titles)
    dates = _has_dates(data[:_HEAD_BYTES], dialect, columns[Quantity.TIME])
    table = _table(data, source.place(member), dialect, columns, dates)
    reading = _Reading(table, columns, read_time_column(table, columns[Quantity.TIME], dates))
    reading.note(reading.clock.conversion)
    device = _device(reading)
    gnss = _fixes(reading)
    return Recording(
        name=member_stem(member),
        format=NAME,
        devices=(replace(device, decisions=tuple(reading.decisions), warnings=tuple(reading.warnings)),),
        truth=Truth(positions=_true_positions(reading)),
        fixes=gnss.fixes,
        origin=gnss.origin,
        epoch_s=reading.clock.epoch_s,
    )


def _has_dates(head: bytes, dialect: CsvDialect, time: QuantityColumns) -> bool:
    """Tell whether the first row has a date in the time column."""
    lines = head.decode("utf-8-sig", "replace").splitlines()[:2]
    cells = next(csv.reader(lines[1:], delimiter=dialect.separator), [])
    at = dialect.titles.index(time.titles[0])
    return at < len(cells) and is_date_with_time(cells[at])


def _table(
    data: bytes, place: str, dialect: CsvDialect, columns: Mapping[Quantity, QuantityColumns], dates: bool
) -> NumberTable:
    """Read the known columns; a single dash is an empty cell."""
    if _DASH_CELL.search(data):
        data = _DASH_CELL.sub(b"", data)
    return read_table(
        data,
        place,
        separator=dialect.separator,
        decimal_comma=dialect.decimal_comma,
        columns=[title for known in columns.values() for title in known.titles],
        text_columns=columns[Quantity.TIME].titles if dates else (),
    )


def _device(reading: _Reading) -> DeviceRecording:
    attitude = _attitude(reading)
    force = _in_si(reading, Quantity.FORCE, units.detect_acceleration_unit)
    if force is not None:
        force, attitude = _upwards(reading, force, attitude)
    rate = _in_si(reading, Quantity.RATE, units.detect_rotation_rate_unit)
    if force is None and rate is None:
        reasons = f" ({'; '.join(reading.warnings)})" if reading.warnings else ""
        raise RecordingError(
            f"{reading.table.place}: neither accelerometer nor gyroscope has values{reasons}; record again"
        )
    return DeviceRecording(
        specific_force=force,
        rotation_rate=rate,
        magnetic_field=_magnetic_field(reading),
        attitude=attitude,
        pressure=_pressure(reading),
    )


def _in_si(reading: _Reading, quantity: Quantity, detect: Callable[[Array], units.Conversion]) -> Signal | None:
    """Convert a sensor to SI units by the header, which the values must not contradict, else by the values."""
    signal = reading.signal(quantity)
    if signal is None:
        return None
    columns = reading.columns[quantity]
    if columns.factor is None:
        return Signal(signal.time_s, signal.values * reading.note(detect(signal.values)))
    reading.decisions.append(f"{quantity}: the unit is in the header ({columns.titles[0]})")
    converted = signal if columns.factor == 1.0 else Signal(signal.time_s, signal.values * columns.factor)
    detected = detect(converted.values)
    if detected.factor != 1.0:
        reading.warnings.append(
            f"the header ({columns.titles[0]}) contradicts the values: {detected.decision}; correct one of them"
        )
    elif quantity is Quantity.FORCE:
        reading.warnings += detected.warnings
    return converted


def _upwards(reading: _Reading, force: Signal, attitude: Signal | None) -> tuple[Signal, Signal | None]:
    """Convert specific force and attitude to the project's signs; the documented header promises them."""
    columns = reading.columns[Quantity.FORCE]
    if columns.canonical:
        reading.decisions.append("acceleration points up at rest by the documented header")
        cosine = None if attitude is None else signs.gravity_cosine(force, attitude)
        if cosine is not None and cosine < 0.0:
            reading.warnings.append(f"acceleration and attitude contradict each other: median cosine {cosine:+.2f}")
        return force, attitude
    if attitude is not None:
        attitude, conversion = signs.resolve_attitude_direction(force, attitude)
        reading.note(conversion)
    expected = -1.0 if columns.apple else None
    factor = reading.note(
        signs.detect_force_sign(force, attitude, expected, f"Core Motion's titles, {columns.titles[0]}")
    )
    return Signal(force.time_s, force.values * factor), attitude


def _attitude(reading: _Reading) -> Signal | None:
    attitude = reading.signal(Quantity.ATTITUDE)
    if attitude is not None:
        return attitude
    vector = reading.signal(Quantity.ROTATION_VECTOR)
    if vector is None:
        return None
    longest = float(np.linalg.norm(vector.values, axis=1).max())
    title = reading.columns[Quantity.ROTATION_VECTOR].titles[0]
    if longest > _LONGEST_ROTATION_VECTOR:
        reading.warnings.append(
            f"{title} and the following columns are not a rotation vector (length {longest:.3g}) and are left out"
        )
        return None
    reading.decisions.append(
        f"{title} and the following columns are an Android rotation vector, because it is never longer than 1"
    )
    return Signal(vector.time_s, quaternion_from_rotation_vector(vector.values))


def _magnetic_field(reading: _Reading) -> Signal | None:
    magnetic_field = reading.signal(Quantity.FIELD)
    if magnetic_field is not None and reading.columns[Quantity.FIELD].factor is None:
        reading.decisions.append("magnetic field is assumed to be in uT")
    return magnetic_field


def _pressure(reading: _Reading) -> Signal | None:
    pressure = reading.signal(Quantity.PRESSURE)
    if pressure is None:
        return None
    measured = pressure.values[:, 0] > 0.0
    if not measured.all():
        removed = len(measured) - int(measured.sum())
        reading.warnings.append(
            f"{Quantity.PRESSURE}: {removed} of {len(measured)} rows without a positive value are left out"
        )
        pressure = Signal(pressure.time_s[measured], pressure.values[measured])
    if not len(pressure):
        return None
    factor = reading.columns[Quantity.PRESSURE].factor
    if factor is None:
        factor = reading.note(units.detect_pressure_unit(pressure.values))
    return Signal(pressure.time_s, pressure.values * factor)


def _true_positions(reading: _Reading) -> TruePositions | None:
    """Read the documented truth columns, which are taken as exact."""
    true = reading.signal(Quantity.TRUE_POSITION)
    return None if true is None else TruePositions(true.time_s, true.values, 0.0, "poses")


def _fixes(reading: _Reading) -> GnssFixes:
    """Make a fix where the position changes, because tables repeat the last one in every row."""
    places = reading.signal(Quantity.LATITUDE_LONGITUDE)
    if places is None:
        return GnssFixes((), None)
    changed = np.concatenate([[True], (np.diff(places.values, axis=0) != 0.0).any(axis=1)])
    time_s, (latitude, longitude) = places.time_s[changed], places.values[changed].T
    accuracy = reading.signal(Quantity.ACCURACY)
    if accuracy is None:
        sigma_m = np.full(len(time_s), _ASSUMED_FIX_SIGMA_M)
        accuracy_note = f"the table has no accuracy, so {_ASSUMED_FIX_SIGMA_M:g} m is assumed"
    else:
        sigma_m = np.interp(time_s, accuracy.time_s, accuracy.values[:, 0])
        accuracy_note = f"accuracy by {reading.columns[Quantity.ACCURACY].titles[0]}"
    reading.decisions.append(f"location: {len(time_s)} changes in {len(changed)} rows are fixes; {accuracy_note}")
    gnss = gnss_fixes(time_s, latitude, longitude, sigma_m)
    reading.warnings += gnss.warnings
    return gnss
