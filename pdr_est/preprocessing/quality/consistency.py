"""Check whether the sensors of a device agree with each other and with gravity."""

import numpy as np

from pdr_est.io.conversion.gravity_windows import gravity_windows
from pdr_est.io.conversion.rotation_unit import rotation_unit_warnings
from pdr_est.preprocessing.quality.accelerometer_check import find_accelerometer_fault
from pdr_est.preprocessing.quality.gyroscope_check import SURE_FAULT, gyroscope_warnings
from pdr_est.preprocessing.quality.sensor_checks import stuck_intervals
from pdr_est.preprocessing.sensor_ranges import usable_samples
from pdr_est.types.recording import DeviceRecording, Signal
from pdr_est.types.sensors import Channel


def consistency_warnings(device: DeviceRecording) -> tuple[str, ...]:
    """List what accelerometer and gyroscope of a device contradict; empty when they agree.

    A gyroscope in another unit contradicts gravity, too, and its unit alone is told.
    """
    force = _usable(Channel.SPECIFIC_FORCE, device.specific_force)
    acceleration = force or _usable(Channel.SPECIFIC_FORCE, device.linear_acceleration)
    if acceleration is None:
        return ()
    gyroscope = _usable(Channel.ROTATION_RATE, device.rotation_rate)
    if gyroscope is not None and not gyroscope.values.any():
        gyroscope = None
    # A sensor that stands still is told elsewhere, and contradicts everything.
    if gyroscope is not None and _stand_still(gyroscope, acceleration):
        return ()
    unit = () if gyroscope is None else rotation_unit_warnings(gyroscope, acceleration)
    if force is None:
        return unit
    if gyroscope is None or unit:
        return (*unit, *_without_gyroscope(force))
    return _gravity_warnings(force, gyroscope)


def _gravity_warnings(force: Signal, gyroscope: Signal) -> tuple[str, ...]:
    """List what keeps gravity from staying where it is: a fault of the accelerometer, else of the gyroscope."""
    windows = gravity_windows(force, gyroscope)
    if windows is None:
        return ()
    axes = gyroscope_warnings(windows, force, gyroscope)
    fault = find_accelerometer_fault(windows, with_gyroscope=True)
    if not axes or fault is None:
        return axes if fault is None else (fault.warning,)
    # An axis of the accelerometer that is wrong moves gravity, too: it is the fault if its correction ends that.
    corrected = fault.corrected(force)
    again = gravity_windows(corrected, gyroscope)
    if again is None or not gyroscope_warnings(again, corrected, gyroscope, SURE_FAULT):
        return (fault.warning,)
    return (*axes, *_without_gyroscope(force))


def _stand_still(gyroscope: Signal, acceleration: Signal) -> bool:
    """Tell whether one of two sensors does not change for a while although the other does."""
    return bool(stuck_intervals(gyroscope, (acceleration,)) or stuck_intervals(acceleration, (gyroscope,)))


def _usable(channel: Channel, signal: Signal | None) -> Signal | None:
    """Leave out the samples that no phone can measure; None when nothing is left."""
    if signal is None or not len(signal):
        return None
    damaged = ~usable_samples(channel, signal.values)
    if not damaged.any():
        return signal
    return None if damaged.all() else Signal(signal.time_s[~damaged], signal.values[~damaged])


def _without_gyroscope(force: Signal) -> tuple[str, ...]:
    """Check the accelerometer alone."""
    windows = gravity_windows(force, Signal(force.time_s, np.zeros_like(force.values)))
    fault = None if windows is None else find_accelerometer_fault(windows, with_gyroscope=False)
    return () if fault is None else (fault.warning,)
