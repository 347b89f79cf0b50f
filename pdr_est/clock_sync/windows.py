"""Windows of samples in which the signals of two devices are compared."""

import numpy as np
from numpy.typing import NDArray

from pdr_est.clock_sync.common_signals import RATE_HZ, CommonSignals
from pdr_est.clock_sync.robust_line import ClockLine


def comparison_windows(
    one: CommonSignals, two: CommonSignals, line: ClockLine, window_s: float, margin_s: float, min_length_s: float
) -> list[NDArray[np.int64]]:
    """Divide the time that both devices recorded into consecutive windows of about equal length.

    Parameters
    ----------
    one, two
        Signals of the reference device and of the other one.
    line
        Assumed difference of the clocks.
    window_s
        Least length of a window, s, unless less than that was recorded together.
    margin_s
        Time, s, that the other device must have recorded before and after every sample, for shifts to be tried.
    min_length_s
        Shorter windows, s, are left out.

    Returns
    -------
    list of (n,) arrays
        Sample indices into the signals of `one`.
    """
    there_s = one.time_s + line.difference_at(one.time_s)
    both = np.flatnonzero((there_s >= two.time_s[0] + margin_s) & (there_s <= two.time_s[-1] - margin_s))
    windows = np.array_split(both, max(1, int(len(both) / (window_s * RATE_HZ))))
    return [rows for rows in windows if len(rows) >= min_length_s * RATE_HZ]
