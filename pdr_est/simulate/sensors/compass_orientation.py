"""The orientation that a phone without gyroscope reports: level by the accelerometer, north by the magnetometer."""

from dataclasses import replace

import numpy as np
from scipy.signal import butter, lfilter, lfilter_zi
from scipy.spatial.transform import Rotation

from pdr_est.errors import RecordingError
from pdr_est.frames import Array
from pdr_est.types.recording import DeviceRecording, Recording, Signal
from pdr_est.types.sensors import AttitudeReference

ORIENTATION_CUTOFF_HZ = 0.3
"""Cutoff of the low-pass filters in front of the orientation, Hz; ours. Without them the tilt would follow the
acceleration of each step, and what is level of the acceleration would be lost.
"""


def with_compass_orientation(recording: Recording, cutoff_hz: float = ORIENTATION_CUTOFF_HZ) -> Recording:
    """Give every device the attitude that its accelerometer and magnetometer tell, in place of any other.

    So do phones without gyroscope, which report pitch, roll and azimuth (Robust DR, section III-A): up is the
    direction of the specific force, east is level and across the magnetic field. Both pass a low-pass filter before.

    Parameters
    ----------
    recording : Recording
        Recording whose devices have an accelerometer and a magnetometer.
    cutoff_hz : float
        Cutoff of the causal low-pass filters of second order, Hz.

    Raises
    ------
    RecordingError
        If a device has no accelerometer or no magnetometer.
    """
    return replace(recording, devices=tuple(_with_orientation(device, cutoff_hz) for device in recording.devices))


def _with_orientation(device: DeviceRecording, cutoff_hz: float) -> DeviceRecording:
    """Give one device its attitude."""
    force, field = device.specific_force, device.magnetic_field
    if force is None or field is None:
        missing = "accelerometer" if force is None else "magnetometer"
        raise RecordingError(f"{device.name}: no {missing}, so there is no compass orientation: simulate one")
    rate_hz = 1.0 / float(np.median(np.diff(force.time_s)))
    up = _low_passed(force.values, cutoff_hz, rate_hz)
    north = _low_passed(field.interpolated_at(force.time_s), cutoff_hz, rate_hz)
    return replace(
        device,
        attitude=Signal(force.time_s, _orientation(up, north)),
        attitude_reference=AttitudeReference.MAGNETIC_NORTH,
    )


def _low_passed(values: Array, cutoff_hz: float, rate_hz: float) -> Array:
    """Filter the columns of (n, 3) with a Butterworth low-pass that starts in the steady state of the first row."""
    numerator, denominator = butter(2, cutoff_hz, fs=rate_hz)
    state = lfilter_zi(numerator, denominator)[:, None] * values[0]
    filtered: Array = lfilter(numerator, denominator, values, axis=0, zi=state)[0]
    return filtered


def _orientation(force: Array, field: Array) -> Array:
    """Compute the quaternions (n, 4), w first, from device axes to east, north, up."""
    east = np.cross(field, force)
    north = np.cross(force, east)
    rows = np.stack([axis / np.linalg.norm(axis, axis=1)[:, None] for axis in (east, north, force)], axis=1)
    quaternion: Array = Rotation.from_matrix(rows).as_quat()[:, [3, 0, 1, 2]]
    return quaternion
