"""Causal filters whose output does not depend on how the signal is cut into blocks."""

import numpy as np
from scipy.signal import butter, sosfilt, sosfilt_zi

from pdr_est.frames import Array


class CausalLowPass:
    """Butterworth low-pass with its state carried from block to block.

    It starts in the steady state of its first sample. delay_s is the delay of slow signals (group delay at zero
    frequency), by which the time of a feature found in the output lies too late.
    """

    def __init__(self, cutoff_hz: float, rate_hz: float, order: int = 2) -> None:
        self._sos = butter(order, cutoff_hz, fs=rate_hz, output="sos")
        self._zi: Array | None = None
        self.delay_s = _delay_at_zero(self._sos) / rate_hz

    def reset(self) -> None:
        """Forget the past, for a new segment."""
        self._zi = None

    def push(self, samples: Array) -> Array:
        """Filter (n,) samples."""
        if not len(samples):
            return samples
        if self._zi is None:
            self._zi = sosfilt_zi(self._sos) * samples[0]
        filtered, self._zi = sosfilt(self._sos, samples, zi=self._zi)
        output: Array = filtered
        return output


def _delay_at_zero(sos: Array) -> float:
    """Group delay at zero frequency, in samples, of cascaded second-order sections."""
    powers = np.arange(3)
    numerator = sos[:, :3] @ powers / sos[:, :3].sum(axis=1)
    denominator = sos[:, 3:] @ powers / sos[:, 3:].sum(axis=1)
    return float((numerator - denominator).sum())
