"""Causal filters whose output does not depend on how the signal is cut into blocks."""

import numpy as np

from pdr_est.errors import ConfigError
from pdr_est.frames import Array
from pdr_est.front_end.signal.butterworth import (
    frequency_response,
    high_pass_section,
    joined_sections,
    low_pass_sections,
)
from pdr_est.front_end.signal.recursion import RecursiveFilter

CADENCE_HZ = 1.8  # steps per second of a common walk
_LEAST_CUTOFF_HZ = 1e-3  # rounding spoils a low-pass far below it


class CausalFilter:
    """Causal filter of second-order sections whose state is carried from block to block.

    It starts in the steady state of its first sample.

    Parameters
    ----------
    sections : ndarray, shape (sections, 6)
        Second-order sections, as `butterworth` explains.
    rate_hz : float
        Sampling rate.

    Attributes
    ----------
    delay_s : float
        Phase delay at a common cadence: a peak found in the output of a walk is late by this much.
    """

    def __init__(self, sections: Array, rate_hz: float) -> None:
        self._recursion = RecursiveFilter(sections)
        self.delay_s = phase_delay_s(sections, rate_hz, CADENCE_HZ)

    def reset(self) -> None:
        """Forget the past, for a new segment."""
        self._recursion.reset()

    def push(self, samples: Array) -> Array:
        """Filter samples of shape (n,), or (n, k) column by column."""
        if not len(samples):
            return samples
        return self._recursion.push(samples.reshape(len(samples), -1)).reshape(samples.shape)


class CausalLowPass(CausalFilter):
    """Causal Butterworth low-pass filter of second order.

    Raises
    ------
    ConfigError
        If the cutoff is not below half of the sampling rate, or too low to be computed accurately.
    """

    def __init__(self, cutoff_hz: float, rate_hz: float) -> None:
        _check_cutoff("cutoff_hz", cutoff_hz, rate_hz)
        super().__init__(low_pass_sections(2, cutoff_hz, rate_hz), rate_hz)


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
        first_order, second_order = low_pass_sections(3, high_hz, rate_hz)
        # Two of first order in one section take half the time.
        joined = joined_sections(first_order, high_pass_section(low_hz, rate_hz))
        super().__init__(np.stack([second_order, joined]), rate_hz)


def _check_cutoff(name: str, cutoff_hz: float, rate_hz: float) -> None:
    if cutoff_hz >= 0.5 * rate_hz:
        raise ConfigError(f"{name} = {cutoff_hz:g} is not below half of resample.rate_hz = {rate_hz:g}: lower it")
    if cutoff_hz < _LEAST_CUTOFF_HZ:
        raise ConfigError(f"{name} = {cutoff_hz:g} is below {_LEAST_CUTOFF_HZ:g}: no movement is so slow: raise it")


def phase_delay_s(sections: Array, rate_hz: float, signal_hz: float) -> float:
    """Compute the delay, s, of a sine of `signal_hz` in second-order sections.

    The phase is followed from zero frequency, so that delays of more than a period are not wrapped.
    """
    frequencies_hz = np.linspace(0.0, signal_hz, 257)[1:]
    response = frequency_response(sections, frequencies_hz, rate_hz)
    return float(-np.unwrap(np.angle(response))[-1] / (2.0 * np.pi * signal_hz))
