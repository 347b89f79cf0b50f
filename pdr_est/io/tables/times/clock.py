"""Find the times of the rows of a table: which column tells them best, in which unit, and where the clock starts."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pdr_est.errors import RecordingError
from pdr_est.frames import Array
from pdr_est.io.conversion.units import EARLIEST_UNIX_S, Conversion, detect_clock_unit
from pdr_est.io.tables.mapping import ClockColumn, TableMapping
from pdr_est.io.tables.times.counter import unwrap_counter
from pdr_est.io.tables.times.dates import KNOWN_FORMS, DateTimes, parse_dates
from pdr_est.io.text.loose_table import LooseTable

_AS_FINE = 0.9  # share of the distinct stamps of the finest column, from which on the order of the columns decides
_FEWEST_KNOWN = 0.5
_RATE_HZ = (0.2, 5000.0)  # a stated unit outside of this contradicts the values
_FRACTIONS = (10**3, 10**6, 10**9)
_NAMED_CELLS = 3


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
        What the Unix time of `start` would be if its date, which states no time zone, were UTC; None without a date.
    """

    time_s: Array
    start: Fraction
    epoch_s: float | None
    decisions: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()
    local_epoch_s: float | None = None


@dataclass(frozen=True)
class _Candidate:
    """A column read as times: exact ticks, the seconds in one of them, and what is known of the clock.

    is_unix: the ticks count from 1970 in UTC; is_local: from 1970 in a time zone that is not stated.
    """

    column: ClockColumn
    ticks: NDArray[Any]
    known: NDArray[np.bool_]
    unit: Conversion
    is_unix: bool
    distinct: int
    is_local: bool = False


def read_clock(loose: LooseTable, mapping: TableMapping) -> TableClock:
    """Read the times of a table.

    Parameters
    ----------
    loose
        Table with the columns that may tell the time.
    mapping
        Meaning of the columns, which names those columns or a sampling rate.

    Raises
    ------
    RecordingError
        When no column has times that can be read.
    """
    table = loose.table
    if mapping.rate_hz is not None:
        decision = f"time is the row number at {mapping.rate_hz:g} Hz, as the mapping states"
        return TableClock(np.arange(len(table)) / mapping.rate_hz, Fraction(0), None, (decision,))
    documented = next((column for column in mapping.clocks if column.canonical), None)
    if documented is not None and documented.title not in loose.text_columns:
        decision = "the clock counts seconds, by the documented header"
        return TableClock(table.numbers(documented.title), Fraction(0), None, (decision,))
    columns = _with_fractions(loose, mapping.clocks)
    candidates = [one for column in columns if (one := _candidate(loose, column, mapping.given)) is not None]
    if not candidates:
        raise RecordingError(f"{table.place}: {_no_time(loose, mapping.clocks)}")
    finest = max(candidate.distinct for candidate in candidates)
    chosen = next(one for one in candidates if one.distinct >= _AS_FINE * finest)
    return _clock(chosen, candidates)


def _clock(chosen: _Candidate, candidates: Sequence[_Candidate]) -> TableClock:
    """Count the times from the first one, and find the Unix time from whichever column tells it."""
    at = int(np.argmax(chosen.known))
    tick = chosen.ticks[at]
    factor = chosen.unit.factor
    since = (chosen.ticks - tick).astype(np.float64)
    since = since * factor if factor >= 1.0 else since / round(1.0 / factor)
    time_s = np.where(chosen.known, since, np.nan)
    best_first = (chosen, *(one for one in candidates if one is not chosen))
    epoch_s = _time_of_row([one for one in best_first if one.is_unix], at)
    local_epoch_s = _time_of_row([one for one in best_first if one.is_local], at)
    decisions = [chosen.unit.decision]
    if len(candidates) > 1:
        others = ", ".join(repr(one.column.title) for one in candidates if one is not chosen)
        decisions.append(f"time is column {chosen.column.title!r}, with {chosen.distinct} stamps; not used: {others}")
    start = _exact_s(chosen, at)
    return TableClock(time_s, start, epoch_s, tuple(decisions), chosen.unit.warnings, local_epoch_s)


def _time_of_row(candidates: Sequence[_Candidate], row: int) -> float | None:
    """Return the time of a row, s, by the first column that knows it; None where none does."""
    return next((float(_exact_s(one, row)) for one in candidates if one.known[row]), None)


def _exact_s(candidate: _Candidate, row: int) -> Fraction:
    factor, tick = candidate.unit.factor, candidate.ticks[row]
    per_tick = Fraction(factor) if factor >= 1.0 else Fraction(1, round(1.0 / factor))
    return Fraction(int(tick) if candidate.ticks.dtype.kind == "i" else float(tick)) * per_tick


def _candidate(loose: LooseTable, column: ClockColumn, given: bool) -> _Candidate | None:
    """Read one column as times; None when it has none."""
    if column.title not in loose.table:
        return None
    if column.title in loose.text_columns:
        return _date_candidate(loose, column)
    ticks = unwrap_counter(loose.table.columns[column.title])
    known = np.isfinite(ticks)
    if known.sum() < max(1.0, _FEWEST_KNOWN * len(ticks)):
        return None
    unit = _unit(column, ticks[known], given)
    if column.fraction and column.fraction not in loose.text_columns:
        known &= np.isfinite(loose.table.numbers(column.fraction))
        if not known.any():
            return None
        ticks, unit = _joined_ticks(loose, column, ticks, known)
    first_s = float(ticks[known][0]) * unit.factor
    return _Candidate(column, ticks, known, unit, first_s > EARLIEST_UNIX_S, _count_stamps(ticks[known]))


def _count_stamps(ticks: NDArray[Any]) -> int:
    """Count the different stamps of a clock; one that comes back later counts again."""
    return int((ticks[1:] != ticks[:-1]).sum()) + 1


def _date_candidate(loose: LooseTable, column: ClockColumn) -> _Candidate | None:
    texts = loose.table.texts(column.title)
    if column.fraction and column.fraction in loose.text_columns:
        texts = np.array([f"{a} {b}".strip() for a, b in zip(texts, loose.table.texts(column.fraction), strict=True)])
    dates = parse_dates(texts)
    if dates is None or not dates.known.any():
        return None
    ticks = dates.ns
    if column.fraction and column.fraction not in loose.text_columns:
        ticks = np.where(dates.known, ticks + _fraction_ns(loose.table.columns[column.fraction]), ticks)
    is_local = dates.has_date and not dates.has_zone
    unit, distinct = _date_unit(dates, texts), _count_stamps(ticks)
    return _Candidate(column, ticks, dates.known, unit, dates.has_zone, distinct, is_local)


def _date_unit(dates: DateTimes, texts: NDArray[np.str_]) -> Conversion:
    what = "date and time" if dates.has_date else "the time of day"
    zone = "" if dates.has_zone else " without a time zone: the Unix time is unknown"
    wrong = np.flatnonzero(~dates.known & (texts != ""))
    warnings = []
    if len(wrong):
        named = ", ".join(f"{str(texts[i])!r} in row {i + 1}" for i in wrong[:_NAMED_CELLS])
        warnings.append(f"{len(wrong)} rows are left out because their time cannot be read ({named})")
    if dates.order:
        other = "month" if dates.order == "day" else "day"
        warnings.append(
            f"the date is doubtful: the {dates.order} is taken to come first in {str(texts[dates.known][0])!r}, but "
            f"it may be the {other}; write dates as 2031-02-28"
        )
    counted = ""
    if dates.counted:
        shown = str(texts[dates.known][0])
        counted = f"; the digits behind the seconds count {dates.counted}, as in {shown!r}, so that time rises evenly"
    return Conversion(1e-9, f"the clock counts {what}{zone}{counted}", "; ".join(warnings))


def _unit(column: ClockColumn, ticks: NDArray[Any], given: bool) -> Conversion:
    """Take the unit that the title states, unless the rate of the rows contradicts it, else that of the values."""
    detected = detect_clock_unit(ticks)
    if column.factor is None:
        return detected
    stated = Conversion(column.factor, f"the unit of the clock is in the header: {column.title}")
    if given:
        return replace(stated, decision=f"the unit of the clock is that of the mapping: {column.title}")
    rises = np.diff(ticks)
    step_s = float(np.median(rises[rises > 0])) * column.factor if (rises > 0).any() else 0.0
    plausible = step_s == 0.0 or _RATE_HZ[0] <= 1.0 / step_s <= _RATE_HZ[1]
    if plausible or detected.warning or detected.factor == column.factor:
        return stated
    warning = f"the unit in the header ({column.title}) contradicts the values: {detected.decision}"
    return replace(detected, warning=warning)


def _with_fractions(loose: LooseTable, columns: Sequence[ClockColumn]) -> list[ClockColumn]:
    """Join whole seconds with the column that has their fraction, and a date with the time of day beside it."""
    usable = [column for column in columns if column.title in loose.table]
    fractions = [column for column in usable if _fraction_size(loose, column.title) is not None]
    dates = _dates_without_time(loose, usable)
    result = []
    for column in usable:
        if column.fraction:
            result.append(column)
            continue
        if column in dates:
            partner = next(
                (other for other in usable if other is not column and other.title in loose.text_columns), None
            )
            result += [replace(column, fraction=partner.title)] if partner is not None else []
            continue
        if column in fractions:
            continue
        fine = next((other for other in fractions if _counts_up(loose, column.title, other.title)), None)
        result.append(column if fine is None else replace(column, fraction=fine.title))
    return result


def _dates_without_time(loose: LooseTable, columns: Sequence[ClockColumn]) -> list[ClockColumn]:
    """Find text columns with dates that have no time of day."""
    found = []
    for column in columns:
        if column.title in loose.text_columns:
            texts = loose.table.texts(column.title)
            filled = texts[texts != ""]
            if (
                len(filled)
                and ":" not in str(filled[0])
                and str(filled[0])[:1].isdigit()
                and len(str(filled[0])) <= 11
            ):
                found.append(column)
    return found


def _fraction_size(loose: LooseTable, title: str) -> int | None:
    """Return the number of ticks in a second of a column that starts anew every second; None for other columns."""
    if title in loose.text_columns:
        return None
    ticks = loose.table.columns[title]
    if ticks.dtype.kind != "i" or not len(ticks) or ticks.min() < 0:
        return None
    largest = int(ticks.max())
    size = next((size for size in _FRACTIONS if largest < size), None)
    falls = int((np.diff(ticks) < 0).sum())
    return size if size is not None and falls >= 2 and largest >= size // 2 else None


def _counts_up(loose: LooseTable, coarse: str, fine: str) -> bool:
    """Tell whether a column changes about as often as another one starts anew."""
    column = loose.table.columns[coarse]
    changes = int((column[1:] != column[:-1]).sum())
    falls = int((np.diff(loose.table.columns[fine]) < 0).sum())
    return 0 < changes <= falls + 1 and falls <= changes + 1


def _joined_ticks(
    loose: LooseTable, column: ClockColumn, seconds: NDArray[Any], known: NDArray[np.bool_]
) -> tuple[NDArray[Any], Conversion]:
    """Join whole seconds and their fraction to nanoseconds; 0 in rows that are not known."""
    fraction_ns = _fraction_ns(loose.table.columns[column.fraction])
    ticks = np.floor(np.where(known, seconds, 0)).astype(np.int64) * 10**9 + fraction_ns
    return ticks, Conversion(
        1e-9, f"the clock counts seconds in {column.title} with their fraction in {column.fraction}"
    )


def _fraction_ns(ticks: NDArray[Any]) -> NDArray[np.int64]:
    whole = np.where(np.isfinite(ticks), ticks, 0).astype(np.int64)
    largest = int(whole.max()) if len(whole) else 0
    size = next((size for size in _FRACTIONS if largest < size), 10**9)
    fraction: NDArray[np.int64] = whole * (10**9 // size)
    return fraction


def _no_time(loose: LooseTable, columns: Sequence[ClockColumn]) -> str:
    """Say why no column gives times."""
    shown: Mapping[str, str] = {
        column.title: str(loose.table.columns[column.title][0])
        for column in columns
        if column.title in loose.table and len(loose.table)
    }
    cells = "; ".join(f"column {title!r} begins with {cell!r}" for title, cell in shown.items())
    return (
        f"no row has a time that can be read ({cells or 'there is none'}); known forms are numbers and {KNOWN_FORMS}"
    )
