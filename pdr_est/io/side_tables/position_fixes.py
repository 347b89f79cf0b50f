"""Position fixes from a table that the user wrote, or from the recording itself."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pdr_est.errors import RecordingError
from pdr_est.frames import Array
from pdr_est.io.conversion.gnss import east_north
from pdr_est.io.side_tables.fix_table import FIRST_LINE, GEODETIC_COLUMNS, MAP_COLUMNS, read_fix_table
from pdr_est.io.side_tables.table_times import LOCAL_TIME
from pdr_est.io.text.number_table import NumberTable
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import GeoOrigin, Recording

DEFAULT_SIGMA_M = 1.0
"""Standard deviation, m, of each axis where the table has none."""

DEFAULT_SOURCE = "file"
"""Source of a fix for which the table names none."""

DEFAULT_WANDER_TIME_S = 60.0
"""Correlation time, s, of a wandering error for which the table has none."""

TIME_MARGIN_S = 1.0
"""A fix this far, s, outside the recording still belongs to its first or last pose."""

MARKED_SOURCES = ("waypoints", "surveyed points")
"""Sources of true positions that somebody marked on the device while passing them."""

_EPOCH_FROM_S = 1e9  # larger times are Unix times
_MILLISECONDS_FROM_S = 1e11  # larger times cannot be seconds
_SIGMA_RANGE_M = (1e-3, 1e5)
_WANDER_TIME_RANGE_S = (1e-3, 1e6)
_FARTHEST_M = 1e8  # of map coordinates, which may be UTM
_FARTHEST_FROM_ORIGIN_M = 1e5  # swapped latitude and longitude lie further away than anybody walks


def recorded_fixes(recording: Recording) -> tuple[PositionFix, ...]:
    """Return the recorder's own fixes.

    Raises
    ------
    RecordingError
        When it kept none.
    """
    if not recording.fixes:
        raise RecordingError(
            f"{recording.name}: the recording has no position fixes: give a file with --fixes "
            "FILE.csv, or leave --fixes out"
        )
    return recording.fixes


def waypoint_fixes(recording: Recording) -> tuple[PositionFix, ...]:
    """Return the positions that the walker marked on the device: taps on a map, surveyed points, annotations.

    Marked points of a data set, which are otherwise reference data, become fixes with the standard deviation that
    they have there. Whoever uses them must not judge the track by them.

    Raises
    ------
    RecordingError
        When there is none.
    """
    truth = recording.truth.positions
    marked: tuple[PositionFix, ...] = ()
    if truth is not None and truth.source in MARKED_SOURCES:
        covariance_m2 = truth.sigma_m**2 * np.eye(2)
        pairs = zip(truth.time_s, truth.position_m, strict=True)
        marked = tuple(PositionFix(float(t), p, covariance_m2, clock_known=True) for t, p in pairs)
    if not (marked or recording.waypoints):
        raise RecordingError(
            f"{recording.name}: no waypoints: nobody marked positions on the device, in rows TYPE_WAYPOINT or POSI "
            "or in annotations such as 12.5, -3: give a file with --fixes FILE.csv"
        )
    return tuple(sorted((*marked, *recording.waypoints), key=lambda fix: fix.time_s))


def fixes_within(fixes: Sequence[PositionFix], recording: Recording) -> tuple[PositionFix, ...]:
    """Keep the fixes in the time of a recording, up to `TIME_MARGIN_S`."""
    start_s, end_s = _time_span_s(recording)
    return tuple(fix for fix in fixes if start_s - TIME_MARGIN_S <= fix.time_s <= end_s + TIME_MARGIN_S)


def read_position_fixes(path: str | Path, recording: Recording) -> tuple[PositionFix, ...]:
    """Read fixes from a table with a header.

    The columns are `time_s`, then `x_m,y_m` (map frame, m) or `latitude_deg,longitude_deg`, and optionally `sigma_m`
    (standard deviation of each axis, default 1 m), `robust` (1: may be an outlier), `source` (default "file"),
    `sigma_wander_m` (standard deviation of each axis, m, of an error that wanders and is common to the fixes of a
    source; 0 leaves it to the settings of the source) and `wander_time_s` (correlation time of that error, default
    60 s). Empty cells have the default. `fix_table` knows other spellings and units of these titles. time_s is on the
    clock of the recording, Unix time or a date. A date without a time zone is compared with the date of the recording
    if that states none either, and is UTC otherwise. Latitude and longitude need a recording whose origin is known.

    Raises
    ------
    RecordingError
        For a missing or damaged table and for fixes outside the recording's time, naming file, line and remedy.
    """
    table = read_fix_table(path)
    rows = _Rows(
        time_s=_times(table, recording),
        position_m=_positions(table, recording),
        sigma_m=_numbers_or(table, "sigma_m", DEFAULT_SIGMA_M),
        robust=_numbers_or(table, "robust", 0.0),
        source=_sources(table),
        sigma_wander_m=_numbers_or(table, "sigma_wander_m", 0.0),
        wander_time_s=_numbers_or(table, "wander_time_s", DEFAULT_WANDER_TIME_S),
    )
    _check_rows(rows, table.place, recording)
    return tuple(
        PositionFix(float(t), p, np.eye(2) * s**2, str(source), bool(r), float(wander), float(correlated_s))
        for t, p, s, r, source, wander, correlated_s in rows.each()
    )


def require_fix_inside(time_s: float, place: str, recording: Recording) -> None:
    """Check that the time of a fix, s, lies inside the recording, up to `TIME_MARGIN_S`.

    Raises
    ------
    RecordingError
        When it does not; `place` names the fix in the message.
    """
    start_s, end_s = _time_span_s(recording)
    if not start_s - TIME_MARGIN_S <= time_s <= end_s + TIME_MARGIN_S:
        epoch_s = recording.epoch_s
        zero = "" if epoch_s is None else f", counted from Unix time {epoch_s:.3f} s"
        raise RecordingError(
            f"{place}: time {time_s:.3f} s is outside the recording ({start_s:.3f} to {end_s:.3f} s{zero}): "
            "use the recording's clock"
        )


@dataclass(frozen=True)
class _Rows:
    """Columns of the table, one entry a fix."""

    time_s: Array
    position_m: Array
    sigma_m: Array
    robust: Array
    source: NDArray[np.str_]
    sigma_wander_m: Array
    wander_time_s: Array

    def each(self) -> Iterator[tuple[Any, ...]]:
        """Go through the fixes, with the columns in their order."""
        return zip(*(getattr(self, one.name) for one in fields(self)), strict=True)


def _numbers_or(table: NumberTable, name: str, default: float) -> Array:
    """Return a column (n,) with a default for empty cells, or for all where the table does not have it."""
    if name not in table:
        return np.full(len(table), default)
    return np.where(table.has_values([name]), table.numbers(name), default)


def _sources(table: NumberTable) -> NDArray[np.str_]:
    """Return the source (n,) of each fix."""
    if "source" not in table:
        return np.full(len(table), DEFAULT_SOURCE)
    given = np.char.strip(table.texts("source"))
    return np.where(given == "", DEFAULT_SOURCE, given)


def _times(table: NumberTable, recording: Recording) -> Array:
    """Convert the times to the recording's clock."""
    if LOCAL_TIME in table:
        epoch_s = recording.local_epoch_s if recording.tells_local_date else recording.epoch_s
        if epoch_s is None:
            raise RecordingError(
                f"{table.place}: the times are dates, but that of {recording.name} is unknown: give seconds on its "
                "own clock"
            )
        return table.numbers(LOCAL_TIME) - epoch_s
    time_s = table.numbers("time_s")
    finite = time_s[np.isfinite(time_s)]
    middle_s = float(np.median(finite)) if len(finite) else 0.0
    start_s, end_s = _time_span_s(recording)
    counts_from_1970 = start_s >= _EPOCH_FROM_S  # by the recording's own clock
    if middle_s < _EPOCH_FROM_S or counts_from_1970 or start_s - TIME_MARGIN_S <= middle_s <= end_s + TIME_MARGIN_S:
        return time_s
    if middle_s > _MILLISECONDS_FROM_S:
        raise RecordingError(
            f"{table.place}: time_s = {middle_s:.6g} is not a time in seconds: convert milliseconds to seconds"
        )
    if recording.epoch_s is None:
        zone = "dates without a time zone, as the recording has, or " if recording.tells_local_date else ""
        raise RecordingError(
            f"{table.place}: time_s is Unix time, but that of {recording.name} is unknown: give {zone}seconds on its "
            f"own clock, {start_s:.3f} to {end_s:.3f}"
        )
    return time_s - recording.epoch_s


def _time_span_s(recording: Recording) -> tuple[float, float]:
    """Return the times of the first and the last sample of any sensor."""
    return (-np.inf, np.inf) if recording.span_s is None else recording.span_s


def _positions(table: NumberTable, recording: Recording) -> Array:
    if all(name in table for name in MAP_COLUMNS):
        return table.stack(MAP_COLUMNS)
    if recording.origin is None:
        raise RecordingError(
            f"{table.place}: the origin of {recording.name} on the Earth is unknown: give x_m and y_m instead"
        )
    return _to_map(table.stack(GEODETIC_COLUMNS), recording.origin, table.place)


def _to_map(degrees: Array, origin: GeoOrigin, place: str) -> Array:
    """Convert latitudes and longitudes (n, 2) to map positions (n, 2); refuse one far away."""
    usable = np.where(np.isfinite(degrees), degrees, np.nan)  # rows that are not finite are refused later
    latitude, longitude = usable.T
    position_m = east_north(latitude, longitude, origin)
    far = np.flatnonzero((np.linalg.norm(position_m, axis=1) > _FARTHEST_FROM_ORIGIN_M) | (np.abs(latitude) > 90.0))
    if len(far):
        raise RecordingError(
            f"{place}, line {far[0] + FIRST_LINE}: latitude {latitude[far[0]]:g}, longitude {longitude[far[0]]:g} "
            f"lies far from the recording at {origin.latitude_deg:.4f}, {origin.longitude_deg:.4f}: "
            "check whether they are swapped"
        )
    return position_m


def _check_rows(rows: _Rows, place: str, recording: Recording) -> None:
    """Refuse impossible values and times outside the recording, row by row."""
    for line, (t, p, s, r, _, wander, correlated_s) in enumerate(rows.each(), start=FIRST_LINE):
        where = f"{place}, line {line}"
        if not (np.isfinite(t) and np.isfinite(p).all()):
            raise RecordingError(f"{where}: time or position is not a finite number: correct or remove the row")
        if np.abs(p).max() > _FARTHEST_M:
            raise RecordingError(f"{where}: position {p[0]:g}, {p[1]:g} is beyond {_FARTHEST_M:g} m: give metres")
        if not _SIGMA_RANGE_M[0] <= s <= _SIGMA_RANGE_M[1]:
            raise RecordingError(
                f"{where}: sigma_m = {s:g}: give a positive number of metres, "
                f"{_SIGMA_RANGE_M[0]:g} to {_SIGMA_RANGE_M[1]:g}"
            )
        if r not in (0.0, 1.0):
            raise RecordingError(f"{where}: robust = {r:g}: give 1 for a fix that may be an outlier, else 0")
        if not 0.0 <= wander <= _SIGMA_RANGE_M[1]:
            raise RecordingError(
                f"{where}: sigma_wander_m = {wander:g}: give a number of metres from 0 to {_SIGMA_RANGE_M[1]:g}"
            )
        if not _WANDER_TIME_RANGE_S[0] <= correlated_s <= _WANDER_TIME_RANGE_S[1]:
            raise RecordingError(
                f"{where}: wander_time_s = {correlated_s:g}: give a positive number of seconds, "
                f"{_WANDER_TIME_RANGE_S[0]:g} to {_WANDER_TIME_RANGE_S[1]:g}"
            )
        require_fix_inside(t, where, recording)
