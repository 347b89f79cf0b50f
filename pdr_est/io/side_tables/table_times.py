"""Read the times of a table of positions: numbers in seconds or in a unit of Unix time, or dates."""

import math
from collections.abc import Callable, Sequence

import numpy as np

from pdr_est.errors import RecordingError
from pdr_est.frames import Array
from pdr_est.io.tables.times.dates import parse_dates

LOCAL_TIME = "local_time_s"
"""Time by dates without a time zone, s since 1970."""

# Sizes of Unix time of our days in ms, µs and ns.
_UNIX_UNITS = ((1e17, 1e19, 1e-9), (1e14, 1e16, 1e-6), (1e11, 1e13, 1e-3))


def times_in_seconds(
    texts: Sequence[str], factor: float | None, decimal_comma: bool, place: Callable[[int], str]
) -> tuple[str, Array]:
    """Convert times to seconds: numbers in the unit of their title or of Unix time, or dates.

    Parameters
    ----------
    texts
        Cells (n,), without blanks around them.
    factor
        Length, s, of the unit that the title states; None where it states none.
    decimal_comma
        True when a comma is the decimal mark.
    place
        Makes the words for the place of a cell, from its number.

    Returns
    -------
    name : str
        `time_s`, or `LOCAL_TIME` for dates without a time zone.
    time_s : (n,)
        NaN for an empty cell.

    Raises
    ------
    RecordingError
        For a cell that is neither a number nor a date, and for numbers among dates.
    """
    numbers = [_number(text, decimal_comma) for text in texts]
    if any(number is None for number in numbers):
        return _date_times(texts, numbers, place)
    times = np.array(numbers, dtype=np.float64)
    return "time_s", times * (seconds_in_unit(times) if factor is None else factor)


def seconds_in_unit(times: Array) -> float:
    """Find the unit of times (n,), s: 1, or that of Unix time in ms, µs or ns, which their size shows."""
    finite = np.abs(times[np.isfinite(times)])
    middle = float(np.median(finite)) if len(finite) else 0.0
    return next((unit for low, high, unit in _UNIX_UNITS if low < middle < high), 1.0)


def _number(text: str, decimal_comma: bool) -> float | None:
    """Return the number that a cell holds, NaN for an empty one; None for other text."""
    try:
        return float(text.replace(",", ".") if decimal_comma else text) if text else math.nan
    except ValueError:
        return None


def _date_times(
    texts: Sequence[str], numbers: Sequence[float | None], place: Callable[[int], str]
) -> tuple[str, Array]:
    """Read dates, all of which state a time zone or none does; see `times_in_seconds`."""
    is_text = [number is None for number in numbers]
    dates = parse_dates(np.array([text if is_date else "" for text, is_date in zip(texts, is_text, strict=True)]))
    read = dates is not None and dates.has_date
    for row, text in enumerate(texts):
        where = f"{place(row)}: {text!r}"
        if is_text[row] and not (read and dates is not None and dates.known[row]):
            raise RecordingError(
                f"{where} is neither a number nor a date such as 2024-06-10T14:03:05Z; correct or remove it"
            )
        if text and not is_text[row]:
            raise RecordingError(f"{where} is a number among dates; write all times in one form")
    if dates is None:
        return "time_s", np.array(numbers, dtype=np.float64)
    return "time_s" if dates.has_zone else LOCAL_TIME, np.where(dates.known, dates.ns / 1e9, math.nan)
