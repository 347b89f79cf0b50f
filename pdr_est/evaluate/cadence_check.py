"""How many steps a walk must have had, by the spectrum of its signals: a check of counts where no step is annotated.

It knows of no detected step: a detector that takes two steps for one, or one for two, does not deceive it. It is a
plausibility and no truth: a walker who stands for part of a window, or changes the pace in it, costs a few percent.
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
"""Of the vertical acceleration about its mean in a window; below it nobody walks."""
CADENCES_HZ = (1.1, 3.7)
"""Steps a second, from a stroll to a sprint."""

_SPACING_HZ = 0.02  # a twelfth of a step in a window


@dataclass(frozen=True)
class Plausibility:
    """Steps in the windows that were walked. expected: by the spectrum. detected: those given."""

    expected: float
    detected: int

    @property
    def ratio(self) -> float:
        """`count_plausibility`: detected / expected; NaN when no window was walked."""
        return self.detected / self.expected if self.expected else float("nan")


def count_plausibility(level: Sequence[LevelBlock], steps_s: Array) -> Plausibility:
    """Steps at some times (n,) against the number that the spectrum of the same samples tells.

    Each segment is cut into windows of `WINDOW_S` from its start; a rest at its end that is shorter, and windows in
    which nobody walks (`LEAST_RMS_MPS2`), are left out with the steps in them. The expected number is the sum of
    `cadence_hz` times `WINDOW_S` over the others.
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
    """Steps a second in a window. vertical_mps2: (n,), rotation_rate_radps: (n, 3), at rate_hz.

    The body goes up and down once a step and turns to and fro once a stride. The cadence is therefore the frequency
    within `CADENCES_HZ` at which the power of the vertical acceleration, times the power of the rotation rate at half
    the frequency, is greatest. Either alone is mistaken at times: the leg that carries the phone shakes it harder
    than the other one does, and a belt turns with each step as well. Without rotation the acceleration alone tells.
    """
    # Padded with zeros so that bins are half a `_SPACING_HZ` apart: a cadence has an even bin and half of
    # the cadence has one as well.
    padded = round(2.0 * rate_hz / _SPACING_HZ)
    bin_hz = rate_hz / padded
    half = np.arange(round(0.5 * CADENCES_HZ[0] / bin_hz), round(0.5 * CADENCES_HZ[1] / bin_hz) + 1)
    power = _power(vertical_mps2[:, np.newaxis], padded)[2 * half]
    turning = _power(rotation_rate_radps, padded)[half]
    best = np.argmax(power * turning if turning.any() else power)
    return float(2 * half[best] * bin_hz)


def _power(signals: Array, padded: int) -> Array:
    """Power by bin of signals (n, k), all together, under a Hann window and padded to a length."""
    tapered = (signals - signals.mean(axis=0)) * np.hanning(len(signals))[:, np.newaxis]
    power: Array = (np.abs(np.fft.rfft(tapered, padded, axis=0)) ** 2).sum(axis=1)
    return power
