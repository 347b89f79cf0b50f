"""Read logs of the Indoor Location Competition 2.0 (ILC20).

A log is a text file with tab-separated rows `Unix ms, TYPE_…, values` of one Android phone, a header of `#` lines,
and waypoints that the surveyor clicked on the floor map. Units and signs are Android's: m/s^2 up at rest, rad/s, uT.
"""

import re

import numpy as np

from pdr_est.errors import RecordingError
from pdr_est.io.conversion.axes import quaternion_from_rotation_vector
from pdr_est.io.text.container import Source
from pdr_est.io.text.finite_values import finite_signal
from pdr_est.io.text.members import find_members, member_stem, require_single_walk
from pdr_est.io.text.tagged_lines import TaggedLog
from pdr_est.types.ground_truth import TruePositions, Truth
from pdr_est.types.recording import DeviceRecording, Recording, Signal
from pdr_est.types.sensors import AttitudeReference

NAME = "ILC20"

_WAYPOINT_SIGMA_M = 0.7  # clicked by the surveyor on the floor map
_START_BEFORE_SAMPLES_MS = 60_000
_ROW = re.compile(rb"^\d{13}\tTYPE_[A-Z]", re.MULTILINE)
_JOINED = re.compile(rb"(?<=[^\n])(?=\d{13}\tTYPE_)")
_HEADER_VALUE = re.compile(r"\b(startTime|Brand|Model|FloorName|SiteName):([^\t\r\n]*)")
_NO_GYROSCOPE = "no gyroscope rows: steps can be found, but headings cannot"
_N_FIELDS = 8  # time, type and the six values of the uncalibrated sensors


def sniff(source: Source) -> bool:
    """Tell whether a member of the source is a log of this format."""
    return bool(find_members(source, _is_log))


def read_source(source: Source) -> Recording:
    """Read the walk of an ILC20 log: one phone, with waypoints as true positions.

    Time zero is the startTime of the header, or the first accelerometer row when the header has none that fits.

    Raises
    ------
    RecordingError
        When there are several walks or no accelerometer rows.
    """
    member = require_single_walk(source, find_members(source, _is_log), NAME)
    place = source.place(member)
    data = source.read(member)
    log, joined = _split_log(data, place)
    header = dict(_HEADER_VALUE.findall(_header_text(data)))
    epoch_ms, zero = _time_zero(log, header)
    waypoints, incomplete = _waypoints(log, epoch_ms)
    return Recording(
        name=member_stem(member),
        format=NAME,
        devices=(_device(log, header, epoch_ms, zero, joined),),
        truth=Truth(positions=waypoints),
        epoch_s=epoch_ms / 1e3,
        notes=(*_notes(header), *incomplete),
    )


def _is_log(head: bytes) -> bool:
    return _ROW.search(head) is not None


def _header_text(data: bytes) -> str:
    lines = data[:8192].splitlines()
    return "\n".join(line.decode("utf-8", "replace") for line in lines if line.startswith(b"#"))


def _split_log(data: bytes, place: str) -> tuple[TaggedLog, int]:
    """Parse the rows of a log, and count those that had been joined to the end of another row."""
    log = _parse(data, place)
    # A cheap count decides whether the slow search for joined rows is needed.
    if data.count(b"\tTYPE_") <= log.count("TYPE_"):
        return log, 0
    repaired, joined = _JOINED.subn(b"\n", data)
    return _parse(repaired, place), joined


def _parse(data: bytes, place: str) -> TaggedLog:
    return TaggedLog.parse(data, place, separator="\t", tag_field=1, n_fields=_N_FIELDS)


def _time_zero(log: TaggedLog, header: dict[str, str]) -> tuple[float, str]:
    """Find the Unix time, ms, of time zero, and how it was found."""
    times_ms = log.numbers("TYPE_ACCELEROMETER", (0,))
    if not len(times_ms):
        times_ms = log.numbers("TYPE_ACCELEROMETER_UNCALIBRATED", (0,))
    if not len(times_ms):
        raise RecordingError(f"{log.place}: no accelerometer rows; record again with the accelerometer switched on")
    # A row without a time is dropped with the others of its sensor later on.
    first_ms = float(times_ms[np.argmax(np.isfinite(times_ms)), 0])
    start = header.get("startTime", "").strip()
    if start.isdecimal() and 0 <= first_ms - int(start) <= _START_BEFORE_SAMPLES_MS:
        return float(start), "time zero is the header's startTime"
    return first_ms, "time zero is the first accelerometer row: the header has no startTime that fits"


def _device(log: TaggedLog, header: dict[str, str], epoch_ms: float, zero: str, joined: int) -> DeviceRecording:
    decisions = [zero, "units and signs are Android's: m/s^2 upwards at rest, rad/s, uT"]
    warnings = [f"{joined} rows were joined to the end of another row and have been split off"] if joined else []
    signals: dict[str, Signal | None] = {}
    for name in ("ACCELEROMETER", "GYROSCOPE", "MAGNETIC_FIELD"):
        signals[name], decision, warning = _three_axes(log, name, epoch_ms)
        decisions += decision
        warnings += warning
    attitude, warning = _attitude(log, epoch_ms)
    if attitude is not None:
        decisions.append("attitude is TYPE_ROTATION_VECTOR, device -> magnetic east, magnetic north, up")
    return DeviceRecording(
        model=" ".join(header[key].strip() for key in ("Brand", "Model") if key in header),
        platform="android",
        specific_force=signals["ACCELEROMETER"],
        rotation_rate=signals["GYROSCOPE"],
        magnetic_field=signals["MAGNETIC_FIELD"],
        attitude=attitude,
        attitude_reference=AttitudeReference.MAGNETIC_NORTH,  # as Android defines TYPE_ROTATION_VECTOR
        decisions=tuple(decisions),
        warnings=(*warnings, *warning),
    )


def _three_axes(log: TaggedLog, name: str, epoch_ms: float) -> tuple[Signal | None, tuple[str, ...], tuple[str, ...]]:
    """Read the calibrated rows of a sensor, else its uncalibrated rows less the recorded bias."""
    rows = log.numbers(f"TYPE_{name}", (0, 2, 3, 4))
    decisions: tuple[str, ...] = ()
    if not len(rows):
        raw = log.numbers(f"TYPE_{name}_UNCALIBRATED", (0, 2, 3, 4, 5, 6, 7))
        if not len(raw):
            return None, (), (_NO_GYROSCOPE,) if name == "GYROSCOPE" else ()
        rows = np.column_stack([raw[:, 0], raw[:, 1:4] - raw[:, 4:7]])
        decisions = (f"{name.lower()}: uncalibrated rows minus their bias columns, calibrated rows are absent",)
    signal, warnings = finite_signal((rows[:, 0] - epoch_ms) / 1e3, rows[:, 1:], name.lower(), log.place)
    return signal, decisions, warnings


def _attitude(log: TaggedLog, epoch_ms: float) -> tuple[Signal | None, tuple[str, ...]]:
    rows = log.numbers("TYPE_ROTATION_VECTOR", (0, 2, 3, 4))
    if not len(rows):
        return None, ()
    return finite_signal(
        (rows[:, 0] - epoch_ms) / 1e3, quaternion_from_rotation_vector(rows[:, 1:]), "attitude", log.place
    )


def _waypoints(log: TaggedLog, epoch_ms: float) -> tuple[TruePositions | None, tuple[str, ...]]:
    """Read the clicked positions, and note rows that have none."""
    rows = log.numbers("TYPE_WAYPOINT", (0, 2, 3))
    finite = np.isfinite(rows).all(axis=1)
    note = (
        ()
        if finite.all()
        else (f"{np.count_nonzero(~finite)} of {len(rows)} waypoints are incomplete and are left out",)
    )
    if not finite.any():
        return None, note
    time_s, position_m = (rows[finite, 0] - epoch_ms) / 1e3, rows[finite, 1:]
    return TruePositions(time_s, position_m, _WAYPOINT_SIGMA_M, "waypoints"), note


def _notes(header: dict[str, str]) -> tuple[str, ...]:
    known = [
        f"{label} {header[key].strip()}"
        for key, label in (("SiteName", "site"), ("FloorName", "floor"))
        if header.get(key)
    ]
    return (", ".join(known),) if known else ()
