"""Read one column of a table as times, with its unit and what is known of its date."""

from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array
from pdr_est.io.conversion.units import Conversion
from pdr_est.io.tables.mapping import ClockColumn, TableMapping
from pdr_est.io.tables.quantities import MOTION
from pdr_est.io.tables.times.calendar import DAY_S
from pdr_est.io.tables.times.clock_units import (
    detect_clock_unit,
    is_impossible_rate,
    seconds_before_1970,
    step_of_rows,
)
from pdr_est.io.tables.times.counter import unwrap_counter
from pdr_est.io.tables.times.date_parts import read_date_parts, shown_date_parts
from pdr_est.io.tables.times.dates import DateTimes, parse_dates
from pdr_est.io.tables.times.joined_columns import fraction_ns, joined_ticks
from pdr_est.io.tables.times.unset import unset_rows
from pdr_est.io.tables.words.folding import split_words
from pdr_est.io.text.loose_table import LooseTable

_FEWEST_KNOWN = 0.5
_RATE_HZ = (0.2, 5000.0)  # a stated unit outside of this contradicts the values
_FINEST_TICKS_PER_S = 10**12  # units of time have fewer; larger denominators come from binary rounding
_DIFFERENCES = frozenset({"delta", "dt", "diff", "difference", "interval", "deltat", "differenz"})
_LARGEST_SHARE_DOWN = 0.1
_NAMED_CELLS = 3


@dataclass(frozen=True)
class ClockCandidate:
    """A column read as times.

    Attributes
    ----------
    column
        The column.
    ticks
        (n,) exact values; only those that are known count.
    known
        (n,) False for rows without a time.
    unit
        Seconds in a tick, with the words how it was found.
    distinct
        Number of different stamps.
    before_1970_s
        Seconds from the beginning of the clock until 1970; None where it has no known date.
    is_local
        True when that is 1970 in a time zone that is not stated.
    has_date
        False for a time of day.
    left_out
        (n,) rows that the warning of the unit tells to be without a time.
    """

    column: ClockColumn
    ticks: NDArray[Any]
    known: NDArray[np.bool_]
    unit: Conversion
    distinct: int
    before_1970_s: float | None
    is_local: bool
    has_date: bool
    left_out: NDArray[np.bool_]

    @property
    def tick_s(self) -> Fraction:
        """Return the seconds in a tick: 1/1000 for ms, and not the binary number that is nearest to it."""
        return Fraction(self.unit.factor).limit_denominator(_FINEST_TICKS_PER_S) or Fraction(self.unit.factor)

    def exact_s(self, row: int) -> Fraction:
        """Return the time of a row, s since the beginning of the clock, without rounding."""
        tick = self.ticks[row]
        return Fraction(int(tick) if self.ticks.dtype.kind == "i" else float(tick)) * self.tick_s


def read_candidate(loose: LooseTable, column: ClockColumn, mapping: TableMapping) -> ClockCandidate | None:
    """Read one column as times.

    Parameters
    ----------
    loose
        Table with the column, and those of the sensors.
    column
        The column.
    mapping
        Meaning of all columns.

    Returns
    -------
    ClockCandidate or None
        None when the column has no times.
    """
    if column.parts:
        dates = read_date_parts(loose, column.parts)
        return None if dates is None else _of_dates(column, dates, shown_date_parts(loose, column.parts))
    if column.title not in loose.table:
        return None
    if column.title in loose.text_columns:
        return _date_candidate(loose, column)
    ticks = unwrap_counter(loose.table.columns[column.title])
    known = np.isfinite(ticks)
    unset = unset_rows(ticks, known)
    known &= ~unset
    if known.sum() < max(1.0, _FEWEST_KNOWN * len(ticks)):
        return None
    if holds_differences(column.title, ticks[known]):
        return None
    unit = _unit(column, ticks[known], loose, mapping)
    if column.fraction and column.fraction not in loose.text_columns:
        known &= np.isfinite(loose.table.numbers(column.fraction))
        if not known.any():
            return None
        ticks, unit = joined_ticks(loose, column, ticks, known)
    middle = ticks[known][int(known.sum()) // 2]  # the first ones may have been measured long before
    before_1970_s = seconds_before_1970(float(middle) * unit.factor, unit.factor)
    unit = replace(unit, warning="; ".join([*unit.warnings, *_told_unset(unset)]))
    is_local = unit.factor == DAY_S  # spreadsheets know no time zone
    return ClockCandidate(
        column, ticks, known, unit, _count_stamps(ticks[known]), before_1970_s, is_local, True, unset
    )


def holds_differences(title: str, ticks: NDArray[Any]) -> bool:
    """Tell whether a column holds the time since the row before: its title says so, and it often goes down."""
    down, up = int((ticks[1:] < ticks[:-1]).sum()), int((ticks[1:] > ticks[:-1]).sum())
    named = not _DIFFERENCES.isdisjoint(split_words(title))
    return named and up > 0 and down > _LARGEST_SHARE_DOWN * (up + down)


def _told_unset(unset: NDArray[np.bool_]) -> tuple[str, ...]:
    count = int(unset.sum())
    if not count:
        return ()
    named = ", ".join(f"row {i + 1}" for i in np.flatnonzero(unset)[:_NAMED_CELLS])
    return (f"rows left out because their time is 0, that is not set: {count} of {len(unset)} ({named})",)


def _count_stamps(ticks: NDArray[Any]) -> int:
    """Count the different stamps of a clock; one that comes back later counts again."""
    return int((ticks[1:] != ticks[:-1]).sum()) + 1


def _date_candidate(loose: LooseTable, column: ClockColumn) -> ClockCandidate | None:
    texts = loose.table.texts(column.title)
    if column.fraction and column.fraction in loose.text_columns:
        texts = np.array([f"{a} {b}".strip() for a, b in zip(texts, loose.table.texts(column.fraction), strict=True)])
    dates = parse_dates(texts)
    if dates is None or not dates.known.any():
        return None
    if column.fraction and column.fraction not in loose.text_columns:
        ns = np.where(dates.known, dates.ns + fraction_ns(loose.table.columns[column.fraction]), dates.ns)
        dates = replace(dates, ns=ns)
    return _of_dates(column, dates, texts)


def _of_dates(column: ClockColumn, dates: DateTimes, texts: NDArray[np.str_]) -> ClockCandidate:
    """Make a candidate of dates; the texts, from which they were read, are for the messages."""
    unit = _date_unit(dates, texts)
    wrong = ~dates.known & (texts != "")
    distinct, local = _count_stamps(dates.ns), not dates.has_zone
    return ClockCandidate(column, dates.ns, dates.known, unit, distinct, 0.0, local, dates.has_date, wrong)


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


def _unit(column: ClockColumn, ticks: NDArray[Any], loose: LooseTable, mapping: TableMapping) -> Conversion:
    """Take the unit that the title states, unless the rate of the rows contradicts it, else that of the values."""
    stated = Conversion(column.factor or 1.0, f"the unit of the clock is in the header: {column.title}")
    if column.factor is not None and mapping.given:
        return replace(stated, decision=f"the unit of the clock is that of the mapping: {column.title}")
    detected = detect_clock_unit(ticks, lambda: _motion(loose, mapping))
    if detected.warning:
        detected = replace(detected, warning=f"{detected.warning}; {unit_remedy(column)}")
    if column.factor is None:
        return detected
    step_s = step_of_rows(ticks) * column.factor
    plausible = step_s == 0.0 or _RATE_HZ[0] <= 1.0 / step_s <= _RATE_HZ[1]
    assumed = detected.factor == 1.0 and bool(detected.warning)
    agrees = detected.factor == column.factor and not assumed
    if agrees or (plausible and not is_impossible_rate(ticks, column.factor)):
        return stated
    if assumed or plausible:
        return replace(stated, warning=_doubt(column, ticks, step_s)) if mapping.has_motion else stated
    contradiction = f"the unit in the header ({column.title}) contradicts the values: {detected.decision}"
    return replace(detected, warning="; ".join([contradiction, *detected.warnings]))


def _doubt(column: ClockColumn, ticks: NDArray[Any], step_s: float) -> str:
    span_s = float(ticks[-1] - ticks[0]) * (column.factor or 1.0)
    return (
        f"the unit in the header ({column.title}) is doubtful: with it time spans {span_s:.4g} s for {len(ticks)} "
        f"rows, {1.0 / step_s:.4g} a second; {unit_remedy(column)}"
    )


def _motion(loose: LooseTable, mapping: TableMapping) -> Array:
    """Return the values of the first sensor with motion, (n, k)."""
    titles = next((mapping.columns[one].titles for one in MOTION if one in mapping.columns), ())
    return loose.table.stack([title for title in titles if title in loose.table])


def unit_remedy(column: ClockColumn) -> str:
    """Say how to state the unit of a clock."""
    return f"state the unit with --map (time: {{column: {column.title!r}, unit: ms}}, or s, us, 100ns, ns, min, h)"
