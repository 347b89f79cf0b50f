"""Continue counters of fixed width, which start anew at zero when they are full."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

_WIDTHS_BITS = (16, 32)
_NEAR_END = 0.02  # share of the range within which the values before and after the overflow lie


def unwrap_counter(ticks: NDArray[Any]) -> NDArray[Any]:
    """Return ticks (n,) that go on rising where an unsigned counter of 16 or 32 bits overflowed.

    Other columns are returned as they are: values that are no integers, negative ones, and those that fall without
    coming from the end of such a range.
    """
    if ticks.dtype.kind != "i" or len(ticks) < 2 or int(ticks.min()) < 0:
        return ticks
    size = next((2**bits for bits in _WIDTHS_BITS if int(ticks.max()) < 2**bits), None)
    if size is None:
        return ticks
    before, after = ticks[:-1], ticks[1:]
    overflow = (before > (1.0 - _NEAR_END) * size) & (after < _NEAR_END * size)
    if not overflow.any():
        return ticks
    unwrapped: NDArray[Any] = ticks + size * np.concatenate([[0], np.cumsum(overflow)])
    return unwrapped
