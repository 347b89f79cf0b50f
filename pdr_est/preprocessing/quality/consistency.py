"""Check whether the sensors of a device agree with each other and with gravity."""

import numpy as np

from pdr_est.io.conversion.gravity_windows import gravity_windows
from pdr_est.io.conversion.rotation_unit import rotation_unit_warnings
from pdr_est.preprocessing.quality.accelerometer_check import accelerometer_warnings
from pdr_est.preprocessing.quality.gyroscope_check import gyroscope_warnings
from pdr_est.types.recording import DeviceRecording, Signal


def consistency_warnings(device: DeviceRecording) -> tuple[str, ...]:
    """List what accelerometer and gyroscope of a device contradict; empty when they agree.

    A gyroscope in another unit contradicts gravity, too, and its unit alone is told.
    """
    force, rate = device.specific_force, device.rotation_rate
    acceleration = force if force is not None and len(force) else device.linear_acceleration
    if acceleration is None or not len(acceleration):
        return ()
    gyroscope = rate if rate is not None and len(rate) and rate.values.any() else None
    unit = () if gyroscope is None else rotation_unit_warnings(gyroscope, acceleration)
    if force is None or not len(force):
        return unit
    if gyroscope is None or unit:
        return (*unit, *_without_gyroscope(force))
    windows = gravity_windows(force, gyroscope)
    if windows is None:
        return ()
    axes = gyroscope_warnings(windows, force, gyroscope)
    return (*axes, *(_without_gyroscope(force) if axes else accelerometer_warnings(windows, with_gyroscope=True)))


def _without_gyroscope(force: Signal) -> tuple[str, ...]:
    """Check the accelerometer alone."""
    windows = gravity_windows(force, Signal(force.time_s, np.zeros_like(force.values)))
    return () if windows is None else accelerometer_warnings(windows, with_gyroscope=False)
