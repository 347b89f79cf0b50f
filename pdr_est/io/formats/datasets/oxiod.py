"""Read the Oxford Inertial Odometry Dataset (OxIOD): an iPhone, with true poses in a file beside it.

An `imuN` table has no header and 16 columns of Core Motion at 100 Hz: time, roll, pitch, yaw (rad), rotation rate
(rad/s), gravity and user acceleration (g, Apple's sign), magnetic field (uT). Poses are in `tangoN` or `viN`, row by
row.
"""

import io
import re

import numpy as np

from pdr_est.errors import RecordingError
from pdr_est.frames import Array, quaternion_from_core_motion
from pdr_est.io.conversion.axes import specific_force_from_core_motion, vertical_mismatch, vertical_mismatch_warnings
from pdr_est.io.conversion.units import EARLIEST_UNIX_S
from pdr_est.io.text.container import Source
from pdr_est.io.text.finite_values import discard_huge_values, finite_signal
from pdr_est.io.text.members import find_members, member_stem, require_single_walk
from pdr_est.io.text.number_table import NumberTable, read_table
from pdr_est.types.ground_truth import TruePositions, Truth
from pdr_est.types.recording import DeviceRecording, Recording

NAME = "OxIOD"
BESIDE = re.compile(r"(?:tango|vi)\d+\.csv(?:\.gz)?")
"""Names of files that are read beside a walk, or describe the data set."""

_COLUMNS = (
    *("time", "roll", "pitch", "yaw", "rate_x", "rate_y", "rate_z"),
    *("gravity_x", "gravity_y", "gravity_z", "user_x", "user_y", "user_z", "mag_x", "mag_y", "mag_z"),
)
_POSE_COLUMNS = ("time", "header", "x", "y", "z", "qx", "qy", "qz", "qw")
_RATE_HZ = 100.0
_POSE_SIGMA_M = 0.02
_POSE_FILES = ("tango", "vi")
_LARGEST_MISMATCH = 0.01


def sniff(source: Source) -> bool:
    """Tell whether a member of the source is a sensor table of this data set."""
    return bool(find_members(source, _is_table))


def read_source(source: Source) -> Recording:
    """Read the walk of an `imuN` table: one iPhone, with true positions if `tangoN` or `viN` is beside it.

    Time is the row number at 100 Hz, because the printed time is rounded.

    Raises
    ------
    RecordingError
        When there are several walks or the table is damaged.
    """
    member = require_single_walk(source, find_members(source, _is_table), NAME)
    place = source.place(member)
    table = read_table(source.read(member), place, has_header=False, columns=_COLUMNS)
    truth, note = _poses(source, member, len(table))
    return Recording(
        name=member_stem(member),
        format=NAME,
        devices=(_device(table),),
        truth=Truth(positions=truth),
        epoch_s=_epoch_s(table),
        notes=note,
    )


def _is_table(head: bytes) -> bool:
    """Look for sixteen numbers a row, a unit gravity, and angles that agree with that gravity."""
    lines = head.splitlines()[:-1][:20]
    if not lines or any(line.count(b",") != len(_COLUMNS) - 1 for line in lines):
        return False
    try:
        rows = discard_huge_values(np.loadtxt(io.BytesIO(b"\n".join(lines)), delimiter=",", ndmin=2))
    except ValueError:
        return False
    attitude = quaternion_from_core_motion(rows[:, 1], rows[:, 2], rows[:, 3])
    return vertical_mismatch(attitude, -rows[:, 7:10]) < _LARGEST_MISMATCH


def _device(table: NumberTable) -> DeviceRecording:
    time_s = np.arange(len(table)) / _RATE_HZ
    gravity_g = table.stack(_COLUMNS[7:10])
    angles = [table.numbers(name) for name in ("roll", "pitch", "yaw")]
    attitude = quaternion_from_core_motion(*angles)
    channels = {
        "specific force": specific_force_from_core_motion(gravity_g, table.stack(_COLUMNS[10:13])),
        "rotation rate": table.stack(_COLUMNS[4:7]),
        "magnetic field": table.stack(_COLUMNS[13:16]),
        "attitude": attitude,
    }
    signals = {what: finite_signal(time_s, values, what, table.place) for what, values in channels.items()}
    return DeviceRecording(
        model="iPhone",
        platform="ios",
        specific_force=signals["specific force"][0],
        rotation_rate=signals["rotation rate"][0],
        magnetic_field=signals["magnetic field"][0],
        attitude=signals["attitude"][0],
        decisions=(
            "time is the row number at 100 Hz, because the printed time is rounded",
            "specific force is -(gravity + user acceleration): Core Motion's g and sign",
            "attitude from roll, pitch and yaw as Rz(yaw) Rx(pitch) Ry(roll), device -> z up",
        ),
        warnings=(
            *(warning for _, warnings in signals.values() for warning in warnings),
            *vertical_mismatch_warnings(attitude, -gravity_g),
        ),
    )


def _epoch_s(table: NumberTable) -> float | None:
    first_s, _ = table.relative_time("time")
    return first_s if first_s > EARLIEST_UNIX_S else None


def _poses(source: Source, member: str, n_rows: int) -> tuple[TruePositions | None, tuple[str, ...]]:
    """Pair the poses with the sensor rows, from the first row on; either file may be longer."""
    number = re.search(r"\d+$", member_stem(member))
    files = [source.sibling(member, f"{name}{number.group()}.csv") for name in _POSE_FILES] if number else []
    beside = next((file for file in files if file is not None), None)
    if beside is None:
        return None, ()
    (pose_member,) = beside.members
    table = read_table(beside.read(pose_member), beside.place(pose_member), has_header=False, columns=_POSE_COLUMNS)
    position_m = table.stack(("x", "y"))[:n_rows]
    note = (f"truth from {pose_member}, row by row: {len(table)} poses, {n_rows} sensor rows",)
    return _finite_positions(position_m, table.place), note


def _finite_positions(position_m: Array, place: str) -> TruePositions:
    finite = np.isfinite(position_m).all(axis=1)
    if not finite.any():
        raise RecordingError(f"{place}: no finite position; restore the file or move it elsewhere")
    return TruePositions(np.flatnonzero(finite) / _RATE_HZ, position_m[finite], _POSE_SIGMA_M, "poses")
