"""Read RoNIN sequences: `data.hdf5` with the phone's sensors at 200 Hz, and the pose of a second phone at the chest.

Sensors are Android's (m/s^2 up at rest, rad/s, uT); the reference positions are those of Tango, m, z up. `info.json`
beside the file names the first frame for which both are aligned; what is before it is left out.
"""

import io
import json
import re
from typing import Any

import numpy as np

from pdr_est.errors import RecordingError
from pdr_est.frames import Array
from pdr_est.io.conversion.raw_device import RawDevice, RawSensor, RawSignal
from pdr_est.io.conversion.signs import gravity_cosine
from pdr_est.io.text.archives.binary_sizes import refuse_large_hdf5
from pdr_est.io.text.container import UNPACKED_LIMIT_BYTES, Source
from pdr_est.io.text.finite_values import discard_huge_values, finite_signal, finite_signal_or_none
from pdr_est.io.text.members import find_members, require_single_walk
from pdr_est.types.ground_truth import TruePositions, Truth
from pdr_est.types.recording import Recording, Signal

NAME = "RoNIN"
BESIDE = re.compile(r".+\.(?:txt|json|csv)(?:\.gz)?")
"""Names of files that are read beside a walk, or that the data set keeps beside it."""

_MAGIC = b"\x89HDF\r\n\x1a\n"
_SENSORS = {"acce": RawSensor.FORCE, "gyro": RawSensor.RATE, "magnet": RawSensor.FIELD}
_ATTITUDES = ("game_rv", "rv")
_COLUMNS = {**dict.fromkeys(_SENSORS, 3), **dict.fromkeys(_ATTITUDES, 4), "poses": 3}
_GRID, _POSES = "synced", "pose/tango_pos"


def sniff(source: Source) -> bool:
    """Tell whether a member is an HDF5 file."""
    return bool(find_members(source, _is_hdf5))


def read_source(source: Source) -> Recording:
    """Read the walk of a sequence: one phone, and the positions of the body as reference.

    Raises
    ------
    RecordingError
        For several files, without the package h5py, and for a file of another layout.
    """
    member = require_single_walk(source, find_members(source, _is_hdf5), NAME)
    place = source.place(member)
    arrays = _arrays(source.read(member), place)
    first = _start_frame(source, member, len(arrays["time"]))
    ticks = arrays["time"][first:]
    time_s = ticks - ticks[0]
    device = RawDevice({}, platform="android", sign=1.0, sign_reason="Android's sign")
    device.decisions += [f"the first {first} rows are left out: info.json names the start frame"] if first else []
    for name, sensor in _SENSORS.items():
        if name in arrays:
            required = sensor in (RawSensor.FORCE, RawSensor.RATE)
            keep = finite_signal if required else finite_signal_or_none
            signal, dropped = keep(time_s, arrays[name][first:], name, place)
            device.warnings += dropped
            if signal is not None:
                device.signals[sensor] = RawSignal(signal, name, 1.0)
    attitude = next((name for name in _ATTITUDES if name in arrays), None)
    if attitude is not None:
        turning, dropped = finite_signal_or_none(time_s, arrays[attitude][first:], attitude, place)
        device.warnings += dropped
        if turning is not None:
            device.signals[RawSensor.ATTITUDE] = _attitude(device, attitude, turning)
    unused = sorted(set(arrays) - set(_SENSORS) - {"time", "poses", attitude or ""})
    device.decisions += [f"not used: {', '.join(unused)}"] if unused else []
    poses, truth = arrays.get("poses"), None
    if poses is not None:
        known, dropped = finite_signal_or_none(time_s, poses[first:, :2], _POSES, place)
        device.warnings += dropped
        truth = None if known is None else TruePositions(known.time_s, known.values, 0.0, "poses")
    name = source.folder_name(member)
    return Recording(name, NAME, (device.convert(),), truth=Truth(positions=truth))


def _is_hdf5(head: bytes) -> bool:
    return head.startswith(_MAGIC)


def _arrays(data: bytes, place: str) -> dict[str, Array]:
    """Read the arrays on the common time of the sequence, and the poses."""
    try:
        import h5py
    except ImportError as error:
        raise RecordingError(
            f"{place}: an HDF5 file, which needs h5py: `pip install pdr-est[hdf5]`, or give the recording as CSV"
        ) from error
    try:
        with h5py.File(io.BytesIO(data), "r") as file:
            if _GRID not in file or not {"time", "acce"} <= set(file[_GRID]):
                listed = ", ".join(file) or "nothing"
                raise RecordingError(
                    f"{place}: an HDF5 file without {_GRID}/time and {_GRID}/acce (it has {listed}); only RoNIN's "
                    "layout is known, give other recordings as CSV"
                )
            stated = {name: file[_GRID][name] for name in file[_GRID]}
            stated |= {"poses": file[_POSES]} if _POSES in file else {}
            refuse_large_hdf5(stated.values(), len(data), UNPACKED_LIMIT_BYTES, place)
            arrays = {name: _numbers(dataset) for name, dataset in stated.items()}
    except RecordingError:
        raise
    except Exception as error:  # the package raises whatever went wrong inside
        raise RecordingError(f"{place}: damaged HDF5 file ({error}); copy it again") from error
    n_rows = arrays["time"].size
    expected = {name: (n_rows, _COLUMNS[name]) for name in arrays if name in _COLUMNS} | {"time": (n_rows,)}
    for name, shape in expected.items():
        if arrays[name].shape != shape:
            raise RecordingError(
                f"{place}: {name} has the shape {arrays[name].shape}, not {shape}; copy the file again"
            )
    return arrays


def _numbers(dataset: Any) -> Array:
    return discard_huge_values(np.asarray(dataset, dtype=np.float64))


def _start_frame(source: Source, member: str, n_rows: int) -> int:
    """Read the first of the rows that are used; 0 where no file states it."""
    beside = source.sibling(member, "info.json")
    if beside is None:
        return 0
    try:
        info: Any = json.loads(beside.read(beside.members[0]))
    except ValueError as error:
        raise RecordingError(f"{beside.path}: damaged JSON ({error}); copy it again") from error
    first = info.get("start_frame", 0) if isinstance(info, dict) else 0
    if isinstance(first, bool) or not isinstance(first, int) or not 0 <= first < n_rows:
        raise RecordingError(
            f"{beside.path}: start_frame is {first!r}, no number of a row from 0 to {n_rows - 1}; copy it again"
        )
    return first


def _attitude(device: RawDevice, name: str, signal: Signal) -> RawSignal:
    """Order the quaternion with w first, as gravity tells: RoNIN has it first, Android's recorders have it last."""
    force = device.signals[RawSensor.FORCE].signal
    orders = [signal, Signal(signal.time_s, signal.values[:, [3, 0, 1, 2]])]
    cosines = [abs(gravity_cosine(force, order) or 0.0) for order in orders]
    last = cosines[1] > cosines[0]
    device.decisions.append(
        f"attitude is {name}, with w {'last' if last else 'first'}: its up direction fits gravity"
    )
    return RawSignal(orders[int(last)], name)
