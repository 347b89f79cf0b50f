"""Phone in the hand with a second sensor at the foot that measures each stride (two steps) of the walker.

A walk is one text file without header, blanks between the fields: a tag, specific force (m/s^2), rotation rate
(rad/s), magnetic field (uT), Unix milliseconds, length of the last stride (m), its number, distance so far (m). The
last three keep their values until the next stride ends.
"""

import re

import numpy as np
from numpy.typing import NDArray

from pdr_est.errors import RecordingError
from pdr_est.frames import Array
from pdr_est.io.text.container import Source
from pdr_est.io.text.members import find_members, member_stem, require_single_walk
from pdr_est.io.text.number_table import NumberTable, finite_signal, finite_signal_or_none, read_table
from pdr_est.types.ground_truth import TrueStrides, Truth
from pdr_est.types.recording import DeviceRecording, Recording

NAME = "stride length"

_FORCE = ("acc_x", "acc_y", "acc_z")
_RATE = ("gyr_x", "gyr_y", "gyr_z")
_FIELD = ("mag_x", "mag_y", "mag_z")
_COLUMNS = (*_FORCE, *_RATE, *_FIELD, "time", "length", "number", "distance")
_TICKS_PER_S = 1e3
_LONGEST_M = 10.0  # of two steps, and of a sensor that missed a stride or two; beyond lie damaged numbers
_NUMBER = rb"-?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?"
_ROW = re.compile(rb"[A-Za-z]\S* (?:" + _NUMBER + rb" ){9}\d{13} " + _NUMBER + rb" \d+ " + _NUMBER + rb"\s*")
_TAG = re.compile(rb"^[A-Za-z]\S* ", re.MULTILINE)


def sniff(source: Source) -> bool:
    """Whether some member is a table of this data set."""
    return bool(find_members(source, _looks_right))


def read_source(source: Source) -> Recording:
    """The walk of such a file, with its strides as truth.

    Times are seconds since the first row. A stride ends where its number goes up by one, and begins where the one
    before it ended: the beginning of the first is not told, nor that of one whose predecessors are missing, and those
    are left out, with a note. Raises RecordingError when there are several walks or the table is damaged.
    """
    member = require_single_walk(source, find_members(source, _looks_right), NAME)
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
        notes=(f"true strides: {len(strides.length_m)}, {left_out} more left out: their beginning is not told",),
    )


def _looks_right(head: bytes) -> bool:
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
    """The strides whose beginning and end are told, and how many more end in the table."""
    number = table.numbers("number")
    _refuse_wrong_numbers(number, table.place)
    ends = np.flatnonzero(np.diff(number) != 0.0) + 1
    following = np.flatnonzero(number[ends[1:]] == number[ends[1:] - 1] + 1.0) + 1
    end, start = ends[following], ends[following - 1]
    length_m = table.numbers("length")[end]
    wrong = np.flatnonzero(~((length_m > 0.0) & (length_m <= _LONGEST_M)))
    if len(wrong):
        raise RecordingError(
            f"{table.place}, line {end[wrong[0]] + 1}: a stride of length {length_m[wrong[0]]:g} m, which is not "
            f"above 0 and at most {_LONGEST_M:g} m; restore the file"
        )
    return TrueStrides(time_s[start], time_s[end], length_m), len(ends) - len(following)


def _refuse_wrong_numbers(number: NDArray[np.float64], place: str) -> None:
    """Strides are counted upwards from where the recording begins."""
    wrong = np.flatnonzero(~(np.diff(number) >= 0.0))
    if len(wrong):
        before, after = number[wrong[0] : wrong[0] + 2]
        raise RecordingError(
            f"{place}, line {wrong[0] + 2}: stride number {after:g} after {before:g}; restore the file"
        )
