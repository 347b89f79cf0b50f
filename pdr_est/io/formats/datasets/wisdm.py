"""Read raw tables of WISDM, activities with an Android phone in the pocket or a watch: rows `who,activity,ns,x,y,z;`.

There is no header. The accelerometer is in m/s^2 with Android's sign; tables of the gyroscope, rad/s, have the same
layout and `gyro` in their name.
"""

import re

import numpy as np
import polars as pl

from pdr_est.errors import RecordingError
from pdr_est.frames import Array
from pdr_est.io.conversion.raw_device import RawDevice, RawSensor, RawSignal
from pdr_est.io.text.container import Source
from pdr_est.io.text.finite_values import finite_signal
from pdr_est.io.text.members import find_members, member_stem, require_single_walk
from pdr_est.types.ground_truth import Truth
from pdr_est.types.recording import Recording, Signal

NAME = "WISDM"

_ROW = re.compile(rb"^\d+,[A-Za-z]+,\d{6,},\s*-?\d[\d.eE+-]*,\s*-?\d[\d.eE+-]*,\s*-?\d[\d.eE+-]*;?,?\s*$")
_COLUMNS = ("who", "activity", "ns", "x", "y", "z")
_ACTIVITIES = {"a": "walking", "b": "jogging", "c": "stairs", "d": "sitting", "e": "standing"}
_NAMED_IN_MESSAGE = 4


def sniff(source: Source) -> bool:
    """Tell whether a member of the source has rows of this data set."""
    return bool(find_members(source, _is_table))


def read_source(source: Source) -> Recording:
    """Read the walk of one person and activity; the accelerometer, and the gyroscope if its table lies beside it.

    Raises
    ------
    RecordingError
        When there are several tables of a sensor, people or activities.
    """
    members = find_members(source, _is_table)
    gyro = [member for member in members if "gyro" in member_stem(member).casefold()]
    tables = [member for member in members if member not in gyro]
    if not tables:
        raise RecordingError(f"{source.path}: only the gyroscope; give the table of the accelerometer, too")
    member = require_single_walk(source, tables, NAME)
    activity, ticks, force = _read(source, member)
    raw = RawDevice({}, platform="android", sign=1.0, sign_reason="Android's sign")
    raw.decisions.append("columns are person, activity, time in ns, x, y, z: the table has no header")
    raw.signals[RawSensor.FORCE] = _raw_signal(raw, source, member, ticks, ticks[0], force)
    if len(gyro) == 1:
        _, gyro_ticks, rate = _read(source, gyro[0])
        raw.signals[RawSensor.RATE] = _raw_signal(raw, source, gyro[0], gyro_ticks, ticks[0], rate)
    name = _ACTIVITIES.get(activity.casefold(), activity.casefold())
    return Recording(member_stem(member), NAME, (raw.convert(),), truth=Truth(activity=name))


def _is_table(head: bytes) -> bool:
    lines = [line for line in head.splitlines()[:4] if line.strip()]
    return len(lines) > 1 and all(_ROW.match(line) for line in lines[:2])


def _read(source: Source, member: str) -> tuple[str, Array, Array]:
    """Read activity, ticks, ns, and axes of a table of one person and activity."""
    header = ",".join(_COLUMNS).encode()
    frame = pl.read_csv(
        header + b"\n" + source.read(member).replace(b";", b""),
        infer_schema=False,
        quote_char=None,
        truncate_ragged_lines=True,
        encoding="utf8-lossy",
    ).filter(pl.col("activity").is_not_null())
    groups = frame.select("who", "activity").unique(maintain_order=True).rows()
    if len(groups) > 1:
        named = ", ".join(f"{who} {activity}" for who, activity in groups[:_NAMED_IN_MESSAGE])
        raise RecordingError(
            f"{source.place(member)}: {len(groups)} people and activities ({named}, …); "
            "cut out the rows of one of them"
        )
    numbers = frame.select("ns", "x", "y", "z").cast(pl.Float64, strict=False).fill_null(np.nan).to_numpy()
    return str(groups[0][1]), numbers[:, 0], numbers[:, 1:]


def _raw_signal(raw: RawDevice, source: Source, member: str, ticks: Array, zero: float, values: Array) -> RawSignal:
    title = member_stem(member)
    signal, dropped = finite_signal((ticks - zero) / 1e9, values, title, source.place(member))
    raw.warnings += dropped
    return RawSignal(Signal(signal.time_s, signal.values), title, 1.0)
