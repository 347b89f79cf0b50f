"""Read the time column of a plain table: seconds, another unit, or dates with a time of day."""

import re
from dataclasses import dataclass
from datetime import datetime

import numpy as np
from numpy.typing import NDArray

from pdr_est.errors import RecordingError
from pdr_est.frames import Array
from pdr_est.io.conversion.units import Conversion, detect_clock_unit
from pdr_est.io.formats.plain_csv.header import QuantityColumns
from pdr_est.io.text.number_table import NumberTable

_DATE = re.compile(r"^\s*\d{4}-\d{2}-\d{2}[T ]\d{2}:\d{2}")
_DATE_TIME = re.compile(r"[1-9]\d{3}-\d{2}-\d{2}[T ]\d{2}:\d{2}(:\d{2}(\.\d+)?)?")
_ZONE = re.compile(r"\s*(Z|[+-]\d{2}:?\d{2})$")
_EARLIEST_UNIX_S = 9e8  # smaller clocks count from something else


@dataclass(frozen=True)
class TimeColumn:
    """Times of the rows of a table.

    Attributes
    ----------
    time_s
        (n,) s; NaN where a row has no time.
    epoch_s
        Unix time of time zero; None when unknown.
    conversion
        How the unit of the clock was found.
    """

    time_s: Array
    epoch_s: float | None
    conversion: Conversion


def is_date_with_time(cell: str) -> bool:
    """Tell whether a cell is a date with a time of day, such as 2025-02-25 11:02:09.387 or ISO 8601."""
    return _DATE.match(cell) is not None


def read_time_column(table: NumberTable, columns: QuantityColumns, dates: bool) -> TimeColumn:
    """Read the times of a table.

    The documented `time_s` is taken as it is; other clocks start at zero with the first row.

    Parameters
    ----------
    table
        Table with the time column.
    columns
        Meaning of the time column.
    dates
        True when the column has dates instead of numbers.

    Raises
    ------
    RecordingError
        When no row has a time, a cell is not a date with a time, or the time zone changes.
    """
    title = columns.titles[0]
    if columns.canonical:
        return TimeColumn(
            table.numbers(title), None, Conversion(1.0, "the clock counts seconds, by the documented header")
        )
    if dates:
        return _by_dates(table, title)
    ticks = table.columns[title][np.isfinite(table.columns[title])]
    if not len(ticks):
        raise RecordingError(f"{table.place}: no row has a time in column {title!r}; record again")
    if columns.factor is None:
        conversion = detect_clock_unit(ticks)
    else:
        conversion = Conversion(columns.factor, f"the unit of the clock is in the header: {title}")
    first_s, since_s = table.relative_time(title, 1.0 / conversion.factor)
    return TimeColumn(since_s, first_s if first_s > _EARLIEST_UNIX_S else None, conversion)


def _by_dates(table: NumberTable, title: str) -> TimeColumn:
    texts = np.char.strip(table.texts(title))
    zone = _ZONE.search(str(texts[0]))
    suffixes = {found.group() if (found := _ZONE.search(text)) else "" for text in texts if text}
    if len(suffixes) > 1:
        raise RecordingError(f"{table.place}, column {title!r}: the time zone changes; write all times in one zone")
    if zone is not None:
        texts = np.array([text.removesuffix(zone.group()) for text in texts])
    date_times = _parse_dates(texts, table.place, title)
    since_s = (date_times - date_times[0]) / np.timedelta64(1, "ns") / 1e9
    epoch_s = None if zone is None else _unix_s(f"{texts[0]}{zone.group()}", table.place, title)
    decision = f"the clock counts date and time{'' if zone else ' without a time zone: the Unix time is unknown'}"
    return TimeColumn(since_s, epoch_s, Conversion(1.0, decision))


def _unix_s(text: str, place: str, title: str) -> float:
    try:
        return datetime.fromisoformat(text).timestamp()
    except (ValueError, OverflowError) as error:
        raise RecordingError(
            f"{place}, column {title!r}: {text!r} is not a time with a time zone; correct it"
        ) from error


def _parse_dates(texts: NDArray[np.str_], place: str, title: str) -> NDArray[np.datetime64]:
    for number, text in enumerate(texts):
        if text and not _is_date_time(text):
            raise RecordingError(
                f"{place}, row {number + 1}, column {title!r}: {str(text)!r} is not a date with time; "
                "correct or remove this row"
            )
    return np.where(texts == "", "NaT", texts).astype("datetime64[ns]")


def _is_date_time(text: str) -> bool:
    if not _DATE_TIME.fullmatch(text):
        return False
    try:
        np.datetime64(text, "ns")
    except ValueError:
        return False
    return True
