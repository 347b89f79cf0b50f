"""Read logs of Google's GnssLogger: comma-separated rows of many sensors, each with its type first, Android.

The header lines `# Accel,utcTimeMillis,…` name the fields of each type. Motion rows have the boot clock in
nanoseconds, which is used, and the Unix time in milliseconds, which jumps. Uncalibrated rows carry the bias that the
phone estimates. Versions of 2016 have no motion sensors at all.
"""

import re
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from pdr_est.errors import RecordingError
from pdr_est.io.conversion.gnss import GnssFixes, drop_fixes_outside, gnss_fixes
from pdr_est.io.conversion.raw_device import RawDevice, RawSensor, RawSignal
from pdr_est.io.text.container import Source
from pdr_est.io.text.finite_values import finite_signal
from pdr_est.io.text.members import find_members, member_stem, require_single_walk
from pdr_est.io.text.tagged_lines import TaggedLog
from pdr_est.types.recording import DeviceRecording, Recording, Signal

NAME = "GnssLogger"

_MARK = re.compile(rb"^# (?:UncalAccel|Accel|Raw|Fix),", re.MULTILINE)
_HEADER = re.compile(r"^#\s*([A-Za-z]+),(\S.*)$", re.MULTILINE)
_N_FIELDS = 17
_HEADER_BYTES = 16384
# Fields of versions whose header lacks a line for the type.
_USUAL_FIELDS = {
    "Fix": (
        "Provider,LatitudeDegrees,LongitudeDegrees,AltitudeMeters,SpeedMps,AccuracyMeters,BearingDegrees,"
        "UnixTimeMillis"
    )
}
_MOTION = {RawSensor.FORCE: "Accel", RawSensor.RATE: "Gyro", RawSensor.FIELD: "Mag"}
_NETWORK_PROVIDERS = ("NLP", "NETWORK")


def sniff(source: Source) -> bool:
    """Tell whether a member of the source has the header of this app."""
    return bool(find_members(source, _is_log))


def read_source(source: Source) -> Recording:
    """Read the walk of a log. Time zero is the first row of the accelerometer or gyroscope.

    Raises
    ------
    RecordingError
        When there are several walks, or neither accelerometer nor gyroscope has rows.
    """
    member = require_single_walk(source, find_members(source, _is_log), NAME)
    place, data = source.place(member), source.read(member)
    log = TaggedLog.parse(data, place, separator=",", tag_field=0, n_fields=_N_FIELDS)
    fields = _field_numbers(data[:_HEADER_BYTES].decode("utf-8", "replace"))
    device, used, zero_s, epoch_s = _device(log, fields)
    span = device.span_s
    gnss = _fixes(log, fields, epoch_s)
    if span is not None:
        gnss = drop_fixes_outside(gnss, *span)
    unused = sorted({tag for tag in log.tags() if not tag.startswith("#")} - used - {"Fix"})
    decisions = (
        f"the clock is elapsedRealtimeNanos, {zero_s:.0f} s after the phone's start",
        *device.decisions,
        *((f"rows not used: {', '.join(unused)}",) if unused else ()),
    )
    return Recording(
        name=member_stem(member),
        format=NAME,
        devices=(replace(device, decisions=decisions, warnings=(*device.warnings, *gnss.warnings)),),
        fixes=gnss.fixes,
        origin=gnss.origin,
        epoch_s=epoch_s,
    )


def _is_log(head: bytes) -> bool:
    return _MARK.search(head) is not None and b"Provider" in head


def _field_numbers(header: str) -> Mapping[str, Mapping[str, int]]:
    """Find type -> name of a field in lower case -> its number in a row."""
    named = {**_USUAL_FIELDS, **dict(_HEADER.findall(header))}
    return {
        tag: {name.strip().casefold(): i for i, name in enumerate(names.split(","), start=1)}
        for tag, names in named.items()
    }


def _device(
    log: TaggedLog, fields: Mapping[str, Mapping[str, int]]
) -> tuple[DeviceRecording, set[str], float, float]:
    """Read the phone, the tags that were used, the boot time of time zero, s, and its Unix time, s."""
    rows = {sensor: _motion_rows(log, fields, name) for sensor, name in _MOTION.items()}
    starts = [found[0] for sensor in (RawSensor.FORCE, RawSensor.RATE) if len(found := rows[sensor][0])]
    if not starts:
        raise RecordingError(
            f"{log.place}: neither accelerometer nor gyroscope rows; switch on Sensors in the app and record again"
        )
    first = min(starts, key=lambda row: float(row[1]))
    zero_s = float(first[1]) / 1e9
    raw = RawDevice({}, platform="android", sign=1.0, sign_reason="Android's sign")
    for sensor, (found, title) in rows.items():
        if len(found):
            time_s, values = found[:, 1] / 1e9 - zero_s, found[:, 2:]
            signal, dropped = finite_signal(time_s, values, title, log.place)
            raw.signals[sensor] = RawSignal(Signal(signal.time_s, signal.values), title, 1.0)
            raw.warnings += dropped
    clocks = np.concatenate([found[:, :2] for found, _ in rows.values()])
    epoch_s = float(np.median(clocks[:, 0] / 1e3 - clocks[:, 1] / 1e9)) + zero_s
    used = {signal.title.split()[0] for signal in raw.signals.values()}
    return raw.convert(), used, zero_s, epoch_s


def _motion_rows(
    log: TaggedLog, fields: Mapping[str, Mapping[str, int]], name: str
) -> tuple[np.ndarray[tuple[int, int], np.dtype[np.float64]], str]:
    """Read Unix ms, boot ns and three axes, of calibrated rows or else of uncalibrated ones less their bias."""
    for tag, uncalibrated in ((name, False), (f"Uncal{name}", True)):
        names = fields.get(tag, {})
        axes = [_axis_field(names, axis, number) for number, axis in enumerate("xyz", start=3)]
        columns = [names.get("utctimemillis", 1), names.get("elapsedrealtimenanos", 2), *axes]
        biases = [number for title, number in names.items() if title.startswith("bias")][:3] or [6, 7, 8]
        rows = log.numbers(tag, [*columns, *biases] if uncalibrated else columns)
        if len(rows):
            bias = np.nan_to_num(rows[:, 5:8]) if uncalibrated else 0.0
            title = f"{tag} less its bias" if uncalibrated else tag
            return np.column_stack([rows[:, :2], rows[:, 2:5] - bias]), title
    return np.zeros((0, 5)), ""


def _axis_field(names: Mapping[str, int], axis: str, usual: int) -> int:
    """Find the field of an axis, such as `UncalAccelXMps2`."""
    pattern = re.compile(rf"^(?!bias).*{axis}(?:mps2|radpersec|microt|ut)?$")
    return next((number for title, number in names.items() if pattern.match(title)), usual)


def _fixes(log: TaggedLog, fields: Mapping[str, Mapping[str, int]], epoch_s: float) -> GnssFixes:
    """Read the fixes of the satellites, or of the fused provider where there are none, and those of the network."""
    names = fields["Fix"]
    wanted = [
        _field_of(names, ("latitudedegrees", "latitude"), 2),
        _field_of(names, ("longitudedegrees", "longitude"), 3),
        _field_of(names, ("accuracymeters", "accuracy"), 6),
        _field_of(names, ("unixtimemillis", "(utc)timeinms", "timeinms"), 8),
    ]
    rows = log.numbers("Fix", wanted)
    if not len(rows):
        return GnssFixes((), None)
    providers = log.texts("Fix", names.get("provider", 1))
    satellites = providers == "GPS"
    kept = (satellites | np.isin(providers, _NETWORK_PROVIDERS)) if satellites.any() else np.ones(len(rows), np.bool_)
    network = np.isin(providers, _NETWORK_PROVIDERS)[kept]
    latitude, longitude, accuracy, unix_ms = rows[kept].T
    gnss = gnss_fixes(unix_ms / 1e3 - epoch_s, latitude, longitude, accuracy, network)
    left = int((~kept).sum())
    note = (f"location: {left} fixes of the fused provider are left out beside those of GPS",) if left else ()
    return replace(gnss, warnings=(*gnss.warnings, *note))


def _field_of(names: Mapping[str, int], spellings: tuple[str, ...], usual: int) -> int:
    return next((names[spelling] for spelling in spellings if spelling in names), usual)
