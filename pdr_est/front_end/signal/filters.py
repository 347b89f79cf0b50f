"""Causal filters whose output does not depend on how the signal is cut into blocks."""

import numpy as np
from scipy.signal import butter, sosfilt, sosfilt_zi

from pdr_est.frames import Array


class CausalFilter:
    """Second-order sections with their state carried from block to block.

    It starts in the steady state of its first sample. delay_s is the group delay at `signal_hz`: by this much the
    time of a feature found in the output lies too late.
    """

    def __init__(self, sos: Array, rate_hz: float, signal_hz: float) -> None:
        self._sos = sos
        self._zi: Array | None = None
        self.delay_s = group_delay(sos, 2.0 * np.pi * signal_hz / rate_hz) / rate_hz

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


class CausalLowPass(CausalFilter):
    """Butterworth low-pass of second order; its delay is that of slow signals."""

    def __init__(self, cutoff_hz: float, rate_hz: float) -> None:
        super().__init__(butter(2, cutoff_hz, fs=rate_hz, output="sos"), rate_hz, signal_hz=0.0)


class CausalBandPass(CausalFilter):
    """First-order high-pass and third-order low-pass (Butterworth); its delay is that of a walk in the band."""

    def __init__(self, low_hz: float, high_hz: float, rate_hz: float) -> None:
        high_pass = butter(1, low_hz, btype="high", fs=rate_hz, output="sos")
        low_pass = butter(3, high_hz, fs=rate_hz, output="sos")
        super().__init__(np.concatenate([low_pass, high_pass]), rate_hz, signal_hz=0.85 * high_hz)


def group_delay(sos: Array, omega: float) -> float:
    """Group delay of second-order sections in samples at `omega` rad per sample."""
    powers = np.arange(3)
    waves = np.exp(-1j * omega * powers)
    numerator = (sos[:, :3] * waves @ powers) / (sos[:, :3] @ waves)
    denominator = (sos[:, 3:] * waves @ powers) / (sos[:, 3:] @ waves)
    return float(np.real(numerator - denominator).sum())
