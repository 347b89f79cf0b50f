"""Design of Butterworth filters as second-order sections, by the bilinear transform.

`scipy.signal` designs the same, for any order. It takes half a second to load, more than all the rest of a short
command.

A section is a row of six coefficients b0, b1, b2, 1, a1, a2: y[n] = b0 x[n] + b1 x[n-1] + b2 x[n-2] - a1 y[n-1]
- a2 y[n-2], for input x and output y.
"""

import numpy as np

from pdr_est.frames import Array


def low_pass_sections(order: int, cutoff_hz: float, rate_hz: float) -> Array:
    """Design a Butterworth low-pass filter.

    Parameters
    ----------
    order : int
        Order of the filter.
    cutoff_hz : float
        Frequency at which the gain is 1/sqrt(2), below half of the sampling rate.
    rate_hz : float
        Sampling rate.

    Returns
    -------
    ndarray, shape (sections, 6)
        The sections; for an odd order the first one is of first order.
    """
    k = np.tan(np.pi * cutoff_hz / rate_hz)
    first = [[k / (1.0 + k), k / (1.0 + k), 0.0, 1.0, (k - 1.0) / (k + 1.0), 0.0]] if order % 2 else []
    # The poles lie at equal angles on a half circle, in pairs about the real axis.
    dampings = [2.0 * np.cos(np.pi * pair / order) for pair in 0.5 * (order - 1) - np.arange(order // 2)]
    return np.array(first + [_second_order(k, damping) for damping in dampings])


def _second_order(k: float, damping: float) -> list[float]:
    scale = 1.0 + damping * k + k * k
    gain = k * k / scale
    return [gain, 2.0 * gain, gain, 1.0, 2.0 * (k * k - 1.0) / scale, (1.0 - damping * k + k * k) / scale]


def high_pass_section(cutoff_hz: float, rate_hz: float) -> Array:
    """Design a high-pass filter of first order, (6,); the arguments are those of `low_pass_sections`."""
    k = np.tan(np.pi * cutoff_hz / rate_hz)
    return np.array([1.0 / (1.0 + k), -1.0 / (1.0 + k), 0.0, 1.0, (k - 1.0) / (k + 1.0), 0.0])


def joined_sections(first: Array, second: Array) -> Array:
    """Join two sections of first order, (6,) each, to one of second order."""
    return np.concatenate([np.convolve(first[:2], second[:2]), np.convolve(first[3:5], second[3:5])])


def frequency_response(sections: Array, frequencies_hz: Array, rate_hz: float) -> Array:
    """Compute the complex response (n,) to sines of some frequencies (n,)."""
    delays = np.exp(-2j * np.pi * frequencies_hz / rate_hz)[:, None] ** np.arange(3)
    response: Array = np.prod((delays @ sections[:, :3].T) / (delays @ sections[:, 3:].T), axis=1)
    return response
