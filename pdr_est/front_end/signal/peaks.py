"""Local extrema of a sampled signal."""

import numpy as np
from numpy.typing import NDArray

from pdr_est.frames import Array


def local_maxima(samples: Array) -> NDArray[np.bool_]:
    """Whether each sample is higher than the one before and not lower than the one after; the ends are not."""
    peaks = np.zeros(len(samples), dtype=np.bool_)
    peaks[1:-1] = (samples[1:-1] > samples[:-2]) & (samples[1:-1] >= samples[2:])
    return peaks


def local_minima(samples: Array) -> NDArray[np.bool_]:
    """Whether each sample is lower than the one before and not higher than the one after; the ends are not."""
    return local_maxima(-samples)
