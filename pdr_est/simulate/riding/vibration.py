"""Vibration of a passenger: from the road over the suspension of the vehicle and the body of the passenger.

A road whose height has the spectrum of ISO 8608 shakes a vehicle at speed v with vertical velocities of constant
spectral density. The suspension lets the body's own frequencies through. Whoever sits or stands adds a resonance of
the trunk at about 5 Hz and, sideways, is a slow pendulum.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from pdr_est.frames import Array
from pdr_est.simulate.motion.differentiable_signal import DifferentiableSignal
from pdr_est.simulate.motion.random_signals import BroadbandNoise, SpectralNoise
from pdr_est.simulate.riding.vehicles import SuspensionParams, VehicleParams

Posture = Literal["sitting", "standing", "rigid"]

_ROAD_CYCLES_PER_M = 0.1  # reference wave number of ISO 8608
_BAND_HZ = (0.4, 25.0)
_SMOOTH_HZ = (2.0, 20.0)  # guides, chains and motors: no body on springs
_TONES = 120
_SWAY_DAMPING = 0.25

# Frequency, Hz, and damping of the trunk on seat or legs; ours, typical. Vertically the main resonance is at about 5
# Hz, with a gain of 1.5 to 2. Horizontally the seat or the legs pass what is slower than 1.5 to 2 Hz.
_TRUNK_VERTICAL = {"sitting": (4.5, 0.35), "standing": (5.5, 0.35)}
_TRUNK_HORIZONTAL = {"sitting": (2.0, 0.5), "standing": (1.5, 0.5)}


@dataclass(frozen=True)
class Vibration:
    """Vibration of the passenger's trunk in axes of the vehicle.

    Attributes
    ----------
    forward, left, up : DifferentiableSignal
        Displacement, m.
    pitch, roll : DifferentiableSignal
        Small rotations about the left and the forward axis, rad.
    """

    forward: DifferentiableSignal
    left: DifferentiableSignal
    up: DifferentiableSignal
    pitch: DifferentiableSignal
    roll: DifferentiableSignal


def road_vibration_density(
    suspension: SuspensionParams, roughness_m3: float, speed_mps: float, at_hz: Array
) -> Array:
    """Compute the spectral density of the vertical acceleration of a vehicle's body on a road.

    Parameters
    ----------
    suspension : SuspensionParams
        Springs, dampers and masses.
    roughness_m3 : float
        Spectral density of the road's height at 0.1 cycles per metre, m^3 (ISO 8608).
    speed_mps : float
        Speed, m/s.
    at_hz : Array
        Frequencies, (n,), Hz.

    Returns
    -------
    Array
        One-sided density, (n,), (m/s^2)^2/Hz.
    """
    s = 2j * np.pi * at_hz
    link = suspension.damper_ps * s + suspension.spring_ps2
    wheel = suspension.wheel_share * s**2 + link + suspension.tyre_ps2
    follows = suspension.tyre_ps2 * link / ((s**2 + link) * wheel - link**2)
    height_density = roughness_m3 * _ROAD_CYCLES_PER_M**2 * speed_mps / at_hz**2
    density: Array = np.abs(follows) ** 2 * np.abs(s) ** 4 * height_density
    return density


class PassengerVibration:
    """Vibration that reaches a passenger, as an exact function of time.

    Parameters
    ----------
    vehicle : VehicleParams
        The vehicle.
    posture : Posture
        How the passenger rides; "rigid" for a phone on a seat or in a holder, without a body in between.
    rng : numpy.random.Generator
        Source of the phases.
    """

    def __init__(self, vehicle: VehicleParams, posture: Posture, rng: np.random.Generator) -> None:
        at_hz = _tones_hz(_BAND_HZ, rng)
        vertical = _density(vehicle, at_hz)
        sway = _resonance(at_hz, vehicle.sway_hz, _SWAY_DAMPING) ** 2 / at_hz
        rms_mps2 = _rms(vertical, at_hz)
        self._up = SpectralNoise(at_hz, _amplitudes(vertical, at_hz, _TRUNK_VERTICAL.get(posture)), rng)
        self._level = [
            SpectralNoise(at_hz, _amplitudes(_scaled(sway, at_hz, share * rms_mps2), at_hz, trunk), rng)
            for share, trunk in (
                (vehicle.lengthways_share, _TRUNK_HORIZONTAL.get(posture)),
                (vehicle.sideways_share, _TRUNK_HORIZONTAL.get(posture)),
            )
        ]
        smooth_hz = _tones_hz(_SMOOTH_HZ, rng)
        flat = _scaled(np.ones(_TONES), smooth_hz, vehicle.smooth_mps2)
        self._smooth = [SpectralNoise(smooth_hz, _amplitudes(flat, smooth_hz, None), rng) for _ in range(3)]
        self._rock = [BroadbandNoise(vehicle.rock_radps, 1, rng) for _ in range(2)]
        engine_hz = vehicle.engine_hz * (1.0 + 0.02 * rng.standard_normal(3))
        self._engine = SpectralNoise(engine_hz, np.full(3, vehicle.engine_mps2 * np.sqrt(2.0 / 3.0)), rng)

    def at(self, time_s: Array, speed_share: DifferentiableSignal, aboard: DifferentiableSignal) -> Vibration:
        """Compute the vibration at times (n,), s.

        Parameters
        ----------
        time_s : Array
            Times, (n,), s.
        speed_share : DifferentiableSignal
            Speed over that between stops, 0 to 1; a road shakes with about its square root.
        aboard : DifferentiableSignal
            1 while the engine shakes the passenger, else 0.
        """
        strength = speed_share * (-speed_share + 2.0)
        forward, left = (strength * noise.at(time_s) for noise in self._level)
        ahead, aside, above = (strength * noise.at(time_s) for noise in self._smooth)
        pitch, roll = (strength * noise.at(time_s) for noise in self._rock)
        up = strength * self._up.at(time_s) + aboard * self._engine.at(time_s)
        return Vibration(forward + ahead, left + aside, up + above, pitch, roll)


def _density(vehicle: VehicleParams, at_hz: Array) -> Array:
    if vehicle.suspension is None:
        return np.zeros(len(at_hz))
    return road_vibration_density(vehicle.suspension, vehicle.roughness_m3, vehicle.speed_mps, at_hz)


def _tones_hz(band_hz: tuple[float, float], rng: np.random.Generator) -> Array:
    """Draw one frequency in each of equal parts of the logarithm of a band, (n,), Hz."""
    low, high = np.log(band_hz)
    tones: Array = np.exp(low + (high - low) * (np.arange(_TONES) + rng.uniform(size=_TONES)) / _TONES)
    return tones


def _widths_hz(at_hz: Array) -> Array:
    widths: Array = np.gradient(at_hz)
    return widths


def _rms(density: Array, at_hz: Array) -> float:
    return float(np.sqrt(density @ _widths_hz(at_hz)))


def _scaled(density: Array, at_hz: Array, rms: float) -> Array:
    """Scale a spectral density (n,) so that its root mean square is `rms`."""
    return density * (rms / _rms(density, at_hz)) ** 2


def _amplitudes(density: Array, at_hz: Array, trunk: tuple[float, float] | None) -> Array:
    """Compute amplitudes of tones, (n,), m/s^2, from their density, behind a trunk's resonance if there is one."""
    gain = 1.0 if trunk is None else _resonance(at_hz, *trunk)
    amplitudes: Array = gain * np.sqrt(2.0 * density * _widths_hz(at_hz))
    return amplitudes


def _resonance(at_hz: Array, own_hz: float, damping: float) -> Array:
    """Compute the gain from the motion of a base to that of a mass on a damped spring, (n,)."""
    ratio = at_hz / own_hz
    base = 1.0 + 2j * damping * ratio
    gain: Array = np.abs(base / (base - ratio**2))
    return gain
