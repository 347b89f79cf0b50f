"""What two devices both have, in windows."""

import numpy as np
from numpy.typing import NDArray

from pdr_est.synchronise.common_signals import RATE_HZ, CommonSignals
from pdr_est.synchronise.line import SIGMA_SKEW, Line

_PEAK_S = 0.5  # half width of the peak of effort and turns over all shifts


def level_line(shift_s: float) -> Line:
    """What the first look knows: one shift, to the width of its peak."""
    return Line(0.0, shift_s, 0.0, np.diag([_PEAK_S**2, SIGMA_SKEW**2]), _PEAK_S, np.zeros(0, dtype=np.bool_))


def stretches(
    one: CommonSignals, two: CommonSignals, line: Line, window_s: float, reach_s: float, least_s: float
) -> list[NDArray[np.int64]]:
    """Samples of `one` that `two` has up to reach_s about, in windows of at least window_s if there is so much, and
    none of less than least_s."""
    there_s = one.time_s + line.value(one.time_s)
    both = np.flatnonzero((there_s >= two.time_s[0] + reach_s) & (there_s <= two.time_s[-1] - reach_s))
    windows = np.array_split(both, max(1, int(len(both) / (window_s * RATE_HZ))))
    return [rows for rows in windows if len(rows) >= least_s * RATE_HZ]
