"""Read sensor logs of FlySight 2: rows `$IMU,time,…` among those of other sensors, after a header that names columns.

The header has a line with the titles and a line with the units of each kind of row, and ends with `$DATA`.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from pdr_est.errors import RecordingError
from pdr_est.io.conversion.raw_device import RawDevice, RawSensor, RawSignal
from pdr_est.io.tables.quantities import Quantity, unit_factor
from pdr_est.io.text.container import Source
from pdr_est.io.text.finite_values import finite_signal
from pdr_est.io.text.members import find_members, member_stem, require_single_walk
from pdr_est.io.text.tagged_lines import TaggedLog
from pdr_est.types.recording import Recording

NAME = "FlySight"

_DATA = b"$DATA"
_IMU = re.compile(rb"^(?:\$COL,)?IMU,time,", re.MULTILINE)
_KIND = re.compile(r"^\$?(?:COL,|UNIT,)?")
_N_FIELDS = 12
_SENSORS = (
    (RawSensor.FORCE, Quantity.FORCE, "IMU", ("ax", "ay", "az")),
    (RawSensor.RATE, Quantity.RATE, "IMU", ("wx", "wy", "wz")),
    (RawSensor.FIELD, Quantity.FIELD, "MAG", ("x", "y", "z")),
    (RawSensor.PRESSURE, Quantity.PRESSURE, "BARO", ("pressure",)),
)
_GPS_EPOCH_S = 315_964_800.0  # Unix time of 1980-01-06
_LEAP_SECONDS = 18.0  # GPS time is ahead of UTC by so much since 2017
_WEEK_S = 604_800.0


@dataclass(frozen=True)
class _RowKind:
    """Titles and units of one kind of row; field 0 is the kind itself."""

    titles: Sequence[str]
    units: Sequence[str]


def sniff(source: Source) -> bool:
    """Tell whether a member of the source has the header of this device."""
    return bool(find_members(source, _is_log))


def read_source(source: Source) -> Recording:
    """Read the walk of a log. Time zero is the first row of the accelerometer.

    Raises
    ------
    RecordingError
        When there are several walks, or no rows of the inertial sensors.
    """
    member = require_single_walk(source, find_members(source, _is_log), NAME)
    place, data = source.place(member), source.read(member)
    header, _, rows = data.partition(_DATA)
    kinds = _kinds(header.decode("utf-8", "replace"))
    content = rows.partition(b"\n")[2].replace(b"\n$", b"\n").removeprefix(b"$")
    log = TaggedLog.parse(content, place, separator=",", tag_field=0, n_fields=_N_FIELDS)
    if not log.count("IMU"):
        raise RecordingError(f"{place}: no rows of the inertial sensors; record again")
    zero_s = float(np.nanmin(log.numbers("IMU", (1,))))
    raw = RawDevice({}, decisions=["units are those of the header"], sign_reason="")
    for sensor, quantity, tag, titles in _SENSORS:
        kind = kinds.get(tag)
        if kind is None or not log.count(tag) or not set(titles) <= set(kind.titles):
            continue
        at = [kind.titles.index(title) for title in ("time", *titles)]
        found = log.numbers(tag, at)
        signal, dropped = finite_signal(found[:, 0] - zero_s, found[:, 1:], tag, place)
        unit = kind.units[at[1]] if at[1] < len(kind.units) else ""
        raw.signals[sensor] = RawSignal(signal, f"{tag} {', '.join(titles)}", unit_factor(quantity, unit))
        raw.warnings += dropped
    unused = sorted(set(log.tags()) - {tag for _, _, tag, _ in _SENSORS} - {"TIME"})
    raw.decisions += [f"rows not used: {', '.join(unused)}"] if unused else []
    return Recording(
        name=member_stem(member), format=NAME, devices=(raw.convert(),), epoch_s=_epoch_s(log, kinds, zero_s)
    )


def _is_log(head: bytes) -> bool:
    return _DATA in head and _IMU.search(head) is not None


def _kinds(header: str) -> Mapping[str, _RowKind]:
    """Find titles and units of every kind of row: the first line of a kind names titles, the second one units."""
    lines: dict[str, list[list[str]]] = {}
    for line in header.splitlines():
        cells = [cell.strip() for cell in _KIND.sub("", line, count=1).split(",")]
        lines.setdefault(cells[0], []).append(cells)
    return {
        tag: _RowKind(found[0], found[1] if len(found) > 1 else ())
        for tag, found in lines.items()
        if "time" in found[0]
    }


def _epoch_s(log: TaggedLog, kinds: Mapping[str, _RowKind], zero_s: float) -> float | None:
    """Find the Unix time of time zero by the rows that tell the GPS week and its second."""
    kind = kinds.get("TIME")
    if kind is None or not {"tow", "week"} <= set(kind.titles) or not log.count("TIME"):
        return None
    rows = log.numbers("TIME", [kind.titles.index(title) for title in ("time", "tow", "week")])
    unix_s = _GPS_EPOCH_S + rows[:, 2] * _WEEK_S + rows[:, 1] - _LEAP_SECONDS
    return float(np.nanmedian(unix_s - rows[:, 0])) + zero_s
