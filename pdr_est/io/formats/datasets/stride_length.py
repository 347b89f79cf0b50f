"""Read the stride length data set: a phone in the hand, and a sensor at the foot that measures each stride.

A walk is one text file without header, with blanks between the fields: a tag, specific force (m/s^2, up at rest),
rotation rate (rad/s), magnetic field (uT), Unix milliseconds, length of the last stride (two steps, m), its number,
distance so far (m). The last three keep their values until the next stride ends.
"""

import re

import numpy as np
from numpy.typing import NDArray

from pdr_est.errors import RecordingError
from pdr_est.frames import Array
from pdr_est.io.text.container import Source
from pdr_est.io.text.finite_values import finite_signal, finite_signal_or_none
from pdr_est.io.text.members import find_members, member_stem, require_single_walk
from pdr_est.io.text.number_table import NumberTable, read_table
from pdr_est.types.ground_truth import TrueStrides, Truth
from pdr_est.types.recording import DeviceRecording, Recording

NAME = "stride length"

_FORCE = ("acc_x", "acc_y", "acc_z")
_RATE = ("gyr_x", "gyr_y", "gyr_z")
_FIELD = ("mag_x", "mag_y", "mag_z")
_COLUMNS = (*_FORCE, *_RATE, *_FIELD, "time", "length", "number", "distance")
_TICKS_PER_S = 1e3
_LONGEST_M = 10.0  # two steps, or more where the sensor missed a stride; beyond are damaged numbers
_NUMBER = rb"-?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?"
_ROW = re.compile(rb"[A-Za-z]\S* (?:" + _NUMBER + rb" ){9}\d{13} " + _NUMBER + rb" \d+ " + _NUMBER + rb"\s*")
_TAG = re.compile(rb"^[A-Za-z]\S* ", re.MULTILINE)


def sniff(source: Source) -> bool:
    """Tell whether a member of the source is a table of this data set."""
    return bool(find_members(source, _is_table))


def read_source(source: Source) -> Recording:
    """Read the walk of such a file, with its strides as truth.

    Times are seconds since the first row. A stride ends where its number increases by one, and begins where the
    previous one ended. The beginning of the first stride is unknown, as is that of a stride whose predecessors are
    missing; those are left out, with a note.

    Raises
    ------
    RecordingError
        When there are several walks or the table is damaged.
    """
    member = require_single_walk(source, find_members(source, _is_table), NAME)
    place = source.place(member)
    table = read_table(_TAG.sub(b"", source.read(member)), place, separator=" ", has_header=False, columns=_COLUMNS)
    start_s, time_s = table.relative_time("time", _TICKS_PER_S)
    strides, left_out = _strides(table, time_s)
    return Recording(
        name=member_stem(member),
        format=NAME,
        devices=(_device(table, time_s),),
        truth=Truth(strides=strides),
        epoch_s=start_s,
        notes=(f"true strides: {len(strides.length_m)}; left out because their beginning is unknown: {left_out}",),
    )


def _is_table(head: bytes) -> bool:
    lines = head.splitlines()[:-1][:20]
    return len(lines) >= 2 and all(_ROW.fullmatch(line) for line in lines)


def _device(table: NumberTable, time_s: Array) -> DeviceRecording:
    force, force_warnings = finite_signal(time_s, table.stack(_FORCE), "specific force", table.place)
    rate, rate_warnings = finite_signal(time_s, table.stack(_RATE), "rotation rate", table.place)
    field, field_warnings = finite_signal_or_none(time_s, table.stack(_FIELD), "magnetic field", table.place)
    return DeviceRecording(
        platform="android",
        specific_force=force,
        rotation_rate=rate,
        magnetic_field=field,
        decisions=(
            "time is in Unix milliseconds, zero at the first row",
            "specific force in m/s^2 with Android's signs, rotation rate in rad/s, magnetic field in uT",
        ),
        warnings=(*force_warnings, *rate_warnings, *field_warnings),
    )


def _strides(table: NumberTable, time_s: Array) -> tuple[TrueStrides, int]:
    """Select the strides with known beginning and end, and count the others that end in the table."""
    number = table.numbers("number")
    _check_stride_numbers(number, table.place)
    ends = np.flatnonzero(np.diff(number) != 0.0) + 1
    following = np.flatnonzero(number[ends[1:]] == number[ends[1:] - 1] + 1.0) + 1
    end, start = ends[following], ends[following - 1]
    length_m = table.numbers("length")[end]
    wrong = np.flatnonzero(~((length_m > 0.0) & (length_m <= _LONGEST_M)))
    if len(wrong):
        raise RecordingError(
            f"{table.place}, line {end[wrong[0]] + 1}: the stride length {length_m[wrong[0]]:g} m is not "
            f"above 0 and at most {_LONGEST_M:g} m; restore the file"
        )
    return TrueStrides(time_s[start], time_s[end], length_m), len(ends) - len(following)


def _check_stride_numbers(number: NDArray[np.float64], place: str) -> None:
    """Check that strides are counted upwards from where the recording begins."""
    wrong = np.flatnonzero(~(np.diff(number) >= 0.0))
    if len(wrong):
        before, after = number[wrong[0] : wrong[0] + 2]
        raise RecordingError(
            f"{place}, line {wrong[0] + 2}: stride number {after:g} after {before:g}; restore the file"
        )
