"""Two yardsticks for the cost of the chain: the filter VQF by itself, and a chain as textbooks have it.

They are what anybody writes who needs a track at once: arrays of a whole recording, no uncertainty, no gaps, one way
of carrying the phone. Nothing but the suite `speed` uses them.
"""

from dataclasses import dataclass

import numpy as np
from scipy import signal
from vqf import VQF

from pdr_est.errors import RecordingError
from pdr_est.frames import STANDARD_GRAVITY_MPS2, Array
from pdr_est.types.recording import DeviceRecording

_CUTOFF_HZ, _LEAST_PEAK_MPS2, _LEAST_INTERVAL_S = 3.0, 0.5, 0.3
_WEINBERG_K = 0.51


@dataclass(frozen=True)
class InertialArrays:
    """Samples of a device on a common grid.

    Attributes
    ----------
    rate_hz
        Sampling rate.
    rotation_rate_radps, specific_force_mps2
        Gyroscope and accelerometer, (n, 3), C-contiguous.
    """

    rate_hz: float
    rotation_rate_radps: Array
    specific_force_mps2: Array


def inertial_arrays(device: DeviceRecording, rate_hz: float) -> InertialArrays:
    """Interpolate gyroscope and accelerometer of a device to a grid, which the yardsticks get for nothing."""
    force, rate = device.specific_force, device.rotation_rate
    if force is None or rate is None:
        raise RecordingError(f"{device.name}: no accelerometer or no gyroscope; the simulated phones have both")
    begin, end = max(force.time_s[0], rate.time_s[0]), min(force.time_s[-1], rate.time_s[-1])
    grid = np.arange(begin, end, 1.0 / rate_hz)
    values = [
        np.ascontiguousarray([np.interp(grid, one.time_s, axis) for axis in one.values.T]).T.copy()
        for one in (rate, force)
    ]
    return InertialArrays(rate_hz, *values)


def vqf_attitude(samples: InertialArrays) -> Array:
    """Filter the attitude, unit quaternions of device to level frame with w first, (n, 4)."""
    found: Array = VQF(1.0 / samples.rate_hz).updateBatch(samples.rotation_rate_radps, samples.specific_force_mps2)[
        "quat6D"
    ]
    return found


def textbook_track(samples: InertialArrays) -> Array:
    """Reckon positions by peaks of the acceleration, Weinberg's step length and the yaw of VQF, (steps + 1, 2), m."""
    w, x, y, z = vqf_attitude(samples).T
    magnitude = np.linalg.norm(samples.specific_force_mps2, axis=1) - STANDARD_GRAVITY_MPS2
    smooth = signal.sosfiltfilt(signal.butter(2, _CUTOFF_HZ, fs=samples.rate_hz, output="sos"), magnitude)
    peaks, _ = signal.find_peaks(
        smooth, height=_LEAST_PEAK_MPS2, distance=max(round(_LEAST_INTERVAL_S * samples.rate_hz), 1)
    )
    if len(peaks) < 2:
        return np.zeros((1, 2))
    highest, lowest = np.maximum.reduceat(smooth, peaks[:-1]), np.minimum.reduceat(smooth, peaks[:-1])
    lengths_m = _WEINBERG_K * (highest - lowest) ** 0.25
    yaw = np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))[peaks[1:]]
    moves_m = lengths_m[:, None] * np.column_stack([np.cos(yaw), np.sin(yaw)])
    return np.vstack([np.zeros((1, 2)), np.cumsum(moves_m, axis=0)])
