"""How long a stride takes, from how well the recent signal agrees with itself.

A leg's phone feels its own strike and the other foot's differently, so that its signal repeats after a stride, two
steps, and only roughly after one. Not from a paper; all numbers are ours.
"""

import numpy as np

from pdr_est.errors import ConfigError
from pdr_est.frames import Array
from pdr_est.params import Fraction, Positive, params


@params
class StridePeriodParams:
    """memory_s: of the signal that is compared with itself, and least_s, of which there must be so much. shortest_s,
    longest_s: strides that are looked for. least_agreement: correlation at the stride; first_share: the first peak
    with this share of the highest one's correlation is the stride, the later ones are several. The times rise from
    shortest_s over longest_s and least_s to memory_s."""

    memory_s: Positive = 6.0
    least_s: Positive = 3.5
    shortest_s: Positive = 0.65
    longest_s: Positive = 2.4
    least_agreement: Fraction = 0.4
    first_share: Fraction = 0.8


class StridePeriod:
    """The recent samples of one segment, and the stride in them. Raises ConfigError if the times are in another
    order."""

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
        self._signal = np.empty(0)

    def append(self, signal: Array, undecided: int) -> None:
        """Add samples (n,). undecided: how many of the latest ones, these included, may still be asked about."""
        kept = round(self._parameters.memory_s * self._rate_hz) + undecided
        self._signal = np.concatenate([self._signal, signal])[-kept:]

    def before(self, later: int) -> float:
        """Seconds that a stride takes by the samples up to the one that has so many later ones; infinite if they do
        not tell."""
        p, end = self._parameters, len(self._signal) - later
        recent = self._signal[max(end - round(p.memory_s * self._rate_hz), 0) : end]
        if len(recent) < p.least_s * self._rate_hz:
            return np.inf
        agreement = _autocorrelation(recent)
        longest = min(round(p.longest_s * self._rate_hz), len(recent) - 1)
        lags = np.arange(round(p.shortest_s * self._rate_hz), longest)
        here = agreement[lags]
        peaks = lags[(here > agreement[lags - 1]) & (here >= agreement[lags + 1])]
        if not len(peaks) or float(agreement[peaks].max()) < p.least_agreement:
            return np.inf
        first = peaks[agreement[peaks] >= p.first_share * agreement[peaks].max()][0]
        return float(first) / self._rate_hz


def _autocorrelation(signal: Array) -> Array:
    """Correlation (n,) of a signal (n,) with itself, later by as many samples; 1 at none."""
    centred = signal - signal.mean()
    spectrum = np.fft.rfft(centred, 2 * len(centred))
    products = np.fft.irfft(spectrum * np.conj(spectrum))[: len(centred)]
    correlation: Array = products / (max(float(products[0]), 1e-12) * (1.0 - np.arange(len(centred)) / len(centred)))
    return correlation
