"""Estimate the period of a stride from the autocorrelation of the recent signal.

A phone at a leg feels its own foot's strike and the other foot's differently, so that its signal repeats after a
stride, two steps, and only roughly after one. Not from a paper; all values are ours.
"""

import numpy as np

from pdr_est.errors import ConfigError
from pdr_est.frames import Array
from pdr_est.params import Fraction, Positive, params


@params
class StridePeriodParams:
    """Parameters of the search; the times rise from shortest_s over longest_s and least_s to memory_s."""

    memory_s: Positive = 6.0
    """Length of the signal that is correlated with itself, s."""
    least_s: Positive = 3.5
    """Least length of the signal, s, for an estimate."""
    shortest_s: Positive = 0.65
    """Shortest stride that is looked for, s."""
    longest_s: Positive = 2.4
    """Longest stride that is looked for, s."""
    least_agreement: Fraction = 0.4
    """Least correlation at the period of the stride."""
    first_share: Fraction = 0.8
    """Share of the highest peak's correlation: the first peak that has it is the stride, later ones are several
    strides.
    """


class StridePeriod:
    """Recent samples of one segment, and the period of the strides in them.

    Parameters
    ----------
    rate_hz : float
        Sampling rate.
    parameters : StridePeriodParams
        Lengths and thresholds.

    Raises
    ------
    ConfigError
        If the times of the parameters are not in rising order.
    """

    def __init__(self, rate_hz: float, parameters: StridePeriodParams) -> None:
        p = parameters
        if not p.shortest_s < p.longest_s < p.least_s <= p.memory_s:
            raise ConfigError(
                f"stride: shortest_s {p.shortest_s:g}, longest_s {p.longest_s:g}, least_s {p.least_s:g} and memory_s "
                f"{p.memory_s:g} do not rise: give them in that order"
            )
        self._rate_hz = rate_hz
        self._parameters = parameters
        self._signal: Array = np.empty(0)

    def clear(self) -> None:
        """Forget all samples, for a new segment."""
        self._signal = np.empty(0)

    def append(self, signal: Array, pending: int) -> None:
        """Add samples.

        Parameters
        ----------
        signal : ndarray, shape (n,)
            Signal with one peak per step.
        pending : int
            Number of the latest samples, these included, at which `ending_at` may still be called.
        """
        kept = round(self._parameters.memory_s * self._rate_hz) + pending
        self._signal = np.concatenate([self._signal, signal])[-kept:]

    def ending_at(self, samples_after: int) -> float:
        """Estimate the period of the strides, s, from the samples up to the one that has so many samples after it.

        Returns
        -------
        float
            The period; infinite if the samples do not tell it.
        """
        p, end = self._parameters, len(self._signal) - samples_after
        recent = self._signal[max(end - round(p.memory_s * self._rate_hz), 0) : end]
        if len(recent) < p.least_s * self._rate_hz:
            return np.inf
        longest = min(round(p.longest_s * self._rate_hz), len(recent) - 1)
        correlation = autocorrelation(recent, longest)
        lags = np.arange(round(p.shortest_s * self._rate_hz), longest)
        at_lags = correlation[lags]
        peaks = lags[(at_lags > correlation[lags - 1]) & (at_lags >= correlation[lags + 1])]
        if not len(peaks) or float(correlation[peaks].max()) < p.least_agreement:
            return np.inf
        first = peaks[correlation[peaks] >= p.first_share * correlation[peaks].max()][0]
        return float(first) / self._rate_hz


def autocorrelation(signal: Array, longest: int) -> Array:
    """Compute the unbiased autocorrelation of a signal (n,) at lags 0 to `longest`, which is below n; 1 at lag 0."""
    centred = signal - signal.mean()
    # For the few seconds that matter here, the direct sums cost half of what a Fourier transform does.
    products = np.correlate(np.concatenate([centred, np.zeros(longest)]), centred, "valid")
    overlap = 1.0 - np.arange(longest + 1) / len(centred)
    correlation: Array = products / (max(float(products[0]), 1e-12) * overlap)
    return correlation
