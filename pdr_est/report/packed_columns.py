"""Columns of numbers in the data of a page: rounded, as few bytes as they need, in base 64.

The script `packed_columns.js` reads them. Written as digits, they would take twice the room and ten times the time.
"""

import base64

import numpy as np
from numpy.typing import ArrayLike

PackedColumn = dict[str, str | float | bool]

_INTEGERS = ("i1", "i2", "i4")


def pack_column(values: ArrayLike, step: float) -> PackedColumn:
    """Pack numbers, rounded to multiples of a step.

    Parameters
    ----------
    values
        (n,) numbers; those that are not finite become missing.
    step
        Resolution, in the unit of the values.

    Returns
    -------
    dict
        `type`, `step`, whether the numbers are `differences` to the one before, and the `data`. The least integer of
        the type stands for a missing number. Numbers that no integer can hold are written as they are, in `f8`.
    """
    numbers = np.asarray(values, dtype=np.float64)
    finite = np.isfinite(numbers)
    scaled = np.rint(np.where(finite, numbers, 0.0) / step)
    whole = _smallest_type(scaled)
    if whole is None:
        return _column(numbers.astype("<f8"), 1.0, False)
    changes = np.diff(scaled, prepend=0.0)
    short = _smallest_type(changes)
    if finite.all() and short is not None and short < whole:
        return _column(changes.astype("<" + short), step, True)
    packed = scaled.astype("<" + whole)
    packed[~finite] = np.iinfo(packed.dtype).min
    return _column(packed, step, False)


def pack_floats(values: ArrayLike) -> PackedColumn:
    """Pack numbers (n,) of very different sizes, such as variances, in single precision."""
    return _column(np.asarray(values, dtype="<f4"), 1.0, False)


def _smallest_type(scaled: np.ndarray) -> str | None:
    most = float(np.abs(scaled).max(initial=0.0))
    return next((name for name in _INTEGERS if most <= np.iinfo(name).max), None)


def _column(packed: np.ndarray, step: float, differences: bool) -> PackedColumn:
    data = base64.b64encode(packed.tobytes()).decode("ascii")
    return {"type": packed.dtype.str[1:], "step": step, "differences": differences, "data": data}
