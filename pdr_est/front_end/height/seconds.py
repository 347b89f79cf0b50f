"""Air pressure to heights, one for each second."""

from typing import NamedTuple

import numpy as np

from pdr_est.frames import Array
from pdr_est.front_end.signal.barometric_height import height_by_pressure
from pdr_est.types.recording import Signal

NOISE_FROM_DIFFERENCES = 1.4826 / 6.0**0.5
"""Standard deviation of white noise over the median absolute second difference."""


class Second(NamedTuple):
    """Measurements of one second.

    Attributes
    ----------
    height_m
        Mean height by the air pressure, from an arbitrary level, m; NaN without samples.
    steps
        Number of steps; None where they are not known.
    """

    height_m: float
    steps: int | None


def seconds_of(pressure: Signal, step_time_s: Array | None) -> tuple[int, list[Second]]:
    """Average the heights of each second.

    Parameters
    ----------
    pressure
        (m, 1) air pressure, Pa.
    step_time_s
        (k,) times of the steps, s; None where they are not known.

    Returns
    -------
    first : int
        Begin of the first second, s.
    seconds : list of Second
        One for each second up to the last sample; empty without a usable sample.
    """
    time_s, values = pressure.time_s, pressure.values[:, 0]
    usable = np.isfinite(time_s) & np.isfinite(values) & (values > 0.0)
    if not usable.any():
        return 0, []
    number = np.floor(time_s[usable]).astype(np.int64)
    first, count = int(number.min()), int(number.max() - number.min()) + 1
    samples = np.bincount(number - first, minlength=count)
    total = np.bincount(number - first, weights=height_by_pressure(values[usable]), minlength=count)
    height_m = np.where(samples > 0, total / np.maximum(samples, 1), np.nan)
    if step_time_s is None:
        return first, [Second(height, None) for height in height_m.tolist()]
    within = np.floor(step_time_s).astype(np.int64) - first
    steps = np.bincount(within[(within >= 0) & (within < count)], minlength=count)
    return first, [Second(height, stepped) for height, stepped in zip(height_m.tolist(), steps.tolist(), strict=True)]


def noise_of(height_m: Array, least_m: float) -> float:
    """Return the standard deviation of the noise of heights second by second, m, from their second differences.

    The median makes it that of the quiet majority of the seconds: moves, jumps and wild values do not count.
    """
    curvature = np.abs(np.diff(height_m, n=2))
    known = curvature[np.isfinite(curvature)]
    return max(least_m, float(np.median(known)) * NOISE_FROM_DIFFERENCES) if len(known) else least_m
