"""Small restless motion of a hand: band-limited noise that is a smooth, exact function of time."""

import numpy as np

from pdr_est.frames import Array
from pdr_est.simulate.jet import Jet

WANDER_HZ = (0.02, 0.25)  # slow changes of a posture
AMPLITUDE_HZ = (0.05, 0.6)  # from stride to stride
TREMOR_HZ = (4.0, 10.0)

_TONES = 6  # enough for the sum to look random over a walk


class Tremor:
    """A sum of sinusoids with random frequencies in a band and random phases, of given root mean square."""

    def __init__(self, rms: float, band_hz: tuple[float, float], rng: np.random.Generator) -> None:
        self._omega = 2.0 * np.pi * rng.uniform(*band_hz, _TONES)
        self._phase = rng.uniform(0.0, 2.0 * np.pi, _TONES)
        self._amplitude = rms * np.sqrt(2.0 / _TONES)

    def at(self, time_s: Array) -> Jet:
        """The signal at some times (n,), in the unit of `rms`."""
        value, rate, acceleration = (np.zeros(len(time_s)) for _ in range(3))
        for omega, phase in zip(self._omega, self._phase, strict=True):  # tone by tone: hours fit into memory
            sine = self._amplitude * np.sin(omega * time_s + phase)
            value += sine
            rate += self._amplitude * omega * np.cos(omega * time_s + phase)
            acceleration -= omega**2 * sine
        return Jet(value, rate, acceleration)
