"""Arrays of all sensors on common times with the names of RoNIN's sequences, as NumPy archive (.npz) or HDF5.

`synced/time` (n,) s, `synced/acce` (n, 3) m/s² up at rest, `synced/gyro` (n, 3) rad/s, `synced/magnet` (n, 3) µT,
`synced/game_rv` (n, 4) attitude with w first, `pose/tango_pos` (n, 3) reference positions, m. The times are those of
the accelerometer; other sensors are interpolated linearly, and left out (NaN) where they have a gap. HDF5 files are
read as RoNIN's (`datasets.ronin`).
"""

import io
import math
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from pdr_est.errors import OutputError, RecordingError
from pdr_est.frames import Array
from pdr_est.io.formats.exchange.left_out import left_out, only_device
from pdr_est.io.text.container import Source, SourceKind
from pdr_est.io.text.finite_values import finite_signal_or_none
from pdr_est.output.atomic_output import staged_file
from pdr_est.types.ground_truth import TruePositions, Truth
from pdr_est.types.recording import DeviceRecording, Recording, Signal

NAME = "synchronised arrays"

_TIME, _FORCE, _RATE, _FIELD, _ATTITUDE = "time", "acce", "gyro", "magnet", "game_rv"
_POSES = "tango_pos"
_GROUPS = dict.fromkeys((_TIME, _FORCE, _RATE, _FIELD, _ATTITUDE), "synced") | {_POSES: "pose"}
_TIME_ARRAY = f"{_GROUPS[_TIME]}/{_TIME}"
_WIDTHS = {_FORCE: 3, _RATE: 3, _FIELD: 3, _ATTITUDE: 4, _POSES: 3}
_LONGEST_GAP_S = 0.5  # over which samples are interpolated, as in resampling


def synchronised_arrays(recording: Recording, place: object = "recording") -> dict[str, Array]:
    """Put the sensors of a recording of one device on the times of the accelerometer.

    Returns
    -------
    dict
        Name with its group, such as "synced/acce" -> array, first dimension n. An array without any number is left
        out.

    Raises
    ------
    OutputError
        For several devices, and without accelerometer or gyroscope at the same times.
    """
    device = only_device(recording)
    force, rate = device.specific_force, device.rotation_rate
    if force is None or rate is None or not len(force) or not len(rate):
        raise OutputError(f"{place}: arrays need accelerometer and gyroscope: convert to CSV instead")
    order = np.unique(force.time_s, return_index=True)[1]
    time_s = force.time_s[order]
    positions = recording.truth.positions
    poses = None
    if positions is not None and positions.dense:
        flat = Signal(positions.time_s, np.column_stack([positions.position_m, np.zeros(len(positions.time_s))]))
        poses = _at(flat, time_s)
    arrays: dict[str, Array | None] = {
        _TIME: time_s,
        _FORCE: force.values[order],
        _RATE: _at(rate, time_s),
        _FIELD: None if device.magnetic_field is None else _at(device.magnetic_field, time_s),
        _ATTITUDE: None if device.attitude is None else _attitude_at(device.attitude, time_s),
        _POSES: poses,
    }
    together = np.isfinite(np.asarray(arrays[_RATE])).all(axis=1)
    if together.sum() < 2:
        raise OutputError(f"{place}: accelerometer and gyroscope never run at the same time: convert to CSV instead")
    kept = {name: array[together] for name, array in arrays.items() if array is not None}
    return {f"{_GROUPS[name]}/{name}": array for name, array in kept.items() if np.isfinite(array).any()}


def write_npz(recording: Recording, path: str | Path) -> tuple[str, ...]:
    """Write the arrays as a NumPy archive, without any pickled object.

    Returns
    -------
    tuple of str
        What of the recording is not in the arrays, in words.

    Raises
    ------
    OutputError
        As `synchronised_arrays`, and when the file cannot be written.
    """
    arrays = synchronised_arrays(recording, path)
    with staged_file(Path(path), overwrite=True) as staging, staging.open("wb") as stream:
        np.savez_compressed(stream, allow_pickle=False, **arrays)
    return _not_in(arrays, recording)


def write_hdf5(recording: Recording, path: str | Path) -> tuple[str, ...]:
    """Write the arrays as an HDF5 file.

    Returns
    -------
    tuple of str
        What of the recording is not in the arrays, in words.

    Raises
    ------
    OutputError
        As `synchronised_arrays`, without the package h5py, and when the file cannot be written.
    """
    try:
        import h5py
    except ImportError as error:
        raise OutputError(
            f"{path}: HDF5 needs the package h5py: `pip install pdr-est[hdf5]`, or write .npz instead"
        ) from error
    arrays = synchronised_arrays(recording, path)
    with staged_file(Path(path), overwrite=True) as staging, h5py.File(staging, "w") as file:
        for name, array in arrays.items():
            file.create_dataset(name, data=array)
    return _not_in(arrays, recording)


def _not_in(arrays: Mapping[str, Array], recording: Recording) -> tuple[str, ...]:
    """List what of a recording its arrays do not hold, in words."""
    device = recording.devices[0]
    held = ("positions",) if f"{_GROUPS[_POSES]}/{_POSES}" in arrays else ()
    words = list(left_out(recording, held))
    for name, signal in ((_FIELD, device.magnetic_field), (_ATTITUDE, device.attitude)):
        if signal is not None and f"{_GROUPS[name]}/{name}" not in arrays:
            words.append(f"{name}, which has no sample at the times of the other sensors")
    missing = (0 if device.specific_force is None else len(device.specific_force)) - len(arrays[_TIME_ARRAY])
    if missing:
        words.append(f"{missing} samples of the accelerometer at times without gyroscope, or at repeated times")
    return tuple(words)


def sniff(source: Source) -> bool:
    """Tell whether the source is a NumPy archive with time and accelerometer."""
    return source.kind is not SourceKind.FILE and {_TIME, _FORCE} <= _members(source).keys()


def read_source(source: Source) -> Recording:
    """Read the arrays of one walk.

    Raises
    ------
    RecordingError
        For damaged arrays and for shapes that do not fit together.
    """
    arrays = {name: _read(source, member) for name, member in _members(source).items()}
    place = str(source.path)
    time_s = arrays.pop(_TIME)
    for name, array in arrays.items():
        if array.ndim != 2 or array.shape != (len(time_s), _WIDTHS[name]):
            raise RecordingError(
                f"{place}: {name} has the shape {array.shape}, not {(len(time_s), _WIDTHS[name])}: write it again"
            )
    signals, warnings = _signals(arrays, time_s, place)
    poses = signals.get(_POSES)
    device = DeviceRecording(
        specific_force=signals.get(_FORCE),
        rotation_rate=signals.get(_RATE),
        magnetic_field=signals.get(_FIELD),
        attitude=signals.get(_ATTITUDE),
        decisions=("units and signs are those of the documented arrays: SI, up at rest, quaternions w first",),
        warnings=warnings,
    )
    truth = None if poses is None else TruePositions(poses.time_s, poses.values[:, :2], 0.0, "poses")
    return Recording(source.path.stem, NAME, (device,), truth=Truth(positions=truth))


def _signals(arrays: Mapping[str, Array], time_s: Array, place: str) -> tuple[dict[str, Signal], tuple[str, ...]]:
    signals: dict[str, Signal] = {}
    warnings: list[str] = []
    for name, array in arrays.items():
        known = np.isfinite(array).all(axis=1)
        signal, dropped = finite_signal_or_none(time_s[known], array[known], name, place)
        warnings += dropped
        if signal is not None:
            signals[name] = signal
    return signals, tuple(warnings)


def _members(source: Source) -> dict[str, str]:
    """Find the members by the names of their arrays."""
    stems = {member.rpartition("/")[2]: member for member in source.members}
    return {name: stems[f"{name}.npy"] for name in _GROUPS if f"{name}.npy" in stems}


def _read(source: Source, member: str) -> Array:
    content = source.read(member)
    try:
        _refuse_untrue_shape(content)
        array = np.lib.format.read_array(io.BytesIO(content), allow_pickle=False)
        return np.asarray(array, dtype=np.float64)
    except (ValueError, EOFError, OSError, TypeError) as error:
        raise RecordingError(f"{source.place(member)}: damaged array ({error}); write it again") from error


def _refuse_untrue_shape(content: bytes) -> None:
    """Raise ValueError if an array states more numbers than it holds: memory would be taken for all of them."""
    stream = io.BytesIO(content)
    version = np.lib.format.read_magic(stream)
    read_header = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
    shape, _, dtype = read_header(stream)
    stated = math.prod(shape) * dtype.itemsize
    if not dtype.hasobject and stated > len(content):
        raise ValueError(f"its header states {stated} bytes, but it holds {len(content)}")


def _at(signal: Signal, time_s: Array) -> Array:
    """Interpolate a signal at times (n,), s; NaN in its gaps and outside."""
    stamps, first = np.unique(signal.time_s, return_index=True)
    values = signal.values[first]
    found = np.column_stack([np.interp(time_s, stamps, column) for column in values.T])
    after = np.clip(np.searchsorted(stamps, time_s), 1, max(len(stamps) - 1, 1))
    gap_s = stamps[after % len(stamps)] - stamps[after - 1]
    exact = np.isin(time_s, stamps)
    outside = (time_s < stamps[0]) | (time_s > stamps[-1])
    found[~exact & (outside | (gap_s > _LONGEST_GAP_S))] = np.nan
    return found


def _attitude_at(attitude: Signal, time_s: Array) -> Array:
    """Interpolate quaternions (m, 4) at times (n,), s, along the shorter way."""
    values = attitude.values.copy()
    turned = np.cumsum(np.sum(values[1:] * values[:-1], axis=1) < 0.0) % 2 == 1
    values[1:][turned] *= -1.0
    found = _at(Signal(attitude.time_s, values), time_s)
    norm = np.linalg.norm(found, axis=1, keepdims=True)
    return np.asarray(found / np.where(norm > 0.0, norm, np.nan))
