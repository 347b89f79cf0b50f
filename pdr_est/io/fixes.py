"""Position fixes from a table that the user wrote, or from the recording itself."""

from pathlib import Path

import numpy as np
from pymap3d import geodetic2enu

from pdr_est.errors import RecordingError
from pdr_est.frames import Array
from pdr_est.io.recording import Recording
from pdr_est.io.source import Source
from pdr_est.io.table import Table, read_table
from pdr_est.records import PositionFix

DEFAULT_SIGMA_M = 1.0
SLACK_S = 1.0  # a fix this far outside the recording still belongs to its first or last pose
_EPOCH_FROM_S = 1e9  # larger times are Unix times


def recorded_fixes(recording: Recording) -> tuple[PositionFix, ...]:
    """The recorder's own fixes. Raises RecordingError when it kept none."""
    if not recording.fixes:
        raise RecordingError(
            f"{recording.name}: the recording holds no position fixes: give a file with --fixes FILE.csv, or none"
        )
    return recording.fixes


def read_fixes(path: str | Path, recording: Recording) -> tuple[PositionFix, ...]:
    """Fixes of a CSV table with a header: `time_s`, then `x_m,y_m` or `latitude_deg,longitude_deg`, and optionally
    `sigma_m` (default 1 m per axis) and `robust` (1: may be an outlier).

    time_s is on the recording's clock, or Unix time. Latitude and longitude need a recording whose origin is known.
    Raises RecordingError that names file, row and remedy, also for fixes outside the recording's time.
    """
    source = Source.open(path)
    member = source.members[0]
    place = source.place(member)
    table = read_table(source.read(member), place)
    time_s = _times(table, recording, place)
    position = _positions(table, recording, place)
    sigma = table.numbers("sigma_m") if "sigma_m" in table else np.full(len(time_s), DEFAULT_SIGMA_M)
    robust = table.numbers("robust") if "robust" in table else np.zeros(len(time_s))
    _refuse_bad_rows(place, time_s, position, sigma, recording)
    return tuple(
        PositionFix(float(t), p, np.eye(2) * s**2, source="file", robust=bool(r))
        for t, p, s, r in zip(time_s, position, sigma, robust, strict=True)
    )


def _times(table: Table, recording: Recording, place: str) -> Array:
    if "time_s" not in table:
        raise RecordingError(f"{place}: no column time_s among {', '.join(table.names)}: name it so")
    if len(table) and np.median(table.numbers("time_s")) < _EPOCH_FROM_S:
        return table.numbers("time_s")
    if recording.epoch_s is None:
        raise RecordingError(f"{place}: time_s is Unix time, but {recording.name} tells none: give seconds")
    epoch_s, relative_s = table.clock("time_s")
    return relative_s + (epoch_s - recording.epoch_s)


def _positions(table: Table, recording: Recording, place: str) -> Array:
    if "x_m" in table and "y_m" in table:
        return table.stack(("x_m", "y_m"))
    if "latitude_deg" not in table or "longitude_deg" not in table:
        raise RecordingError(
            f"{place}: needs the columns x_m and y_m, or latitude_deg and longitude_deg; has {', '.join(table.names)}"
        )
    if recording.origin is None:
        raise RecordingError(f"{place}: {recording.name} has no known origin on the globe: give x_m and y_m instead")
    east, north, _ = geodetic2enu(
        table.numbers("latitude_deg"),
        table.numbers("longitude_deg"),
        0.0,
        recording.origin.latitude_deg,
        recording.origin.longitude_deg,
        0.0,
    )
    return np.column_stack([east, north])


def _refuse_bad_rows(place: str, time_s: Array, position: Array, sigma: Array, recording: Recording) -> None:
    if not len(time_s):
        raise RecordingError(f"{place}: holds no fix: add a row or leave --fixes out")
    spans = [(block.time_s[0], block.time_s[-1]) for device in recording.devices for block in device.blocks()]
    start = min((float(first) for first, _ in spans), default=-np.inf)
    end = max((float(last) for _, last in spans), default=np.inf)
    for row, (t, p, s) in enumerate(zip(time_s, position, sigma, strict=True), start=2):
        if not (np.isfinite(t) and np.isfinite(p).all()):
            raise RecordingError(f"{place} line {row}: time or position is not a finite number: mend the row")
        if not (np.isfinite(s) and s > 0.0):
            raise RecordingError(f"{place} line {row}: sigma_m = {s:g}: give a positive number of metres")
        if not start - SLACK_S <= t <= end + SLACK_S:
            raise RecordingError(
                f"{place} line {row}: time {t:.3f} s is outside the recording ({start:.3f} to {end:.3f} s): "
                "use the recording's clock"
            )
