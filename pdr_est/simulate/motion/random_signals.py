"""Random motion of hands, legs and posture: noise that is a smooth, exact function of time."""

import numpy as np

from pdr_est.frames import Array
from pdr_est.simulate.motion.differentiable_signal import DifferentiableSignal

WANDER_HZ = (0.02, 0.25)  # slow changes of a posture
AMPLITUDE_HZ = (0.05, 0.6)  # from stride to stride
TREMOR_HZ = (4.0, 10.0)

_UNREST_HZ = (0.4, 14.0)
_TONES, _UNREST_TONES = 6, 40  # enough for the sum to look random over a walk


class BandlimitedNoise:
    """Sum of sinusoids with random frequencies in a band and random phases.

    Parameters
    ----------
    rms : float
        Root mean square of the signal, in its own unit.
    band_hz : tuple of float
        Lowest and highest frequency.
    rng : numpy.random.Generator
        Source of the frequencies and phases.
    """

    def __init__(self, rms: float, band_hz: tuple[float, float], rng: np.random.Generator) -> None:
        self._omega = 2.0 * np.pi * rng.uniform(*band_hz, _TONES)
        self._phase = rng.uniform(0.0, 2.0 * np.pi, _TONES)
        self._amplitude = np.full(_TONES, rms * np.sqrt(2.0 / _TONES))

    def at(self, time_s: Array) -> DifferentiableSignal:
        """Evaluate the signal at times (n,), s, in the unit of `rms`."""
        return _sum_of_tones(self._omega, self._phase, self._amplitude, time_s)


class BroadbandNoise:
    """Irregular part of walking: broadband noise with a given root mean square of one of its derivatives.

    Its spectral density falls with frequency, as real phones show between the harmonics of the stride.

    Parameters
    ----------
    rms : float
        Root mean square of the derivative of that order: rad/s for an angle of order 1, m/s^2 for a position of order
        2.
    order : int
        Order of the derivative.
    rng : numpy.random.Generator
        Source of the frequencies and phases.
    """

    def __init__(self, rms: float, order: int, rng: np.random.Generator) -> None:
        low, high = np.log(_UNREST_HZ)
        self._omega = 2.0 * np.pi * np.exp(rng.uniform(low, high, _UNREST_TONES))
        self._phase = rng.uniform(0.0, 2.0 * np.pi, _UNREST_TONES)
        self._amplitude = rms * np.sqrt(2.0 / _UNREST_TONES) / self._omega**order

    def at(self, time_s: Array) -> DifferentiableSignal:
        """Evaluate the signal itself at times (n,), s: rad for an angle, m for a position."""
        return _sum_of_tones(self._omega, self._phase, self._amplitude, time_s)


class SpectralNoise:
    """Motion whose acceleration is a sum of tones with given frequencies and amplitudes, and random phases.

    Parameters
    ----------
    at_hz : Array
        Frequencies of the tones, (n,), Hz.
    amplitudes : Array
        Amplitudes of their accelerations, (n,), m/s^2.
    rng : numpy.random.Generator
        Source of the phases.
    """

    def __init__(self, at_hz: Array, amplitudes: Array, rng: np.random.Generator) -> None:
        self._omega = 2.0 * np.pi * at_hz
        self._phase = rng.uniform(0.0, 2.0 * np.pi, len(at_hz))
        self._amplitude = amplitudes / self._omega**2

    def at(self, time_s: Array) -> DifferentiableSignal:
        """Evaluate the position, m, at times (n,), s."""
        return _sum_of_tones(self._omega, self._phase, self._amplitude, time_s)


def _sum_of_tones(omega: Array, phase: Array, amplitude: Array, time_s: Array) -> DifferentiableSignal:
    value, rate, acceleration = (np.zeros(len(time_s)) for _ in range(3))
    for tone_omega, tone_phase, tone in zip(
        omega, phase, amplitude, strict=True
    ):  # one by one: hours fit into memory
        angle = tone_omega * time_s + tone_phase
        sine = tone * np.sin(angle)
        value += sine
        rate += tone * tone_omega * np.cos(angle)
        acceleration -= tone_omega**2 * sine
    return DifferentiableSignal(value, rate, acceleration)
