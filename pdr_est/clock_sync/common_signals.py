"""What all devices on one body feel alike, wherever they are: turns, starts and stops, and heel strikes."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.signal import butter, hilbert, sosfiltfilt

from pdr_est.errors import RecordingError
from pdr_est.frames import STANDARD_GRAVITY_MPS2, Array
from pdr_est.types.recording import DeviceRecording, Signal

RATE_HZ = 50.0  # of the signals compared; recorders of 25 Hz and more are as good
_LEAST_S = 5.0

# All ours, found on WeAllWalk. Legs swing in turn, so what swings is not common; both feel each heel strike, the leg
# that strikes more. The logarithm lets the quiet matter as much as the loud.
_TILT_HZ = 0.3  # below it, specific force is gravity
_TURN_HZ = 0.4  # below it, the rotation about the vertical is the walker's and not the leg's
_STRIKES_HZ = (1.2, 6.0)
_BEAT_HZ = (1.2, 3.0)  # of the steps of a walker or a runner
_EFFORT_HZ = 0.4
_STANDING_MPS2 = 0.3  # acceleration of a device that is not walked with


@dataclass(frozen=True)
class CommonSignals:
    """On an even grid from start_s, (n,) each: effort (how hard it is walked; log of the acceleration), strikes
    (acceleration of the steps, m/s^2), beat (their rhythm: complex, its angle the phase, its size at most 1), turn
    (rotation about the vertical, rad/s; None without gyroscope)."""

    start_s: float
    effort: Array
    strikes: Array
    beat: NDArray[np.complex128]
    turn: Array | None

    @property
    def time_s(self) -> Array:
        grid: Array = self.start_s + np.arange(len(self.effort)) / RATE_HZ
        return grid


def common_signals(device: DeviceRecording) -> CommonSignals:
    """Raise RecordingError for a device without accelerometer, or with less than 5 s of it."""
    force = device.specific_force
    if force is None or not len(force):
        raise RecordingError(
            f"device {device.name!r} has no accelerometer to find its clock by: give its clock offset"
        )
    force = _in_order(force)
    span_s = float(force.time_s[-1] - force.time_s[0])
    if span_s < _LEAST_S:
        raise RecordingError(
            f"device {device.name!r}: {span_s:.3f} s of accelerometer, less than the {_LEAST_S:g} s that its clock "
            "can be found from"
        )
    time_s = np.arange(force.time_s[0], force.time_s[-1], 1.0 / RATE_HZ)
    on_grid = _resampled(force, time_s)
    size = np.linalg.norm(on_grid, axis=1) - STANDARD_GRAVITY_MPS2
    strikes = _filtered(size, _STRIKES_HZ, "bandpass")
    effort = _filtered(np.log(np.abs(strikes) + _STANDING_MPS2), _EFFORT_HZ, "lowpass")
    rhythm = hilbert(_filtered(size, _BEAT_HZ, "bandpass"))
    beat = rhythm / (np.abs(rhythm) + _STANDING_MPS2)
    turn = None
    rate = device.rotation_rate
    if rate is not None and len(rate):
        up = _filtered(on_grid, _TILT_HZ, "lowpass")
        up = up / np.maximum(np.linalg.norm(up, axis=1, keepdims=True), 1e-9)
        turn = _filtered(np.sum(_resampled(_in_order(rate), time_s) * up, axis=1), _TURN_HZ, "lowpass")
    return CommonSignals(float(time_s[0]), effort, strikes, beat, turn)


def _filtered(values: Array, band_hz: float | tuple[float, float], kind: str) -> Array:
    sos = butter(2, band_hz, kind, fs=RATE_HZ, output="sos")
    filtered: Array = sosfiltfilt(sos, values, axis=0)
    return filtered


def _resampled(signal: Signal, time_s: Array) -> Array:
    return np.stack([np.interp(time_s, signal.time_s, column) for column in signal.values.T], axis=1)


def _in_order(signal: Signal) -> Signal:
    """Finite samples later than all before them: a clock that repeats or jumps back tells no time."""
    finite = np.isfinite(signal.time_s) & np.isfinite(signal.values).all(axis=1)
    time_s, values = signal.time_s[finite], signal.values[finite]
    latest = np.maximum.accumulate(time_s)
    later = np.diff(latest, prepend=-np.inf) > 0.0
    return Signal(time_s[later], values[later])
