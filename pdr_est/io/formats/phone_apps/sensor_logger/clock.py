"""Find when a Sensor Logger recording began, and how its position fixes relate to its motion sensors in time.

iPhones have exported motion time stamps that are hours late, because they were counted from a boot time that does not
include the phone's sleep, beside location time stamps that are right.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pdr_est.errors import RecordingError
from pdr_est.frames import Array
from pdr_est.io.text.number_table import NumberTable

_TICKS_PER_S = 10**9
_LARGEST_SHIFT_S = 60.0  # a cached fix may be older than the recording, but the streams never lie further apart
_TIMEZONE_STEP_S = 900.0
_LARGEST_TIMEZONE_S = 14 * 3600.0
_LOCAL_TIME = re.compile(r"(\d{4})-(\d{2})-(\d{2})_(\d{2})-(\d{2})-(\d{2})$")


@dataclass(frozen=True)
class FixTimes:
    """Times of the position fixes on the clock of the recording.

    Attributes
    ----------
    time_s
        (n,) s since time zero of the recording.
    epoch_s
        Unix time of time zero.
    warning
        How the two clocks were aligned; "" where they agreed.
    """

    time_s: Array
    epoch_s: float
    warning: str = ""


def seconds_since(table: NumberTable, zero_ns: int) -> Array:
    """Convert the time column of a table to seconds since a Unix time in ns; integers are subtracted before rounding.

    Raises
    ------
    RecordingError
        When the table has no time column.
    """
    if "time" not in table:
        raise RecordingError(f"{table.place}: no column 'time'; export the recording again")
    ticks: NDArray[Any] = table.columns["time"]
    since: Array = (ticks - zero_ns).astype(np.float64) / _TICKS_PER_S
    return since


def align_fix_times(location: NumberTable, zero_ns: int, end_s: float, metadata: Mapping[str, str]) -> FixTimes:
    """Convert the times of the location rows to the clock of the motion sensors.

    Parameters
    ----------
    location
        Table of the positions.
    zero_ns
        Unix time, ns, of the first motion sample.
    end_s
        Time of the last motion sample, s after the first.
    metadata
        Metadata of the export.
    """
    own_s = seconds_since(location, zero_ns)
    epoch_s = zero_ns / _TICKS_PER_S
    if _overlap(own_s, end_s):
        return FixTimes(own_s, epoch_s)
    last_s = float(np.nanmax(own_s))
    if "seconds_elapsed" in location:
        elapsed_s = location.numbers("seconds_elapsed")
        if _overlap(elapsed_s, end_s):
            shift_s = float(np.nanmedian(own_s - elapsed_s))
            return FixTimes(elapsed_s, epoch_s + shift_s, _alignment_warning(shift_s, "seconds_elapsed"))
    start_s = _start_by_metadata(metadata, epoch_s + last_s - end_s)
    if start_s is not None:
        shift_s = start_s - epoch_s
        return FixTimes(
            own_s - shift_s, start_s, _alignment_warning(shift_s, "the metadata's recording time, accurate to 1 s")
        )
    shift_s = last_s - end_s
    method = "putting the last fix at the end of the motion data, accurate to a few seconds"
    return FixTimes(own_s - shift_s, epoch_s + shift_s, _alignment_warning(shift_s, method))


def _alignment_warning(shift_s: float, method: str) -> str:
    side = "behind" if shift_s > 0.0 else "ahead of"
    return (
        f"motion time stamps are {abs(shift_s):.1f} s {side} those of the location (stale clock); aligned by {method}"
    )


def _overlap(time_s: Array, end_s: float) -> bool:
    finite = time_s[np.isfinite(time_s)]
    return len(finite) == 0 or (finite.min() < end_s + _LARGEST_SHIFT_S and finite.max() > -_LARGEST_SHIFT_S)


def _start_by_metadata(metadata: Mapping[str, str], start_about_s: float) -> float | None:
    """Find the Unix time of the start in the metadata, checked against the start that the fixes suggest."""
    epoch_ms = metadata.get("recording epoch time", "")
    if epoch_ms.isdigit() and abs(int(epoch_ms) / 1e3 - start_about_s) < _TIMEZONE_STEP_S / 2:
        return int(epoch_ms) / 1e3
    match = _LOCAL_TIME.match(metadata.get("recording time", ""))
    if match is None:
        return None
    year, month, *rest = (int(part) for part in match.groups())
    for candidate in (month + 1, month):  # schema 2 counts months from zero
        local_s = _as_unix_s(year, candidate, *rest)
        if local_s is None or abs(local_s - start_about_s) > _LARGEST_TIMEZONE_S:
            continue
        timezone_s = round((local_s - start_about_s) / _TIMEZONE_STEP_S) * _TIMEZONE_STEP_S
        return local_s - timezone_s + 0.5  # the metadata leave out the fraction of the second
    return None


def _as_unix_s(year: int, month: int, day: int, hour: int, minute: int, second: int) -> float | None:
    try:
        return datetime(year, month, day, hour, minute, second, tzinfo=UTC).timestamp()
    except ValueError:
        return None
