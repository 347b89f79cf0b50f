"""Find the times of the rows of a table: which column tells them best, in which unit, and where the clock starts."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from pdr_est.errors import RecordingError
from pdr_est.frames import Array
from pdr_est.io.conversion.stale_samples import count_stale_samples, stale_warning
from pdr_est.io.tables.mapping import ClockColumn, TableMapping
from pdr_est.io.tables.times.candidates import ClockCandidate, holds_differences, read_candidate, unit_remedy
from pdr_est.io.tables.times.clock_units import is_impossible_rate
from pdr_est.io.tables.times.dates import KNOWN_FORMS
from pdr_est.io.tables.times.joined_columns import with_fractions
from pdr_est.io.text.loose_table import LooseTable

_AS_FINE = 0.9  # share of the distinct stamps of the finest column, from which on the order of the columns decides


@dataclass(frozen=True)
class TableClock:
    """Times of the rows of a table.

    Attributes
    ----------
    time_s
        (n,) s since `start`; NaN where a row has no time.
    start
        First time, s, on the clock of the recorder, exactly; 0 for the documented header.
    epoch_s
        Unix time of `start`; None when it is not known.
    decisions, warnings
        How the clock was found, in words.
    local_epoch_s
        What the Unix time of `start` would be if its date, which states no time zone, were UTC; of times of day alone
        the seconds since midnight; None without either.
    left_out
        (n,) rows whose time cannot be known, as the warnings tell; None without any.
    column
        Column that was chosen, with the unit of its title where that is used; None where no column tells the time.
    """

    time_s: Array
    start: Fraction
    epoch_s: float | None
    decisions: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()
    local_epoch_s: float | None = None
    left_out: NDArray[np.bool_] | None = None
    column: ClockColumn | None = None


def read_clock(loose: LooseTable, mapping: TableMapping) -> TableClock:
    """Read the times of a table.

    Parameters
    ----------
    loose
        Table with the columns that may tell the time, and those of the sensors.
    mapping
        Meaning of the columns, which names those columns or a sampling rate.

    Raises
    ------
    RecordingError
        When no column has times that can be read, or the unit of none can be told.
    """
    table = loose.table
    if mapping.rate_hz is not None:
        decision = f"time is the row number at {mapping.rate_hz:g} Hz, as the mapping states"
        return TableClock(np.arange(len(table)) / mapping.rate_hz, Fraction(0), None, (decision,))
    documented = next((column for column in mapping.clocks if column.canonical), None)
    if documented is not None and documented.title not in loose.text_columns:
        decision = "the clock counts seconds, by the documented header"
        return TableClock(table.numbers(documented.title), Fraction(0), None, (decision,))
    columns = with_fractions(loose, mapping.clocks)
    candidates = [one for column in columns if (one := read_candidate(loose, column, mapping)) is not None]
    if not candidates:
        raise RecordingError(f"{table.place}: {_no_time(loose, mapping.clocks)}")
    possible = [one for one in candidates if not _is_impossible(one, mapping)]
    if not possible:
        raise RecordingError(f"{table.place}: {_unknown_unit(candidates[0])}")
    finest = max(candidate.distinct for candidate in possible)
    chosen = next(one for one in possible if one.distinct >= _AS_FINE * finest)
    return _clock(chosen, possible)


def without_stale_rows(loose: LooseTable, clock: TableClock) -> tuple[LooseTable, TableClock, tuple[str, ...]]:
    """Leave out first rows that were measured long before the rest.

    Returns
    -------
    loose, clock
        Table and clock of the other rows.
    warnings : tuple of str
        What was left out.
    """
    known = np.flatnonzero(np.isfinite(clock.time_s))
    count = count_stale_samples(clock.time_s[known])
    if not count:
        return loose, clock, ()
    first = int(known[count])
    start_s = float(clock.time_s[first])
    kept = loose.only(slice(first, None))
    shifted = replace(
        clock,
        time_s=clock.time_s[first:] - start_s,
        start=clock.start + Fraction(start_s),
        epoch_s=None if clock.epoch_s is None else clock.epoch_s + start_s,
        local_epoch_s=None if clock.local_epoch_s is None else clock.local_epoch_s + start_s,
    )
    return kept, shifted, (stale_warning("time", count, len(clock.time_s)),)


def _clock(chosen: ClockCandidate, candidates: Sequence[ClockCandidate]) -> TableClock:
    """Count the times from the first one, and find the Unix time from whichever column tells it."""
    at = int(np.argmax(chosen.known))
    tick = chosen.ticks[at]
    factor = chosen.unit.factor
    since = (chosen.ticks - tick).astype(np.float64) * chosen.tick_s.numerator / chosen.tick_s.denominator
    time_s = np.where(chosen.known, since, np.nan)
    best_first = (chosen, *(one for one in candidates if one is not chosen))
    epoch_s = _time_of_row([one for one in best_first if not one.is_local], at)
    local_epoch_s = _time_of_row([one for one in best_first if one.is_local and one.has_date], at)
    if epoch_s is None and local_epoch_s is None:
        local_epoch_s = _time_of_row([one for one in best_first if not one.has_date], at)
    decisions = [chosen.unit.decision]
    if len(candidates) > 1:
        others = ", ".join(repr(one.column.title) for one in candidates if one is not chosen)
        decisions.append(f"time is column {chosen.column.title!r}, with {chosen.distinct} stamps; not used: {others}")
    start = chosen.exact_s(at)
    left_out = chosen.left_out if chosen.left_out.any() else None
    stated = replace(chosen.column, factor=factor if chosen.column.factor == factor else None)
    told = chosen.unit.warnings
    return TableClock(time_s, start, epoch_s, tuple(decisions), told, local_epoch_s, left_out, stated)


def _time_of_row(candidates: Sequence[ClockCandidate], row: int) -> float | None:
    """Return the seconds from 1970 to a row, by the first column that knows it; None where none does."""
    for one in candidates:
        if one.known[row] and one.before_1970_s is not None:
            return float(one.exact_s(row) - Fraction(one.before_1970_s))
    return None


def _is_impossible(candidate: ClockCandidate, mapping: TableMapping) -> bool:
    """Tell whether seconds are only assumed for the clock of a sensor, and cannot be its unit."""
    if not mapping.has_motion or candidate.column.factor is not None or candidate.unit.factor != 1.0:
        return False
    if not candidate.unit.warning:
        return False
    return is_impossible_rate(candidate.ticks[candidate.known], 1.0)


def _unknown_unit(candidate: ClockCandidate) -> str:
    ticks = candidate.ticks[candidate.known]
    shown = ", ".join(str(tick) for tick in ticks[:3])
    return (
        f"the unit of the clock cannot be determined: column {candidate.column.title!r} goes from {shown} to "
        f"{ticks[-1]} in {len(ticks)} rows, {float(ticks[-1] - ticks[0]):.4g} s if it counts seconds; "
        f"{unit_remedy(candidate.column)}"
    )


def _no_time(loose: LooseTable, columns: Sequence[ClockColumn]) -> str:
    """Say why no column gives times."""
    for column in columns:
        title = column.title
        if title in loose.table and holds_differences(title, loose.table.columns[title]):
            return (
                f"{title!r} holds the time since the row before, which cannot be summed up; write the time since the "
                "start, or give the sampling rate with --map (time: {rate_hz: 50})"
            )
    shown: Mapping[str, str] = {
        column.title: str(loose.table.columns[column.title][0])
        for column in columns
        if column.title in loose.table and len(loose.table)
    }
    cells = "; ".join(f"column {title!r} begins with {cell!r}" for title, cell in shown.items())
    return (
        f"no row has a time that can be read ({cells or 'there is none'}); known forms are numbers and {KNOWN_FORMS}"
    )
