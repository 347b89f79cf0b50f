"""Find rows whose time was never set."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

_INNER_PERCENT = 5  # at either end, where other stamps may be wrong
_FAR = 10.0  # ours: times that begin at 0 are at most as far from it as they are apart


def unset_rows(ticks: NDArray[Any], known: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Find the rows (n,) whose time is 0 among times that are far from 0, such as Unix times.

    Parameters
    ----------
    ticks
        (n,) clock values.
    known
        (n,) False for rows without one.
    """
    none = np.zeros(len(ticks), dtype=np.bool_)
    zero = known & (ticks == 0)
    if not zero.any():
        return none
    others = ticks[known & ~zero]
    if len(others) <= len(ticks) // 2:
        return none
    low, middle, high = np.percentile(others, [_INNER_PERCENT, 50, 100 - _INNER_PERCENT])
    return zero if middle > _FAR * (high - low) else none
