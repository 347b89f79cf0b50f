"""Windows of samples in which the signals of two devices are compared, and the correlation at shifts of a window."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from pdr_est.clock_sync.common_signals import RATE_HZ, CommonSignals
from pdr_est.clock_sync.robust_line import ClockLine
from pdr_est.frames import Array


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


def window_correlations(values: NDArray[np.inexact], longer: NDArray[np.inexact]) -> Array:
    """Correlate a window of real or complex samples (n,) with every window (m - n + 1,) of a longer signal (m,).

    Returns
    -------
    Array
        Real parts of the correlation coefficients, (m - n + 1,).
    """
    size = len(values)
    centred = values - values.mean()
    windows = np.lib.stride_tricks.sliding_window_view(longer, size)
    deviation = np.sqrt(size * np.maximum(window_variances(np.asarray(longer), size), 1e-24))
    return np.asarray((windows @ np.conj(centred)).real / (deviation * max(float(np.linalg.norm(centred)), 1e-12)))


def correlation_log_likelihood_ratio(correlations: Array, most: float) -> Array:
    """Compute -log(1 - r^2), the log-likelihood ratio of two samples of Gaussian signals with correlation r.

    Parameters
    ----------
    correlations
        Correlations r, (n,); negative ones count as zero.
    most
        Largest correlation that is believed; greater ones count as this.
    """
    ratio: Array = -np.log1p(-(np.clip(correlations, 0.0, most) ** 2))
    return ratio


def window_variances(values: NDArray[Any], size: int) -> Array:
    """Compute the variance of every window of so many real or complex values, by running sums."""
    centred = values - values.mean()

    def window_means(of: NDArray[Any]) -> NDArray[Any]:
        sums = np.concatenate([np.zeros(1, dtype=of.dtype), np.cumsum(of)])
        return np.asarray((sums[size:] - sums[:-size]) / size)

    squares = window_means(np.abs(centred) ** 2)
    return np.asarray(np.maximum(squares - np.abs(window_means(centred)) ** 2, 0.0))
