"""Small restless motion of hand and leg: noise that is a smooth, exact function of time."""

import numpy as np

from pdr_est.frames import Array
from pdr_est.simulate.motion.differentiable_signal import Jet

WANDER_HZ = (0.02, 0.25)  # slow changes of a posture
AMPLITUDE_HZ = (0.05, 0.6)  # from stride to stride
TREMOR_HZ = (4.0, 10.0)

_UNREST_HZ = (0.4, 14.0)
_TONES, _UNREST_TONES = 6, 40  # enough for the sum to look random over a walk


class Tremor:
    """A sum of sinusoids with random frequencies in a band and random phases, of given root mean square."""

    def __init__(self, rms: float, band_hz: tuple[float, float], rng: np.random.Generator) -> None:
        self._omega = 2.0 * np.pi * rng.uniform(*band_hz, _TONES)
        self._phase = rng.uniform(0.0, 2.0 * np.pi, _TONES)
        self._amplitude = np.full(_TONES, rms * np.sqrt(2.0 / _TONES))

    def at(self, time_s: Array) -> Jet:
        """The signal at some times (n,), in the unit of `rms`."""
        return _sum_of_tones(self._omega, self._phase, self._amplitude, time_s)


class Unrest:
    """The irregular part of walking: broad noise, whose derivative of some order has a given root mean square and a
    density that falls with the frequency, as real phones show between the harmonics of the stride.

    order 1 and rms in rad/s for an angle, order 2 and rms in m/s^2 for a position.
    """

    def __init__(self, rms: float, order: int, rng: np.random.Generator) -> None:
        low, high = np.log(_UNREST_HZ)
        self._omega = 2.0 * np.pi * np.exp(rng.uniform(low, high, _UNREST_TONES))
        self._phase = rng.uniform(0.0, 2.0 * np.pi, _UNREST_TONES)
        self._amplitude = rms * np.sqrt(2.0 / _UNREST_TONES) / self._omega**order

    def at(self, time_s: Array) -> Jet:
        """The signal itself at some times (n,), rad or m."""
        return _sum_of_tones(self._omega, self._phase, self._amplitude, time_s)


def _sum_of_tones(omega: Array, phase: Array, amplitude: Array, time_s: Array) -> Jet:
    value, rate, acceleration = (np.zeros(len(time_s)) for _ in range(3))
    for tone_omega, tone_phase, tone in zip(
        omega, phase, amplitude, strict=True
    ):  # one by one: hours fit into memory
        angle = tone_omega * time_s + tone_phase
        sine = tone * np.sin(angle)
        value += sine
        rate += tone * tone_omega * np.cos(angle)
        acceleration -= tone_omega**2 * sine
    return Jet(value, rate, acceleration)
