"""Read dates and times of which a column each holds the year, the month … the second and its fraction."""

import re
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pdr_est.io.tables.times.calendar import DAY_S, MISSING_NS, days_since_1970, over_midnight
from pdr_est.io.tables.times.dates import DateTimes
from pdr_est.io.tables.words.folding import split_words
from pdr_est.io.text.loose_table import LooseTable

_NAMES: Mapping[str, frozenset[str]] = {
    part: frozenset(names.split())
    for part, names in {
        "year": "year years yr yyyy jahr ano annee anno any 年",
        "month": "month months mon mo monat mes mois mese 月",
        "day": "day days dy dd tag dia jour giorno 日",
        "hour": "hour hours hr hrs h hh std stunde stunden hora horas heure heures ora ore 时 時 小时 小時",
        "minute": "minute minutes min mins mn mi minuto minutos minuten minuti 分 分钟 分鐘",
        "second": "second seconds sec secs s ss sekunde sekunden segundo segundos seconde secondes secondi 秒",
        "ms": "ms msec msecs milli millis millisecond milliseconds sss millisekunden milisegundos 毫秒 ミリ秒",
        "us": "us usec usecs micro micros microsecond microseconds mikrosekunden 微秒",
        "ns": "ns nsec nsecs nano nanos nanosecond nanoseconds nanosekunden 纳秒",
    }.items()
}
_DATE = ("year", "month", "day")
_TIME_OF_DAY = ("hour", "minute", "second")
_FRACTION_NS = {"ms": 10**6, "us": 10**3, "ns": 1}
_PREFIXES = frozenset(["time", "date", "datetime", "timestamp", "utc", "gps", "local", "t", "zeit", "datum"])
_BRACKETS = re.compile(r"[\[(（].*?[\])）]")


def find_date_parts(titles: Sequence[str]) -> Mapping[str, str]:
    """Find the columns that hold the parts of a date or a time of day.

    Parameters
    ----------
    titles
        Titles in the order of the file.

    Returns
    -------
    mapping of str to str
        Title of each part that is there: hour, minute and second, with year, month and day or without any of them,
        and with ms, us or ns if these stand beside whole seconds; empty when there is no time of day.
    """
    found: dict[str, str] = {}
    for title in titles:
        part = _part(title, found)
        if part is not None:
            found.setdefault(part, title)
    if not all(part in found for part in _TIME_OF_DAY):
        return {}
    date = _DATE if all(part in found for part in _DATE) else ()
    return {part: found[part] for part in (*date, *_TIME_OF_DAY, *(one for one in _FRACTION_NS if one in found))}


def read_date_parts(loose: LooseTable, parts: Mapping[str, str]) -> DateTimes | None:
    """Read the times of the rows from their parts; None where a part holds no numbers.

    Parameters
    ----------
    loose
        Table with the columns of the parts.
    parts
        Result of `find_date_parts`.
    """
    if any(title in loose.text_columns or title not in loose.table for title in parts.values()):
        return None
    values = {part: loose.table.numbers(title) for part, title in parts.items()}
    known = np.isfinite(np.stack(list(values.values()))).all(axis=0)
    if not known.any():
        return None
    second_ns = np.round(np.where(known, values["second"], 0.0) * 1e9).astype(np.int64)
    hour, minute = (_whole(values[part], known) for part in ("hour", "minute"))
    known &= (hour >= 0) & (hour < 24) & (minute >= 0) & (minute < 60) & (second_ns >= 0) & (second_ns < 61 * 10**9)
    of_day = (hour * 3600 + minute * 60) * 10**9 + second_ns
    whole = not (second_ns[known] % 10**9).any()
    for part, unit_ns in _FRACTION_NS.items() if whole else ():
        if part in values:
            of_day += np.round(np.where(known, values[part], 0.0) * unit_ns).astype(np.int64)
    if "year" not in values:
        return DateTimes(over_midnight(of_day, known), known, has_date=False, has_zone=False)
    days, valid = days_since_1970(*(_whole(values[part], known) for part in _DATE))
    known &= valid
    return DateTimes(np.where(known, days * (DAY_S * 10**9) + of_day, MISSING_NS), known, True, False)


def shown_date_parts(loose: LooseTable, parts: Mapping[str, str]) -> NDArray[np.str_]:
    """Write the parts (n,) side by side, for messages."""
    columns = [loose.table.columns[title] for title in parts.values()]
    return np.array([" ".join(map(str, row)) for row in zip(*columns, strict=True)])


def _part(title: str, found: Mapping[str, str]) -> str | None:
    """Tell which part of a date a title names; `mm` is the month before the hour, else the minute."""
    words = split_words(_BRACKETS.sub(" ", title))
    words = words[1:] if len(words) > 1 and words[0] in _PREFIXES else words
    name = "".join(words)
    if name == "mm":
        return "minute" if "hour" in found else "month"
    if name == "m":
        return "minute" if "hour" in found else None
    return next((part for part, names in _NAMES.items() if name in names), None)


def _whole(values: NDArray[Any], known: Any) -> NDArray[np.int64]:
    whole: NDArray[np.int64] = np.where(known, values, 0.0).astype(np.int64)
    return whole
