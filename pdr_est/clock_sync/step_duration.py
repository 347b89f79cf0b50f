"""Usual duration of a step in a window, from the step phasors of two devices.

A device on a leg feels the strikes of that leg more strongly, or hardly feels the others at all. Its signal repeats
with the stride, and an odd multiple of the stride frequency may be the strongest part of it.
"""

import numpy as np
from numpy.typing import NDArray

from pdr_est.clock_sync.common_signals import RATE_HZ, CommonSignals

_STEP_S = (0.35, 0.9)  # durations of a step, ours
_STRIDE_WEIGHT = 4.0  # relative to the step, which an uneven gait does not repeat; ours


def usual_step_samples(one: NDArray[np.complex128], two: NDArray[np.complex128]) -> int:
    """Find the usual duration of a step, in samples: after it and after twice it the signals repeat best.

    Parameters
    ----------
    one, two
        Step phasors (n,) of the two devices in one window.
    """
    first, last = round(_STEP_S[0] * RATE_HZ), round(_STEP_S[1] * RATE_HZ)
    size = 1 << (len(one) + 2 * last - 1).bit_length()
    repeats = np.zeros(2 * last + 1)
    for phasor in (one, two):
        power = np.abs(np.fft.fft(phasor, size)) ** 2
        repeats += np.fft.ifft(power)[: 2 * last + 1].real / max(float(power.mean()), 1e-12)
    steps = np.arange(first, last + 1)
    return int(steps[np.argmax(repeats[steps] + _STRIDE_WEIGHT * repeats[2 * steps])])


def step_samples_in_window(one: CommonSignals, two: CommonSignals, rows: NDArray[np.int64], shift_s: float) -> int:
    """Find the usual duration of a step, in samples, in a window of two devices whose clocks differ by `shift_s`."""
    there = np.interp(one.time_s[rows] + shift_s, two.time_s, two.step_phasor, left=0.0, right=0.0)
    return usual_step_samples(one.step_phasor[rows], there)
