"""Read dates and times of day in the forms that recorders write.

Understood are dates with year, month and day in any order (`2031-02-03 04:05:06.789`, `2031/02/03T04:05:06Z`,
`03-Feb-2031 4:05:06`, `03.02.2031 04:05:06,789`, `20310203_040506_789`, `Mon Feb 03 04:05:06 2031`,
`3. Februar 2031 04:05:06`, `2031年2月3日 4时05分06秒`) and times of day alone, which start anew at midnight.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
import polars as pl
from numpy.typing import NDArray

from pdr_est.io.tables.times.calendar import DAY_S, MISSING_NS, days_since_1970, over_midnight, past_twelve
from pdr_est.io.tables.times.fractions import read_fractions
from pdr_est.io.tables.times.scripts import with_usual_marks

KNOWN_FORMS = "2031-02-03 04:05:06.789, 2031/02/03 04:05:06, 03.02.2031 04:05:06, 03-Feb-2031 04:05:06, 04:05:06.789"

_TIME = (
    r"(?P<hour>\d{1,2})[:.hH-](?P<minute>\d{1,2})(?:[:.mM-](?P<second>\d{1,2})(?:(?P<mark>[.,:_-])(?P<fraction>\d{1,9})\d*)?)?"
    r"\s*(?P<half>[AaPp])?(?:\.?[Mm]\.?)?"
)
_ZONE = r"\s*(?P<zone>Z|UTC|GMT|(?:UTC|GMT)?[+-]\d{2}:?\d{2})?"
_DATE_FIRST = (
    r"^(?P<a>\d{1,4})(?P<between>[-/.])(?P<b>\d{1,2}|[^\W\d_]{3,9})\.?[-/.](?P<c>\d{1,4})"
    rf"[ T_,-]+{_TIME}{_ZONE}$"
)
_COMPACT = (
    r"^(?P<a>\d{4})(?P<b>\d{2})(?P<c>\d{2})[ T_-]?(?P<hour>\d{2})(?P<minute>\d{2})(?P<second>\d{2})"
    rf"(?:(?P<mark>[._:,-]?)(?P<fraction>\d{{1,9}}))?{_ZONE}$"
)
_NAMED_DAY = (
    r"^[A-Z][a-z]{2},? (?P<b>[A-Z][a-z]{2}) +(?P<a>\d{1,2}),? (?P<hour>\d{1,2}):(?P<minute>\d{2}):(?P<second>\d{2})"
    r"(?:(?P<mark>[.,])(?P<fraction>\d{1,9}))? (?:[A-Z]{3,4})?(?P<zone>[+-]\d{2}:?\d{2})? ?(?P<c>\d{4})$"
)
_DAY_IN_WORDS = (
    r"^(?P<a>\d{1,2})\.? (?:de )?(?P<b>[^\W\d_]{3,9})\.?,? (?:de )?(?P<c>\d{4}),? (?:at |um |à )?"
    rf"{_TIME}{_ZONE}$"
)
_MONTH_IN_WORDS = rf"^(?P<b>[^\W\d_]{{3,9}})\.? (?P<a>\d{{1,2}}),? (?P<c>\d{{4}}),? (?:at )?{_TIME}{_ZONE}$"
_TIME_OF_DAY = rf"^{_TIME}{_ZONE}$"
_MINUTES = r"^(?P<minute>\d{1,3}):(?P<second>\d{2})(?P<mark>[.,])(?P<fraction>\d{1,9})$"
_FORMS = (_DATE_FIRST, _COMPACT, _NAMED_DAY, _DAY_IN_WORDS, _MONTH_IN_WORDS, _MINUTES, _TIME_OF_DAY)
_MONTHS = {
    name: number
    for number, names in enumerate(
        (
            "jan ene gen january janv",
            "feb fev fév february fevr févr",
            "mar mrz mär mars",
            "apr abr avr",
            "may mai mag",
            "jun juin giu",
            "jul juil lug",
            "aug ago aou aoû",
            "sep set",
            "oct okt ott",
            "nov",
            "dec dez dic déc",
        ),
        start=1,
    )
    for name in names.split()
}
_SMALLEST_SHARE = 0.9


@dataclass(frozen=True)
class DateTimes:
    """Times that were read from texts.

    Attributes
    ----------
    ns
        (n,) int64 nanoseconds since 1970, or since midnight of the first row for times of day.
    known
        (n,) False for the cells that are no date or time.
    has_date
        True for dates, False for times of day.
    has_zone
        True when the texts state their time zone, so that `ns` is Unix time; texts without one are then not known.
    order
        "day" or "month" if that was taken to come first although the numbers leave it open; "" if they do not.
    counted
        "ms", "us" or "ns" where the digits behind the seconds count these without zeros in front; "" for decimals.
    """

    ns: NDArray[np.int64]
    known: NDArray[np.bool_]
    has_date: bool
    has_zone: bool
    order: str = ""
    counted: str = ""


def parse_dates(texts: NDArray[np.str_]) -> DateTimes | None:
    """Read a column of dates or times of day; None when fewer than 90 % of its cells that are not empty are any."""
    column = pl.Series("t", [str(text).strip() for text in texts], dtype=pl.String)
    column = with_usual_marks(column)
    present = int((column != "").sum())
    for form in _FORMS:
        groups = column.str.extract_groups(form).struct.unnest()
        matched = int(groups["minute"].is_not_null().sum())
        if present and matched >= _SMALLEST_SHARE * present:
            return _from_groups(groups)
    return None


def _from_groups(groups: pl.DataFrame) -> DateTimes:
    hour, second = _integers(groups, "hour"), _integers(groups, "second")
    if "half" in groups.columns:
        half = groups["half"].str.to_lowercase()
        hour = np.where((half == "p").fill_null(False).to_numpy() & (hour < 12), hour + 12, hour)
        hour = np.where((half == "a").fill_null(False).to_numpy() & (hour == 12), 0, hour)
    minute = _integers(groups, "minute")
    known = groups["minute"].is_not_null().to_numpy() & (hour < 24) & (second < 61)
    seconds = hour * 3600 + minute * 60 + second
    fractions = read_fractions(groups["fraction"], seconds, known)
    of_day, counted = seconds * 10**9 + fractions.ns, fractions.counted
    if "a" not in groups.columns:
        known &= (minute < 60) | ("hour" not in groups.columns)
        period_s = DAY_S if "hour" in groups.columns else 3600
        ns = over_midnight(of_day, known, period_s)
        if not _has_halves(groups):
            ns = past_twelve(ns, hour, known)
        return DateTimes(ns, known, has_date=False, has_zone=False, counted=counted)
    days, valid, order = _days(groups)
    zones = groups["zone"] if "zone" in groups.columns else pl.Series([None] * len(groups), dtype=pl.String)
    known &= valid & (minute < 60)
    zoned = known & zones.is_not_null().to_numpy()
    has_zone = bool(zoned.any())
    known = zoned if has_zone else known
    ns = days * (DAY_S * 10**9) + of_day - (_zone_s(zones) * 10**9 if has_zone else 0)
    ns = ns if _has_halves(groups) else past_twelve(ns, hour, known)
    return DateTimes(np.where(known, ns, MISSING_NS), known, True, has_zone, order, counted)


def _has_halves(groups: pl.DataFrame) -> bool:
    """Tell whether the times have AM or PM."""
    return "half" in groups.columns and bool(groups["half"].is_not_null().any())


def _integers(groups: pl.DataFrame, name: str) -> NDArray[Any]:
    if name not in groups.columns:
        return np.zeros(len(groups), dtype=np.int64)
    return groups[name].cast(pl.Int64, strict=False).fill_null(0).to_numpy()


def _days(groups: pl.DataFrame) -> tuple[NDArray[Any], NDArray[np.bool_], str]:
    """Compute the days since 1970 from three numbers, one of which may be the name of a month.

    Returns
    -------
    days : (n,) int
    valid : (n,) bool
        False where the numbers are no date.
    order : str
        As in `DateTimes`.
    """
    first, third = _integers(groups, "a"), _integers(groups, "c")
    names = groups["b"].fill_null("0")
    named = names.str.contains(r"^[^\d]").any()
    if named:
        prefix = names.str.to_lowercase()
        months = prefix.str.slice(0, 4).replace_strict(_MONTHS, default=None, return_dtype=pl.Int64)
        short = prefix.str.slice(0, 3).replace_strict(_MONTHS, default=None, return_dtype=pl.Int64)
        second = months.fill_null(short).fill_null(0).to_numpy()
    else:
        second = _integers(groups, "b")
    order = ""
    if (first > 31).any():
        year, month, day = first, second, third
    elif (not named and (second > 12).any()) or (not named and _has_halves(groups) and not (first > 12).any()):
        year, month, day = third, first, second
        order = "month" if _is_open(groups, first, second) else ""
    else:
        year, month, day = third, second, first
        order = "day" if not named and _is_open(groups, first, second) else ""
    return *days_since_1970(year, month, day), order


def _is_open(groups: pl.DataFrame, first: NDArray[Any], second: NDArray[Any]) -> bool:
    """Tell whether each of two numbers may be the month; with points between them the day comes first everywhere."""
    points = groups["between"].drop_nulls().eq(".").all() if "between" in groups.columns else False
    return not points and not ((first > 12) | (second > 12)).any() and bool((first != second).any())


def _zone_s(zones: pl.Series) -> NDArray[Any]:
    """Compute the offsets from UTC, s."""
    digits = (
        zones.fill_null("Z").str.extract_groups(r"(?P<sign>[+-])(?P<hours>\d{2}):?(?P<minutes>\d{2})").struct.unnest()
    )
    seconds = _integers(digits, "hours") * 3600 + _integers(digits, "minutes") * 60
    negative = (digits["sign"] == "-").fill_null(False).to_numpy()
    offsets: NDArray[Any] = np.where(negative, -seconds, seconds)
    return offsets
