"""Put the signals of one or several tables of one device together: one clock, units, signs, fixes."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

from pdr_est.errors import RecordingError
from pdr_est.io.conversion.gnss import GnssFixes, gnss_fixes
from pdr_est.io.conversion.gravity_content import is_gravity, lacks_gravity
from pdr_est.io.conversion.raw_device import RawDevice, RawSensor, RawSignal
from pdr_est.io.conversion.units import detect_acceleration_unit
from pdr_est.io.tables.quantities import Quantity
from pdr_est.io.tables.signals import TableSignals
from pdr_est.types.ground_truth import TruePositions
from pdr_est.types.recording import DeviceRecording, Signal

_ASSUMED_FIX_SIGMA_M = 3.0
_LONGEST_ROTATION_VECTOR = 1.01
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


@dataclass(frozen=True)
class DeviceReading:
    """Content of the tables of one device.

    Attributes
    ----------
    device
        The signals in SI units; time zero is the first row of a table with motion.
    gnss
        Positions that the tables contain.
    epoch_s
        Unix time of time zero, s; None when it is not known.
    true_positions
        Reference positions of the documented header; None when there are none.
    """

    device: DeviceRecording
    gnss: GnssFixes
    epoch_s: float | None
    true_positions: TruePositions | None = None


@dataclass(frozen=True)
class _Placed:
    """Signal of a table on the clock of the recording, with the table that it comes from."""

    raw: RawSignal
    table: TableSignals
    shift_s: float


def read_device(tables: Sequence[TableSignals], device: RawDevice) -> DeviceReading:
    """Make a device recording of tables that were recorded together.

    Parameters
    ----------
    tables
        Tables of the device; where two hold the same quantity, the first one is taken.
    device
        Facts about the device (`RawDevice` without signals); its decisions and warnings are continued.

    Raises
    ------
    RecordingError
        When no table has values of an accelerometer or gyroscope.
    """
    zero, epoch_s = _time_zero(tables)
    for table in tables:
        prefix = f"{table.place.rsplit('/', 1)[-1]}: " if len(tables) > 1 else ""
        device.decisions += [f"{prefix}{text}" for text in table.decisions]
        device.warnings += [f"{prefix}{text}" for text in table.warnings]
    placed = _placed(tables, zero, epoch_s, device)
    _settle_by_values(placed, device)
    _settle_sign(placed, device)
    device.signals = {_SENSORS[quantity]: one.raw for quantity, one in placed.items() if quantity in _SENSORS}
    if not {Quantity.FORCE, Quantity.LINEAR, Quantity.RATE} & set(placed):
        reasons = f" ({'; '.join(device.warnings)})" if device.warnings else ""
        raise RecordingError(
            f"{tables[0].place}: neither accelerometer nor gyroscope has values{reasons}; record again"
        )
    gnss = _fixes(placed, device)
    true = placed.get(Quantity.TRUE_POSITION)
    positions = None if true is None else TruePositions(true.raw.signal.time_s, true.raw.signal.values, 0.0, "poses")
    return DeviceReading(device.convert(), gnss, epoch_s, positions)


def _time_zero(tables: Sequence[TableSignals]) -> tuple[Fraction, float | None]:
    """Choose the first time of the tables with motion as time zero, and find its Unix time."""
    motion = [table for table in tables if {Quantity.FORCE, Quantity.RATE, Quantity.LINEAR} & set(table.signals)]
    first = min(motion or tables, key=lambda table: table.clock.start)
    return first.clock.start, first.clock.epoch_s


def _placed(
    tables: Sequence[TableSignals], zero: Fraction, epoch_s: float | None, device: RawDevice
) -> dict[Quantity, _Placed]:
    """Put all signals on the clock of the recording; the first table with a quantity gives it."""
    placed: dict[Quantity, _Placed] = {}
    for table in tables:
        shift_s = float(table.clock.start - zero)
        for quantity, raw in table.signals.items():
            if quantity in placed:
                device.decisions.append(
                    f"not used: {raw.title} of {table.place}, because there is another {quantity}"
                )
                continue
            signal = raw.signal if shift_s == 0.0 else Signal(raw.signal.time_s + shift_s, raw.signal.values)
            placed[quantity] = _Placed(replace(raw, signal=signal), table, shift_s)
    _check_overlap(placed, epoch_s, device)
    return placed


def _check_overlap(placed: dict[Quantity, _Placed], epoch_s: float | None, device: RawDevice) -> None:
    """Bring tables on another clock to that of the motion by their Unix time; leave them out where there is none."""
    motion = [placed[q].raw.signal for q in (Quantity.FORCE, Quantity.LINEAR, Quantity.RATE) if q in placed]
    if not motion:
        return
    start_s = min(float(signal.time_s[0]) for signal in motion)
    end_s = max(float(signal.time_s[-1]) for signal in motion)
    for quantity, one in list(placed.items()):
        times = one.raw.signal.time_s
        if quantity in (Quantity.FORCE, Quantity.LINEAR, Quantity.RATE) and len(motion) == 1:
            continue
        if float(times.max()) >= start_s - 60.0 and float(times.min()) <= end_s + 60.0:
            continue
        if epoch_s is not None and one.table.clock.epoch_s is not None:
            shift = one.table.clock.epoch_s - epoch_s - one.shift_s
            placed[quantity] = replace(one, raw=replace(one.raw, signal=Signal(times + shift, one.raw.signal.values)))
            continue
        device.warnings.append(
            f"{quantity}: left out because its times do not overlap those of the motion; both need one clock"
        )
        del placed[quantity]


def _settle_by_values(placed: dict[Quantity, _Placed], device: RawDevice) -> None:
    """Decide by the values what the titles left open: gravity in an acceleration, gravity or gyroscope."""
    rate = placed.get(Quantity.RATE)
    if rate is not None and _is_ambiguous(rate, Quantity.RATE) and is_gravity(rate.raw.signal.values):
        device.decisions.append(f"{rate.raw.title} and the following columns are gravity: their length never changes")
        placed.setdefault(Quantity.GRAVITY, placed.pop(Quantity.RATE))
    force, linear = placed.get(Quantity.FORCE), placed.get(Quantity.LINEAR)
    if force is not None and lacks_gravity(force.raw.signal):
        device.decisions.append(f"{force.raw.title} and the following columns are without gravity by their values")
        placed.pop(Quantity.FORCE)
        if linear is None:
            placed[Quantity.LINEAR] = force
            return
        force = None
    if force is None and linear is not None and not detect_acceleration_unit(_scaled(linear.raw)).warning:
        device.decisions.append(f"{linear.raw.title} and the following columns include gravity by their values")
        placed[Quantity.FORCE] = placed.pop(Quantity.LINEAR)
    vector = placed.get(Quantity.ROTATION_VECTOR)
    if vector is not None:
        longest = float(np.linalg.norm(vector.raw.signal.values, axis=1).max())
        if longest > _LONGEST_ROTATION_VECTOR or Quantity.ATTITUDE in placed:
            placed.pop(Quantity.ROTATION_VECTOR)
        if longest > _LONGEST_ROTATION_VECTOR:
            device.warnings.append(
                f"{vector.raw.title} and the following columns are not a rotation vector (length {longest:.3g}) and "
                "are left out"
            )


def _scaled(raw: RawSignal) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    return raw.signal.values if raw.factor is None else raw.signal.values * raw.factor


def _is_ambiguous(one: _Placed, quantity: Quantity) -> bool:
    columns = one.table.mapping.columns.get(quantity)
    return columns is not None and columns.ambiguous


def _settle_sign(placed: dict[Quantity, _Placed], device: RawDevice) -> None:
    """Find the sign that header, mapping or unit imply for the acceleration."""
    used = [placed[q] for q in (Quantity.FORCE, Quantity.LINEAR) if q in placed]
    if not used or device.sign is not None:
        return
    mapping = used[0].table.mapping
    columns = mapping.columns.get(Quantity.FORCE)
    if columns is not None and columns.canonical:
        device.sign, device.sign_reason, device.sign_promised = 1.0, "the documented header", True
        return
    device.sign, device.sign_reason = mapping.force_sign, mapping.sign_reason
    device.sign_promised = mapping.given and mapping.force_sign is not None
    gravity = placed.get(Quantity.GRAVITY)
    if device.sign is None and gravity is not None and Quantity.FORCE not in placed:
        unit = gravity.raw.factor or detect_acceleration_unit(gravity.raw.signal.values).factor
        if unit != 1.0:
            device.sign, device.sign_reason = -1.0, f"gravity in g is Core Motion's, {gravity.raw.title}"


def _fixes(placed: dict[Quantity, _Placed], device: RawDevice) -> GnssFixes:
    """Make a fix where the position changes, because tables repeat the last one in every row."""
    places = placed.get(Quantity.LATITUDE_LONGITUDE)
    if places is None:
        return GnssFixes((), None)
    signal = places.raw.signal
    changed = np.concatenate([[True], (np.diff(signal.values, axis=0) != 0.0).any(axis=1)])
    time_s, (latitude, longitude) = signal.time_s[changed], signal.values[changed].T
    accuracy = placed.get(Quantity.ACCURACY)
    if accuracy is None:
        sigma_m = np.full(len(time_s), _ASSUMED_FIX_SIGMA_M)
        note = f"the table has no accuracy, so {_ASSUMED_FIX_SIGMA_M:g} m is assumed"
    else:
        sigma_m = np.interp(time_s, accuracy.raw.signal.time_s, accuracy.raw.signal.values[:, 0])
        note = f"accuracy by {accuracy.raw.title}"
    device.decisions.append(f"location: {len(time_s)} changes in {len(changed)} rows are fixes; {note}")
    gnss = gnss_fixes(time_s, latitude, longitude, sigma_m)
    device.warnings += gnss.warnings
    return gnss
