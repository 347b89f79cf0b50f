"""Read the Oxford step counting data set (Salvi et al. 2018): an Android phone and foot contacts.

A walk is a folder with `accelerometer.csv` (nanoseconds, accuracy, x, y, z in m/s^2, up at rest) and
`stepcounter.csv` (nanoseconds, left, right: 1 while the sensor under that foot is pressed, about ten times a second),
both without header and on one clock.
"""

import io
import re

import numpy as np
from numpy.typing import NDArray

from pdr_est.errors import RecordingError
from pdr_est.frames import Array
from pdr_est.io.tables.quantities import Quantity
from pdr_est.io.tables.titles import sensor_by_name
from pdr_est.io.text.container import Source
from pdr_est.io.text.finite_values import finite_signal
from pdr_est.io.text.members import find_members, member_stem, require_single_walk
from pdr_est.io.text.number_table import NumberTable, read_table
from pdr_est.types.ground_truth import TrueSteps, Truth
from pdr_est.types.recording import DeviceRecording, Recording

NAME = "Oxford steps"
BESIDE = re.compile(r"(?:stepcounter\.csv|notes\.txt)(?:\.gz)?")
"""Names of files that are read beside a walk, or describe the data set."""

_COLUMNS = ("time", "accuracy", "x", "y", "z")
_CONTACT_COLUMNS = ("time", "left", "right")
_CONTACT_FILE = "stepcounter.csv"
_NOTES_FILE = "notes.txt"
_TICKS_PER_S = 1e9
_FEET = (("L", "left"), ("R", "right"))
_SHORTEST_STRIDE_S = 0.5
_NUMBER = rb"-?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?"
_ROW = re.compile(rb"\d{9,19},-?\d," + b",".join([_NUMBER] * 3))
_SAMPLE_INTERVALS_S = (1e-4, 0.3)
_FORCES_MPS2 = (5.0, 20.0)


def sniff(source: Source) -> bool:
    """Tell whether a member of the source is an accelerometer table of this data set."""
    return bool(_tables(source))


def read_source(source: Source) -> Recording:
    """Read the walk of an accelerometer table, with true steps if `stepcounter.csv` is beside it.

    Times are seconds since the first accelerometer sample. A true step is the beginning of a foot contact: the state
    of a foot goes from 0 to 1. The contact flickers while the foot rolls, so a contact counts only if the previous
    counted one of that foot began at least 0.5 s earlier; no walking foot lands twice in that time (four steps a
    second). A foot that is down when the recording begins is no step.

    Raises
    ------
    RecordingError
        When there are several walks, or a table is damaged or of another walk.
    """
    member = require_single_walk(source, _tables(source), NAME)
    table = read_table(source.read(member), source.place(member), has_header=False, columns=_COLUMNS)
    start_s, time_s = table.relative_time("time", _TICKS_PER_S)
    force, warnings = finite_signal(time_s, table.stack(("x", "y", "z")), "specific force", table.place)
    device = DeviceRecording(
        platform="android",
        specific_force=force,
        decisions=(
            "time is in nanoseconds, zero at the first accelerometer sample",
            "specific force in m/s^2 with Android's signs; the data set has no other sensor",
        ),
        warnings=warnings,
    )
    steps, notes = _true_steps(source, member, start_s, float(force.time_s.max()))
    name = member_stem(member)
    return Recording(
        name=source.folder_name(member) if name == "accelerometer" else name,
        format=NAME,
        devices=(device,),
        truth=Truth() if steps is None else Truth(steps=steps, step_count=len(steps.time_s)),
        notes=(*notes, *_remarks(source, member)),
    )


def _tables(source: Source) -> tuple[str, ...]:
    """List the accelerometer tables without a gyroscope beside, which the data set does not have."""
    tables = find_members(source, _is_table)
    gyroscopes = {m.rpartition("/")[0] for m in source.members if sensor_by_name(member_stem(m)) is Quantity.RATE}
    return tuple(member for member in tables if member.rpartition("/")[0] not in gyroscopes)


def _is_table(head: bytes) -> bool:
    """Look for nanoseconds, an accuracy and three numbers a row, the rate of a sensor, and gravity."""
    lines = head.splitlines()[:-1][:20]
    if len(lines) < 2 or not all(_ROW.fullmatch(line.strip()) for line in lines):
        return False
    rows = np.loadtxt(io.BytesIO(b"\n".join(lines)), delimiter=",", ndmin=2)
    interval_s = float(np.median(np.diff(rows[:, 0]))) / _TICKS_PER_S
    force_mps2 = float(np.median(np.linalg.norm(rows[:, 2:], axis=1)))
    shortest, longest = _SAMPLE_INTERVALS_S
    weakest, strongest = _FORCES_MPS2
    return shortest < interval_s < longest and weakest < force_mps2 < strongest


def _true_steps(
    source: Source, member: str, start_s: float, end_s: float
) -> tuple[TrueSteps | None, tuple[str, ...]]:
    """Read the beginnings of contacts in order of time, with a note; start_s is the phone's clock at time zero."""
    beside = source.sibling(member, _CONTACT_FILE)
    if beside is None:
        return None, (f"no {_CONTACT_FILE} beside the accelerometer table: no true steps",)
    (contact_member,) = beside.members
    place = beside.place(contact_member)
    table = read_table(beside.read(contact_member), place, has_header=False, columns=_CONTACT_COLUMNS)
    first_s, since_s = table.relative_time("time", _TICKS_PER_S)
    time_s = first_s - start_s + since_s
    if not (time_s[0] < end_s and time_s[-1] > 0.0):
        raise RecordingError(
            f"{place}: the times do not overlap those of the accelerometer: put the file of the same walk there"
        )
    contacts, flickers = [], 0
    for foot, column in _FEET:
        every = _beginnings(time_s, _contact(table, column))
        counted = _spaced(every)
        flickers += len(every) - len(counted)
        contacts += [(time, foot) for time in counted]
    contacts.sort()
    steps = TrueSteps(
        np.array([time for time, _ in contacts]), np.array([foot for _, foot in contacts], dtype=np.str_)
    )
    note = (
        f"true steps: {len(contacts)} beginnings of a foot contact; left out as flicker, less than "
        f"{_SHORTEST_STRIDE_S:g} s after the previous one of the same foot: {flickers}"
    )
    return steps, (note,)


def _contact(table: NumberTable, column: str) -> NDArray[np.bool_]:
    values = table.numbers(column)
    wrong = np.flatnonzero(~np.isin(values, (0.0, 1.0)))
    if len(wrong):
        raise RecordingError(
            f"{table.place}, line {wrong[0] + 1}: {column} foot contact {values[wrong[0]]:g} is neither 0 nor 1; "
            "restore the file"
        )
    return np.equal(values, 1.0)


def _beginnings(time_s: Array, contact: NDArray[np.bool_]) -> Array:
    beginnings: Array = time_s[1:][contact[1:] & ~contact[:-1]]
    return beginnings


def _spaced(time_s: Array) -> list[float]:
    """Keep the times that are at least a shortest stride after the last one kept."""
    kept: list[float] = []
    for time in time_s.tolist():
        if not kept or time - kept[-1] >= _SHORTEST_STRIDE_S:
            kept.append(time)
    return kept


def _remarks(source: Source, member: str) -> tuple[str, ...]:
    """Read the remarks written down at the walk, which sometimes have a count by hand."""
    beside = source.sibling(member, _NOTES_FILE)
    if beside is None:
        return ()
    (notes_member,) = beside.members
    text = " ".join(beside.read(notes_member).decode("utf-8", "replace").split())
    return (f"{_NOTES_FILE}: {text}",) if text else ()
