"""Read MAT files of MATLAB Mobile: timetables `Acceleration`, `AngularVelocity`, `MagneticField` and `Position`.

Timetables are objects that only MATLAB and the package mat-io can read. Units are m/s^2, up at rest on every
platform, rad/s and uT. `Orientation` holds angles and is not used. Exports as CSV are read as one file a sensor.
"""

import io
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from pdr_est.errors import RecordingError
from pdr_est.frames import Array
from pdr_est.io.conversion.gnss import GnssFixes, drop_fixes_outside, gnss_fixes
from pdr_est.io.conversion.raw_device import RawDevice, RawSensor, RawSignal
from pdr_est.io.text.archives.binary_sizes import datasets_of, refuse_large_hdf5, refuse_large_mat
from pdr_est.io.text.container import UNPACKED_LIMIT_BYTES, Source
from pdr_est.io.text.finite_values import discard_huge_values, finite_signal
from pdr_est.io.text.members import find_members, member_stem, require_single_walk
from pdr_est.types.recording import Recording, Signal

NAME = "MATLAB Mobile (MAT file)"

_HDF5 = b"MATLAB 7.3 MAT-file"
_MAGICS = (b"MATLAB 5.0 MAT-file", _HDF5)
_SENSORS = {
    "Acceleration": RawSensor.FORCE,
    "AngularVelocity": RawSensor.RATE,
    "MagneticField": RawSensor.FIELD,
}
_AXES = ["X", "Y", "Z"]
_POSITION = ("latitude", "longitude", "hacc")
_ADVICE = (
    "or write each timetable as CSV in MATLAB: writetimetable(Acceleration, 'Acceleration.csv'), and likewise "
    "AngularVelocity, MagneticField and Position"
)


def sniff(source: Source) -> bool:
    """Tell whether a member is a MAT file."""
    return bool(find_members(source, _is_mat))


def read_source(source: Source) -> Recording:
    """Read the walk. Time zero is the first row of the accelerometer or gyroscope.

    Raises
    ------
    RecordingError
        For several files, without the package mat-io, and for a file without these timetables.
    """
    member = require_single_walk(source, find_members(source, _is_mat), NAME)
    place = source.place(member)
    tables = _timetables(source.read(member), place)
    motion = [tables[name] for name in ("Acceleration", "AngularVelocity") if name in tables]
    if not motion:
        listed = ", ".join(tables) or "none"
        raise RecordingError(
            f"{place}: no timetable Acceleration or AngularVelocity (timetables: {listed}); record with them "
            f"switched on, {_ADVICE}"
        )
    zero = min(_stamps(table)[0] for table in motion)
    device = RawDevice({}, sign=1.0, sign_reason="MATLAB Mobile writes Android's sign on every platform")
    for name, sensor in _SENSORS.items():
        if name in tables:
            values = discard_huge_values(tables[name][_AXES].to_numpy(dtype=np.float64))
            signal, dropped = finite_signal(_seconds(tables[name], zero), values, name, place)
            device.signals[sensor] = RawSignal(Signal(signal.time_s, signal.values), name, 1.0)
            device.warnings += dropped
    unused = sorted(set(tables) - set(_SENSORS) - {"Position"})
    device.decisions += [f"timetables not used: {', '.join(unused)}"] if unused else []
    gnss = _fixes(tables, zero, device)
    return Recording(member_stem(member), NAME, (device.convert(),), fixes=gnss.fixes, origin=gnss.origin)


def _is_mat(head: bytes) -> bool:
    return head.startswith(_MAGICS)


def _timetables(data: bytes, place: str) -> dict[str, Any]:
    """Read the timetables as pandas data frames with their times as index."""
    try:
        import matio
    except ImportError as error:
        raise RecordingError(
            f"{place}: a MAT file, whose timetables need mat-io: `pip install pdr-est[mat]`, {_ADVICE}"
        ) from error
    _refuse_large(data, place)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "recording.mat"
        path.write_bytes(data)
        try:
            variables = matio.load_from_mat(str(path))
        except Exception as error:  # the package raises whatever went wrong inside
            raise RecordingError(f"{place}: damaged MAT file ({error}); copy it again, {_ADVICE}") from error
    return {name: value for name, value in variables.items() if hasattr(value, "index") and hasattr(value, "columns")}


def _refuse_large(data: bytes, place: str) -> None:
    """Raise RecordingError for a file that unpacks to too much: the package would take memory for all of it."""
    if not data.startswith(_HDF5):
        refuse_large_mat(data, UNPACKED_LIMIT_BYTES, place)
        return
    try:
        import h5py
    except ImportError:
        return  # without it the package cannot read such files either
    try:
        with h5py.File(io.BytesIO(data), "r") as file:
            refuse_large_hdf5(datasets_of(file), len(data), UNPACKED_LIMIT_BYTES, place)
    except RecordingError:
        raise
    except Exception as error:  # the package raises whatever went wrong inside
        raise RecordingError(f"{place}: damaged MAT file ({error}); copy it again, {_ADVICE}") from error


def _stamps(table: Any) -> Any:
    return table.index.to_numpy().astype("datetime64[ns]")


def _seconds(table: Any, zero: Any) -> Array:
    seconds: Array = (_stamps(table) - zero) / np.timedelta64(1, "ns") / 1e9
    return seconds


def _fixes(tables: dict[str, Any], zero: Any, device: RawDevice) -> GnssFixes:
    position = tables.get("Position")
    if position is None or not set(_POSITION) <= set(position.columns):
        return GnssFixes((), None)
    latitude, longitude, accuracy = (position[name].to_numpy(dtype=np.float64) for name in _POSITION)
    gnss = gnss_fixes(_seconds(position, zero), latitude, longitude, accuracy)
    times = [raw.signal.time_s for raw in device.signals.values()]
    gnss = drop_fixes_outside(gnss, min(t.min() for t in times), max(t.max() for t in times))
    device.warnings += gnss.warnings
    return gnss
