"""Causal filters whose output does not depend on how the signal is cut into blocks."""

import numpy as np
from scipy.signal import butter, lfilter, lfilter_zi, sosfilt, sosfilt_zi, sosfreqz

from pdr_est.errors import ConfigError
from pdr_est.frames import Array

CADENCE_HZ = 1.8  # steps per second of a common walk
_LEAST_CUTOFF_HZ = 1e-3  # rounding spoils a low-pass far below it


class CausalFilter:
    """Causal filter of second-order sections whose state is carried from block to block.

    It starts in the steady state of its first sample.

    Parameters
    ----------
    sos : ndarray, shape (sections, 6)
        Second-order sections as scipy writes them.
    rate_hz : float
        Sampling rate.

    Attributes
    ----------
    delay_s : float
        Phase delay at a common cadence: a peak found in the output of a walk is late by this much.
    """

    def __init__(self, sos: Array, rate_hz: float) -> None:
        self._sos = sos
        self._zi: Array | None = None
        self.delay_s = phase_delay_s(sos, rate_hz, CADENCE_HZ)

    def reset(self) -> None:
        """Forget the past, for a new segment."""
        self._zi = None

    def push(self, samples: Array) -> Array:
        """Filter samples of shape (n,), or (n, k) column by column."""
        if not len(samples):
            return samples
        if self._zi is None:
            self._zi = np.multiply.outer(sosfilt_zi(self._sos), samples[0])
        filtered, self._zi = sosfilt(self._sos, samples, axis=0, zi=self._zi)
        output: Array = filtered
        return output


class CausalLowPass(CausalFilter):
    """Causal Butterworth low-pass filter of second order.

    Raises
    ------
    ConfigError
        If the cutoff is not below half of the sampling rate, or too low to be computed accurately.
    """

    def __init__(self, cutoff_hz: float, rate_hz: float) -> None:
        _check_cutoff("cutoff_hz", cutoff_hz, rate_hz)
        super().__init__(butter(2, cutoff_hz, fs=rate_hz, output="sos"), rate_hz)


class CausalBandPass(CausalFilter):
    """Causal band-pass filter: a first-order high-pass and a third-order low-pass (Butterworth).

    Raises
    ------
    ConfigError
        If the cutoffs are not in rising order, not below half of the sampling rate, or too low.
    """

    def __init__(self, low_hz: float, high_hz: float, rate_hz: float) -> None:
        _check_cutoff("low_hz", low_hz, rate_hz)
        _check_cutoff("high_hz", high_hz, rate_hz)
        if low_hz >= high_hz:
            raise ConfigError(f"low_hz = {low_hz:g} is not below high_hz = {high_hz:g}: swap them")
        high_pass = butter(1, low_hz, btype="high", fs=rate_hz, output="sos")
        low_pass = butter(3, high_hz, fs=rate_hz, output="sos")
        super().__init__(np.concatenate([low_pass, high_pass]), rate_hz)
        # Two direct forms cost a tenth of sosfilt for short blocks, and are as accurate at such low orders.
        self._stages = (butter(3, high_hz, fs=rate_hz), butter(1, low_hz, btype="high", fs=rate_hz))
        self._states: list[Array] | None = None

    def reset(self) -> None:
        """Forget the past, for a new segment."""
        self._states = None

    def push(self, samples: Array) -> Array:
        """Filter samples of shape (n,), or (n, k) column by column."""
        if not len(samples):
            return samples
        if self._states is None:
            (low_b, low_a), (high_b, high_a) = self._stages
            # The low-pass passes what is constant on as it is.
            self._states = [
                np.multiply.outer(lfilter_zi(low_b, low_a), samples[0]),
                np.multiply.outer(lfilter_zi(high_b, high_a), samples[0]),
            ]
        output = samples
        for number, (b, a) in enumerate(self._stages):
            output, self._states[number] = lfilter(b, a, output, axis=0, zi=self._states[number])
        return output


def _check_cutoff(name: str, cutoff_hz: float, rate_hz: float) -> None:
    if cutoff_hz >= 0.5 * rate_hz:
        raise ConfigError(f"{name} = {cutoff_hz:g} is not below half of resample.rate_hz = {rate_hz:g}: lower it")
    if cutoff_hz < _LEAST_CUTOFF_HZ:
        raise ConfigError(f"{name} = {cutoff_hz:g} is below {_LEAST_CUTOFF_HZ:g}: no movement is so slow: raise it")


def phase_delay_s(sos: Array, rate_hz: float, signal_hz: float) -> float:
    """Compute the delay, s, of a sine of `signal_hz` in second-order sections.

    The phase is followed from zero frequency, so that delays of more than a period are not wrapped.
    """
    frequencies = np.linspace(0.0, signal_hz, 257)[1:]
    _, response = sosfreqz(sos, worN=frequencies, fs=rate_hz)
    return float(-np.unwrap(np.angle(response))[-1] / (2.0 * np.pi * signal_hz))
