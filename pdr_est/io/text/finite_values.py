"""Keep what is finite: signals without NaN, and numbers without values that no sensor can measure."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from pdr_est.errors import RecordingError
from pdr_est.frames import Array
from pdr_est.types.recording import Signal

_LARGEST = 1e30


def finite_signal(time_s: Array, values: Array, sensor: str, place: str) -> tuple[Signal, tuple[str, ...]]:
    """Make a signal of the rows that are finite in time and values.

    Parameters
    ----------
    time_s, values
        (n,) s and (n, k).
    sensor, place
        Name of the sensor and of the file, for messages.

    Returns
    -------
    Signal
        The finite rows.
    tuple of str
        A warning that counts the other rows, if there are any.

    Raises
    ------
    RecordingError
        When there are no rows or none is finite.
    """
    if len(time_s) == 0:
        raise RecordingError(f"{place}: {sensor} has no rows; record again with this sensor switched on")
    if _all_finite(time_s, values):
        return Signal(time_s, values), ()
    finite = np.isfinite(time_s) & np.isfinite(values).all(axis=1)
    dropped = len(finite) - int(finite.sum())
    if dropped == 0:
        return Signal(time_s, values), ()
    if dropped == len(finite):
        raise RecordingError(f"{place}: all {dropped} rows of {sensor} are NaN or infinite; record again")
    warning = f"{sensor}: {dropped} of {len(finite)} rows are left out: NaN or infinite values"
    return Signal(time_s[finite], values[finite]), (warning,)


def finite_signal_or_none(
    time_s: Array, values: Array, sensor: str, place: str
) -> tuple[Signal | None, tuple[str, ...]]:
    """Make a signal like `finite_signal`, but return None and a warning where there are no rows or none is finite.

    It is for sensors without which a track is still possible.
    """
    if not len(time_s):
        return None, (f"{sensor}: left out because it has no rows",)
    if _all_finite(time_s, values):
        return finite_signal(time_s, values, sensor, place)
    timed = np.isfinite(time_s)
    if not (timed & np.isfinite(values).all(axis=1)).any():
        reason = "contain NaN or infinite values" if timed.any() else "have no finite time"
        return None, (f"{sensor}: left out because all {len(time_s)} rows {reason}",)
    return finite_signal(time_s, values, sensor, place)


def discard_huge_values(values: NDArray[Any]) -> NDArray[Any]:
    """Replace infinity, and values so large that arithmetic would soon overflow, by NaN."""
    if values.dtype != np.float64:
        return values
    if len(values) and values.min() >= -_LARGEST and values.max() <= _LARGEST:
        return values
    return np.where(np.abs(values) <= _LARGEST, values, np.nan)


def _all_finite(time_s: Array, values: Array) -> bool:
    """Tell whether there are rows and all are finite; a sum tells it, much faster than to look at each."""
    return len(time_s) > 0 and bool(np.isfinite(time_s.sum()) and np.isfinite(values.sum()))
