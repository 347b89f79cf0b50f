"""Signals that are alike on all devices of one body, wherever it carries them: intensity, steps and turns.

All filters are ours, found on WeAllWalk. The legs swing in turn, so what swings is not common to the devices; both
feel each heel strike, though the leg that strikes feels it more.
"""

from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np
from numpy.typing import NDArray

from pdr_est.errors import RecordingError
from pdr_est.frames import STANDARD_GRAVITY_MPS2, Array
from pdr_est.types.recording import DeviceRecording, Signal

RATE_HZ = 50.0
"""Sampling rate of the common signals; recorders of 25 Hz and more serve as well."""

INTENSITY_HZ = 0.4
"""Frequency up to which the log intensity and the turn rate reach."""

_LEAST_S = 5.0
_TILT_HZ = 0.3  # below it, specific force is gravity
_TURN_HZ = INTENSITY_HZ  # below it, the rotation about the vertical is the walker's and not the leg's
_HEEL_STRIKE_HZ = (1.2, 6.0)
_STEP_HZ = (1.2, 3.0)  # step frequencies of walkers and runners
_LONGEST_PAUSE_S = 600.0
_MOST_EMPTY = 4.0  # times the recorded time, and an hour: a recording with longer gaps is not filled up
_HOUR_S = 3600.0
_STANDING_MPS2 = 0.3  # acceleration of a device that is not walked with


@dataclass(frozen=True)
class CommonSignals:
    """Signals of one device on a uniform grid of `RATE_HZ`, one value a sample, (n,) each.

    Attributes
    ----------
    start_s
        Time of the first sample, s on the clock of the device.
    log_intensity
        Logarithm of the low-pass filtered magnitude of the acceleration, which shows starts, stops and briskness.
        The logarithm lets quiet walking weigh as much as brisk walking.
    heel_strikes_mps2
        Norm of the specific force less gravity, band-passed to the heel strikes, m/s^2.
    step_phasor
        Analytic signal of the steps: its angle is the phase within a step, its magnitude is at most 1 and near 0
        where the device is at rest.
    turn_rate_radps
        Rotation rate about the vertical, low-pass filtered, rad/s; None without a gyroscope.
    """

    start_s: float
    log_intensity: Array
    heel_strikes_mps2: Array
    step_phasor: NDArray[np.complex128]
    turn_rate_radps: Array | None

    @cached_property
    def time_s(self) -> Array:
        """Compute the times (n,) of the samples, s on the clock of the device."""
        grid: Array = self.start_s + np.arange(len(self.log_intensity)) / RATE_HZ
        return grid


def extract_common_signals(device: DeviceRecording) -> CommonSignals:
    """Compute the common signals of a device from its accelerometer and, if present, its gyroscope.

    Raises
    ------
    RecordingError
        For a device without an accelerometer, or with less than 5 s of it.
    """
    from scipy.signal import hilbert  # slow to load, and not needed for a single device

    force = device.specific_force
    if force is None or not len(force):
        raise RecordingError(
            f"device {device.name!r} has no accelerometer, from which its clock could be found: give its clock offset"
        )
    force = _densest_stretch(_increasing_finite(force))
    span_s = float(force.time_s[-1] - force.time_s[0])
    if span_s < _LEAST_S:
        raise RecordingError(
            f"device {device.name!r} has {span_s:.3f} s of accelerometer data, less than the {_LEAST_S:g} s from "
            "which its clock can be found: give its clock offset"
        )
    time_s = np.arange(force.time_s[0], force.time_s[-1], 1.0 / RATE_HZ)
    on_grid = _interpolated(force, time_s)
    magnitude = np.linalg.norm(on_grid, axis=1) - STANDARD_GRAVITY_MPS2
    heel_strikes = _filtered(magnitude, _HEEL_STRIKE_HZ, "bandpass")
    log_intensity = _filtered(np.log(np.abs(heel_strikes) + _STANDING_MPS2), INTENSITY_HZ, "lowpass")
    analytic = hilbert(_filtered(magnitude, _STEP_HZ, "bandpass"))
    step_phasor = analytic / (np.abs(analytic) + _STANDING_MPS2)
    turn_rate = None
    rate = device.rotation_rate
    if rate is not None and len(rate):
        up = _filtered(on_grid, _TILT_HZ, "lowpass")
        up = up / np.maximum(np.linalg.norm(up, axis=1, keepdims=True), 1e-9)
        vertical_rate = np.sum(_interpolated(_increasing_finite(rate), time_s) * up, axis=1)
        turn_rate = _filtered(vertical_rate, _TURN_HZ, "lowpass")
    return CommonSignals(float(time_s[0]), log_intensity, heel_strikes, step_phasor, turn_rate)


def _filtered(values: Array, band_hz: float | tuple[float, float], kind: str) -> Array:
    """Filter forwards and backwards (no phase shift) with a second-order Butterworth filter."""
    from scipy.signal import sosfiltfilt

    filtered: Array = sosfiltfilt(_designed(band_hz, kind), values, axis=0)
    return filtered


@cache
def _designed(band_hz: float | tuple[float, float], kind: str) -> Array:
    """Design a filter as second-order sections; once only, since that takes longer than to filter a minute."""
    from scipy.signal import butter

    sections: Array = butter(2, band_hz, kind, fs=RATE_HZ, output="sos")
    return sections


def _interpolated(signal: Signal, time_s: Array) -> Array:
    return np.stack([np.interp(time_s, signal.time_s, column) for column in signal.values.T], axis=1)


def _densest_stretch(signal: Signal) -> Signal:
    """Return the stretch with the most samples of a signal that consists of gaps, so that no grid fills them."""
    steps_s = np.diff(signal.time_s)
    recorded_s = float(np.minimum(steps_s, 1.0).sum())
    if float(steps_s.sum()) <= _MOST_EMPTY * recorded_s + _HOUR_S:
        return signal
    edges = [0, *(np.flatnonzero(steps_s > _LONGEST_PAUSE_S) + 1), len(signal)]
    longest = int(np.argmax(np.diff(edges)))
    part = slice(edges[longest], edges[longest + 1])
    return Signal(signal.time_s[part], signal.values[part])


def _increasing_finite(signal: Signal) -> Signal:
    """Keep the finite samples whose time is later than all before them."""
    finite = np.isfinite(signal.time_s) & np.isfinite(signal.values).all(axis=1)
    time_s, values = signal.time_s[finite], signal.values[finite]
    latest = np.maximum.accumulate(time_s)
    later = np.diff(latest, prepend=-np.inf) > 0.0
    return Signal(time_s[later], values[later])
