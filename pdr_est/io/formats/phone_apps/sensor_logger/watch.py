"""Read the watch of a Sensor Logger export: `WristMotion` has Core Motion's quantities in one table.

Gravity and acceleration are in g with Apple's sign, in m/s^2 and up at rest with standardised units; the quaternion
and the values decide.
"""

from pdr_est.io.conversion.raw_device import RawDevice, RawSensor, RawSignal
from pdr_est.io.formats.phone_apps.sensor_logger.reading import AXES, ExportReading
from pdr_est.types.recording import DeviceRecording

_MOTION = "WristMotion"
_RAW = "WatchAccelerometerUncalibrated"
WATCH_MOTION_SENSORS = (_MOTION, _RAW)

_RATE = ("rotationRateX", "rotationRateY", "rotationRateZ")
_GRAVITY = ("gravityX", "gravityY", "gravityZ")
_USER = ("accelerationX", "accelerationY", "accelerationZ")
_QUATERNION = ("quaternionW", "quaternionX", "quaternionY", "quaternionZ")


def read_watch(reading: ExportReading) -> DeviceRecording:
    """Read the device at the wrist from the sensors of the watch."""
    sign, reason = _expected_sign(reading)
    device = RawDevice(
        {},
        name="watch",
        model="watch",
        platform=reading.metadata.get("platform", "").lower(),
        sign=sign,
        sign_reason=reason,
        without_gravity="record WristMotion with gravity",
        decisions=reading.decisions,
        warnings=reading.warnings,
    )
    _add_acceleration(reading, device)
    reading.add(device, RawSensor.RATE, _MOTION, _RATE, 1.0)
    reading.add(device, RawSensor.ATTITUDE, _MOTION, _QUATERNION)
    reading.add(device, RawSensor.FIELD, "WatchMagnetometer", AXES, 1.0)
    reading.add(device, RawSensor.PRESSURE, "WatchBarometer", ("pressure",))
    return device.convert()


def _expected_sign(reading: ExportReading) -> tuple[float, str]:
    """Find the sign of the acceleration that the metadata imply, and why."""
    if reading.metadata.get("standardisation", "").lower() == "true":
        return 1.0, "standardised units"
    if reading.metadata.get("platform", "").lower() == "android":
        return 1.0, "the metadata name Android"
    return -1.0, "Core Motion's sign of the watch"


def _add_acceleration(reading: ExportReading, device: RawDevice) -> None:
    """Give the device the acceleration with gravity, or without it where there is no more."""
    user, gravity = reading.signal(_MOTION, _USER), reading.signal(_MOTION, _GRAVITY)
    if user is not None:
        device.signals[RawSensor.LINEAR] = RawSignal(user, f"acceleration of {_MOTION}")
    if gravity is not None:
        device.signals[RawSensor.GRAVITY] = RawSignal(gravity, f"gravity of {_MOTION}")
    if user is not None and gravity is not None:
        return
    if reading.add(device, RawSensor.FORCE, _RAW, AXES):
        reading.decisions.append(f"{_RAW} is used, because WristMotion has no gravity")
