"""Count days from their year, month and day, and go on over midnight."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

DAY_S = 86400
"""Length of a day, s."""

MISSING_NS = np.iinfo(np.int64).min
"""Nanoseconds of a row without a time."""

_YEARS = (1970, 2200)
_CENTURY = 2000  # of years with two digits


def days_since_1970(
    year: NDArray[Any], month: NDArray[Any], day: NDArray[Any]
) -> tuple[NDArray[Any], NDArray[np.bool_]]:
    """Compute the days since 1970.

    Parameters
    ----------
    year, month, day
        (n,) int; a year with two digits is of this century.

    Returns
    -------
    days : (n,) int
    valid : (n,) bool
        False where the numbers are no date.
    """
    year = np.where(year < 100, year + _CENTURY, year)
    valid = (month >= 1) & (month <= 12) & (year >= _YEARS[0]) & (year < _YEARS[1])
    month_index = np.where(valid, (year - 1970) * 12 + month - 1, 0)
    first_days, next_days = (
        index.astype("datetime64[M]").astype("datetime64[D]").astype(np.int64)
        for index in (month_index, month_index + 1)
    )
    valid &= (day >= 1) & (day <= next_days - first_days)
    return first_days + np.where(valid, day - 1, 0), valid


def over_midnight(of_day_ns: NDArray[Any], known: NDArray[np.bool_], period_s: int = DAY_S) -> NDArray[Any]:
    """Add a day, or another period, wherever the time of day falls back by more than half of it.

    Parameters
    ----------
    of_day_ns
        (n,) ns since midnight.
    known
        (n,) False where there is no time; the result is `MISSING_NS` there.
    period_s
        Time after which the clock starts anew, s.
    """
    period_ns = period_s * 10**9
    index = np.flatnonzero(known)
    result = np.full(len(of_day_ns), MISSING_NS)
    if len(index):
        times = of_day_ns[index]
        turns = np.concatenate([[0], np.cumsum(np.diff(times) < -period_ns // 2)])
        result[index] = times + turns * period_ns
    return result


def past_twelve(times_ns: NDArray[Any], hour: NDArray[Any], known: NDArray[np.bool_]) -> NDArray[Any]:
    """Add 12 hours wherever a clock that counts to 12 without AM and PM goes on at 1.

    Parameters
    ----------
    times_ns
        (n,) times as written, ns.
    hour
        (n,) hours as written; unless all are 1 to 12 the clock is another one and the times stay.
    known
        (n,) False where there is no time.
    """
    index = np.flatnonzero(known)
    result = times_ns.copy()
    hours = hour[index]
    if len(index) and ((hours >= 1) & (hours <= 12)).all():
        falls = (hours[:-1] == 12) & (hours[1:] == 1) & (np.diff(times_ns[index]) < 0)
        result[index] += np.concatenate([[0], np.cumsum(falls)]) * (DAY_S // 2 * 10**9)
    return result
