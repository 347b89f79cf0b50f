"""Find out whether a clock jumps within a walk, by whether another shift fits some half minute far better."""

import numpy as np

from pdr_est.clock_sync.common_signals import INTENSITY_HZ, RATE_HZ, CommonSignals
from pdr_est.clock_sync.robust_line import ClockLine
from pdr_est.clock_sync.windows import (
    comparison_windows,
    correlation_log_likelihood_ratio,
    window_correlations,
)

# All ours.
_WINDOW_S, _LEAST_S = 30.0, 12.0  # length and least length of the windows
_REACH_S = 8.0  # longest jump that is searched; longer ones leave little of the walk that agrees
_STRIDE = 10  # samples from one compared value to the next: intensity and turns change slowly
_SAME_SHIFT_S = 0.4  # shifts that are closer are the same
_MOST_ALIKE = 0.98  # largest correlation of intensity or turns that is believed


def jump_log_likelihood_ratio(one: CommonSignals, two: CommonSignals, line: ClockLine) -> float:
    """Compute the log-likelihood ratio of another shift in the window of half a minute in which it fits best.

    Intensity and turns as Gaussian signals with correlation r have the log-likelihood ratio -n / 2 log(1 - r^2). The
    number n of independent samples of a window is twice the greatest frequency of the signals times its duration.

    Parameters
    ----------
    one, two
        Signals of the reference device and of the other one.
    line
        Difference of the clocks that was found.

    Returns
    -------
    float
        Greatest log-likelihood ratio, of all windows and shifts up to 8 s, against the shift of the line; at least 0.
    """
    reach, near = round(_REACH_S * RATE_HZ) // _STRIDE, round(_SAME_SHIFT_S * RATE_HZ) // _STRIDE
    kinds = [(one.log_intensity, two.log_intensity)]
    if one.turn_rate_radps is not None and two.turn_rate_radps is not None:
        kinds.append((one.turn_rate_radps, two.turn_rate_radps))
    greatest = 0.0
    for rows in comparison_windows(one, two, line, _WINDOW_S, 0.0, _LEAST_S):
        few = rows[::_STRIDE]
        start_s = one.time_s[few[0]] + line.difference_at(one.time_s[few[:1]])
        time_s = start_s + np.arange(-reach, len(few) + reach) * _STRIDE / RATE_HZ
        independent = 2.0 * INTENSITY_HZ * len(rows) / RATE_HZ
        fit = np.zeros(2 * reach + 1)
        for a, b in kinds:
            correlations = window_correlations(a[few], np.interp(time_s, two.time_s, b))
            fit += 0.5 * independent * correlation_log_likelihood_ratio(correlations, _MOST_ALIKE)
        greatest = max(greatest, float(fit.max() - fit[reach - near : reach + near + 1].max()))
    return greatest
