"""Put the signals of one or several tables of one device together: one clock, units, signs, fixes."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from pdr_est.errors import RecordingError
from pdr_est.io.conversion.gnss import GnssFixes, gnss_fixes
from pdr_est.io.conversion.raw_device import RawDevice, RawSensor
from pdr_est.io.tables.placed import PlacedSignal, first_motion, place_signals
from pdr_est.io.tables.quantities import MOTION, Quantity
from pdr_est.io.tables.signals import TableSignals
from pdr_est.io.tables.split.reader import DeviceTables
from pdr_est.io.tables.values.angle_axes import settle_angle_axes
from pdr_est.io.tables.values.lost_units import refuse_unusable_values
from pdr_est.io.tables.values.settling import settle_quantities, settle_sign
from pdr_est.types.ground_truth import TruePositions
from pdr_est.types.recording import DeviceRecording

_ASSUMED_FIX_SIGMA_M = 3.0
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
    local_epoch_s
        As in `Recording`.
    true_positions
        Reference positions of the documented header; None when there are none.
    """

    device: DeviceRecording
    gnss: GnssFixes
    epoch_s: float | None
    local_epoch_s: float | None = None
    true_positions: TruePositions | None = None


def read_devices(devices: Sequence[DeviceTables], device: RawDevice) -> tuple[DeviceReading, ...]:
    """Make device recordings of the tables of several devices, with one time zero: the first row with motion of any.

    Parameters
    ----------
    devices
        Tables of each device, and its name.
    device
        Facts about all of them; its name is that of a device without one.

    Raises
    ------
    RecordingError
        When a device has no values of an accelerometer or gyroscope.
    """
    zero = first_motion([table for one in devices for table in one.tables])
    return tuple(
        read_device(
            one.tables,
            replace(
                device,
                name=one.name or device.name,
                signals={},
                decisions=[*device.decisions, *one.decisions],
                warnings=[*device.warnings, *one.warnings],
            ),
            zero,
        )
        for one in devices
    )


def read_device(tables: Sequence[TableSignals], device: RawDevice, zero: TableSignals | None = None) -> DeviceReading:
    """Make a device recording of tables that were recorded together.

    Parameters
    ----------
    tables
        Tables of the device; where two hold the same quantity, the first one is taken.
    device
        Facts about the device (`RawDevice` without signals); its decisions and warnings are continued.
    zero
        Table whose first row is time zero; None for the first table of the device with motion.

    Raises
    ------
    RecordingError
        When no table has values of an accelerometer or gyroscope.
    """
    first = zero or first_motion(tables)
    for table in tables:
        prefix = f"{table.place.rsplit('/', 1)[-1]}: " if len(tables) > 1 else ""
        device.decisions += [f"{prefix}{text}" for text in table.decisions]
        device.warnings += [f"{prefix}{text}" for text in table.warnings]
    placed = place_signals(tables, first.clock.start, first.clock.epoch_s, device)
    refuse_unusable_values(placed, first.place)
    settle_quantities(placed, device)
    settle_sign(placed, device)
    if not set(MOTION) & set(placed):
        reasons = f" ({'; '.join(device.warnings)})" if device.warnings else ""
        place = first.place if first in tables else tables[0].place
        raise RecordingError(f"{place}: neither accelerometer nor gyroscope has values{reasons}; record again")
    device.signals = {_SENSORS[quantity]: one.raw for quantity, one in placed.items() if quantity in _SENSORS}
    gnss = _fixes(placed, device)
    device.fixes = gnss.fixes
    device.latitude_deg = None if gnss.origin is None else gnss.origin.latitude_deg
    true = placed.get(Quantity.TRUE_POSITION)
    positions = None if true is None else TruePositions(true.raw.signal.time_s, true.raw.signal.values, 0.0, "poses")
    converted = device.convert()
    if Quantity.RATE in placed and placed[Quantity.RATE].other_order:
        converted = settle_angle_axes(converted, placed[Quantity.RATE].other_order)
    return DeviceReading(converted, gnss, first.clock.epoch_s, first.clock.local_epoch_s, positions)


def _fixes(placed: Mapping[Quantity, PlacedSignal], device: RawDevice) -> GnssFixes:
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
