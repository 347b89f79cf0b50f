"""Position fixes from a table that the user wrote, or from the recording itself."""

from collections.abc import Iterator
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pymap3d import geodetic2enu

from pdr_est.errors import RecordingError
from pdr_est.frames import Array
from pdr_est.io.text.container import Source
from pdr_est.io.text.csv_dialect import detect_dialect
from pdr_est.io.text.number_table import NumberTable, read_table
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

_MAP_COLUMNS = ("x_m", "y_m")
_GEODETIC_COLUMNS = ("latitude_deg", "longitude_deg")
_FIRST_LINE = 2  # of the data; line 1 is the header
_HEAD_BYTES = 4096
_EPOCH_FROM_S = 1e9  # larger times are Unix times
_MILLISECONDS_FROM_S = 1e11  # larger times cannot be seconds
_SIGMA_RANGE_M = (1e-3, 1e5)
_WANDER_TIME_RANGE_S = (1e-3, 1e6)
_OPTIONAL_COLUMNS = ("sigma_m", "robust", "sigma_wander_m", "wander_time_s")
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


def read_position_fixes(path: str | Path, recording: Recording) -> tuple[PositionFix, ...]:
    """Read fixes from a table with a header.

    The columns are `time_s`, then `x_m,y_m` (map frame, m) or `latitude_deg,longitude_deg`, and optionally `sigma_m`
    (standard deviation of each axis, default 1 m), `robust` (1: may be an outlier), `source` (default "file"),
    `sigma_wander_m` (standard deviation of each axis, m, of an error that wanders and is common to the fixes of a
    source; 0 leaves it to the settings of the source) and `wander_time_s` (correlation time of that error, default
    60 s). Empty cells have the default. Separators as in any CSV file. time_s is on the clock of the recording, or
    Unix time. Latitude and longitude need a recording whose origin is known.

    Raises
    ------
    RecordingError
        For a missing or damaged table and for fixes outside the recording's time, naming file, line and remedy.
    """
    table = _read_columns(path)
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
        raise RecordingError(
            f"{place}: time {time_s:.3f} s is outside the recording ({start_s:.3f} to {end_s:.3f} s): "
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


def _read_columns(path: str | Path) -> NumberTable:
    """Read the known columns, with their titles in lower case."""
    source = Source.open(path)
    if len(source.members) != 1:
        raise RecordingError(
            f"{source.path}: contains {len(source.members)} files: give the table of the fixes itself"
        )
    member = source.members[0]
    data, place = source.read(member), source.place(member)
    dialect = detect_dialect(data[:_HEAD_BYTES])
    if dialect is None:
        raise RecordingError(f"{place}: no header line such as time_s,x_m,y_m: add one")
    titles = {title.casefold(): title for title in dialect.titles}
    if "time_s" not in titles:
        raise RecordingError(
            f"{place}: no column time_s among {', '.join(dialect.titles)}: name the time column time_s"
        )
    if not (titles.keys() >= {*_MAP_COLUMNS} or titles.keys() >= {*_GEODETIC_COLUMNS}):
        raise RecordingError(
            f"{place}: needs the columns {' and '.join(_MAP_COLUMNS)}, or {' and '.join(_GEODETIC_COLUMNS)}; it has "
            f"{', '.join(dialect.titles)}"
        )
    wanted = ("time_s", *_MAP_COLUMNS, *_GEODETIC_COLUMNS, *_OPTIONAL_COLUMNS)
    table = read_table(
        data,
        place,
        separator=dialect.separator,
        decimal_comma=dialect.decimal_comma,
        columns=[titles[name] for name in wanted if name in titles],
        text_columns=[titles["source"]] if "source" in titles else [],
    )
    if not len(table):
        raise RecordingError(f"{place}: contains no fix: add a row or leave --fixes out")
    return NumberTable(
        place,
        {name.casefold(): column for name, column in table.columns.items()},
        {name.casefold(): cells for name, cells in table.empty.items()},
    )


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
    time_s = table.numbers("time_s")
    finite = time_s[np.isfinite(time_s)]
    middle_s = float(np.median(finite)) if len(finite) else 0.0
    start_s, end_s = _time_span_s(recording)
    if middle_s < _EPOCH_FROM_S or start_s - TIME_MARGIN_S <= middle_s <= end_s + TIME_MARGIN_S:
        return time_s
    if middle_s > _MILLISECONDS_FROM_S:
        raise RecordingError(
            f"{table.place}: time_s = {middle_s:.6g} is not a time in seconds: convert milliseconds to seconds"
        )
    if recording.epoch_s is None:
        raise RecordingError(
            f"{table.place}: time_s is Unix time, but that of {recording.name} is unknown: give seconds on its own "
            f"clock, {start_s:.3f} to {end_s:.3f}"
        )
    return time_s - recording.epoch_s


def _time_span_s(recording: Recording) -> tuple[float, float]:
    """Return the times of the first and the last sample of any sensor."""
    spans = [span for device in recording.devices if (span := device.span_s) is not None]
    return min((begin for begin, _ in spans), default=-np.inf), max((end for _, end in spans), default=np.inf)


def _positions(table: NumberTable, recording: Recording) -> Array:
    if all(name in table for name in _MAP_COLUMNS):
        return table.stack(_MAP_COLUMNS)
    if recording.origin is None:
        raise RecordingError(
            f"{table.place}: the origin of {recording.name} on the Earth is unknown: give x_m and y_m instead"
        )
    return _to_map(table.stack(_GEODETIC_COLUMNS), recording.origin, table.place)


def _to_map(degrees: Array, origin: GeoOrigin, place: str) -> Array:
    """Convert latitudes and longitudes (n, 2) to map positions (n, 2); refuse one far away."""
    usable = np.where(np.isfinite(degrees), degrees, np.nan)  # rows that are not finite are refused later
    latitude, longitude = usable.T
    east, north, _ = geodetic2enu(latitude, longitude, 0.0, origin.latitude_deg, origin.longitude_deg, 0.0)
    far = np.flatnonzero((np.hypot(east, north) > _FARTHEST_FROM_ORIGIN_M) | (np.abs(latitude) > 90.0))
    if len(far):
        raise RecordingError(
            f"{place}, line {far[0] + _FIRST_LINE}: latitude {latitude[far[0]]:g}, longitude {longitude[far[0]]:g} "
            f"lies far from the recording at {origin.latitude_deg:.4f}, {origin.longitude_deg:.4f}: "
            "check whether they are swapped"
        )
    return np.column_stack([east, north])


def _check_rows(rows: _Rows, place: str, recording: Recording) -> None:
    """Refuse impossible values and times outside the recording, row by row."""
    for line, (t, p, s, r, _, wander, correlated_s) in enumerate(rows.each(), start=_FIRST_LINE):
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
