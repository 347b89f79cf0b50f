"""Small restless motion of a hand: band-limited noise that is a smooth, exact function of time."""

import numpy as np

from pdr_est.frames import Array
from pdr_est.simulate.jet import Jet

_TONES = 6  # enough for the sum to look random over a walk


class Tremor:
    """A sum of sinusoids with random frequencies in a band and random phases, of given root mean square."""

    def __init__(self, rms: float, band_hz: tuple[float, float], rng: np.random.Generator) -> None:
        self._omega = 2.0 * np.pi * rng.uniform(*band_hz, _TONES)
        self._phase = rng.uniform(0.0, 2.0 * np.pi, _TONES)
        self._amplitude = rms * np.sqrt(2.0 / _TONES)

    def at(self, time_s: Array) -> Jet:
        """The signal at some times (n,), in the unit of `rms`."""
        angle = time_s[:, None] * self._omega + self._phase
        sine, cosine = np.sin(angle), np.cos(angle)
        return Jet(
            value=self._amplitude * sine.sum(axis=1),
            rate=self._amplitude * (cosine @ self._omega),
            acceleration=-self._amplitude * (sine @ self._omega**2),
        )
