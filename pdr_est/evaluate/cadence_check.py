"""Plausibility of step counts where no step is annotated: the number of steps from the spectrum of the signals.

The number is independent of the detected steps, so it shows a detector that takes two steps for one, or one for two.
It is no ground truth: a walker who stands for part of a window, or changes the pace in it, costs a few percent.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby

import numpy as np

from pdr_est.frames import Array
from pdr_est.front_end.signal.blocks import join
from pdr_est.types.sensors import LevelBlock

PLAUSIBILITY_METRIC = "count_plausibility"
WINDOW_S = 4.0
LEAST_RMS_MPS2 = 0.5
"""RMS of the vertical acceleration about its mean in a window, below which nobody walks."""
CADENCES_HZ = (1.1, 3.7)
"""Steps per second, from a stroll to a sprint."""

_SPACING_HZ = 0.02  # a twelfth of a step in a window
_LEAST_TURNING_RADPS = 1e-6  # ours: far below a gyroscope's resolution of 1e-4, far above rounding


@dataclass(frozen=True)
class Plausibility:
    """Steps in the windows in which somebody walks.

    Attributes
    ----------
    expected : float
        Number of steps from the spectrum.
    detected : int
        Number of detected steps.
    """

    expected: float
    detected: int

    @property
    def ratio(self) -> float:
        """Metric `count_plausibility`: detected / expected; NaN if nobody walks in any window."""
        return self.detected / self.expected if self.expected else float("nan")


def count_plausibility(level: Sequence[LevelBlock], steps_s: Array) -> Plausibility:
    """Compare detected steps with the number of steps from the spectrum of the same samples.

    Each segment is cut into windows of `WINDOW_S` from its start; a shorter rest at its end, and windows in which
    nobody walks (`LEAST_RMS_MPS2`), are left out with the steps in them. The expected number is the sum of
    `cadence_hz` times `WINDOW_S` over the others.

    Parameters
    ----------
    level : sequence of LevelBlock
        Leveled samples of a walk.
    steps_s : ndarray
        Times (n,) of the detected steps, s.
    """
    expected, detected = 0.0, 0
    for _, blocks in groupby(level, key=lambda block: block.segment):
        samples = join(list(blocks))
        if len(samples) < 2:
            continue
        rate_hz = (len(samples) - 1) / float(samples.time_s[-1] - samples.time_s[0])
        width = round(WINDOW_S * rate_hz)
        for first in range(0, len(samples) - width + 1, width):
            window = slice(first, first + width)
            vertical = samples.vertical_mps2[window]
            if vertical.std() < LEAST_RMS_MPS2:
                continue
            start_s = samples.time_s[first]
            detected += int(((steps_s >= start_s) & (steps_s < start_s + WINDOW_S)).sum())
            expected += WINDOW_S * cadence_hz(vertical, samples.rotation_rate_radps[window], rate_hz)
    return Plausibility(expected, detected)


def cadence_hz(vertical_mps2: Array, rotation_rate_radps: Array, rate_hz: float) -> float:
    """Estimate the steps per second in a window.

    The body moves up and down once per step and turns left and right once per stride. The cadence is therefore the
    frequency within `CADENCES_HZ` that maximises the power of the vertical acceleration times the power of the
    rotation rate at half the frequency. One of the two alone is sometimes wrong: the leg that carries the phone
    shakes it harder than the other one does, and a belt turns with each step as well. Without rotation the
    acceleration alone is used.

    Parameters
    ----------
    vertical_mps2 : ndarray
        Vertical acceleration (n,), m/s².
    rotation_rate_radps : ndarray
        Rotation rate (n, 3), rad/s.
    rate_hz : float
        Sampling rate, Hz.
    """
    # Zero padding makes the bins half of `_SPACING_HZ` wide: a cadence has an even bin, and half of it also has one.
    padded = round(2.0 * rate_hz / _SPACING_HZ)
    bin_hz = rate_hz / padded
    half = np.arange(round(0.5 * CADENCES_HZ[0] / bin_hz), round(0.5 * CADENCES_HZ[1] / bin_hz) + 1)
    power = _power(vertical_mps2[:, np.newaxis], padded)[2 * half]
    turns = rotation_rate_radps.std(axis=0).max() > _LEAST_TURNING_RADPS
    best = np.argmax(power * _power(rotation_rate_radps, padded)[half] if turns else power)
    return float(2 * half[best] * bin_hz)


def _power(signals: Array, padded: int) -> Array:
    """Sum the power spectra of signals (n, k) under a Hann window, padded to a length."""
    tapered = (signals - signals.mean(axis=0)) * np.hanning(len(signals))[:, np.newaxis]
    power: Array = (np.abs(np.fft.rfft(tapered, padded, axis=0)) ** 2).sum(axis=1)
    return power
