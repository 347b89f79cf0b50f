"""Read the watch of a Sensor Logger export: `WristMotion` has Core Motion's quantities in one table.

Gravity and acceleration are in g with Apple's sign, in m/s^2 and up at rest with standardised units; the quaternion
and the values decide.
"""

from dataclasses import dataclass

from pdr_est.io.conversion import signs, units
from pdr_est.io.conversion.gravity_content import detect_linear_acceleration_unit
from pdr_est.io.formats.phone_apps.sensor_logger.acceleration import upwards
from pdr_est.io.formats.phone_apps.sensor_logger.reading import AXES, ExportReading
from pdr_est.types.recording import DeviceRecording, Signal

_MOTION = "WristMotion"
_RAW = "WatchAccelerometerUncalibrated"
WATCH_MOTION_SENSORS = (_MOTION, _RAW)

_RATE = ("rotationRateX", "rotationRateY", "rotationRateZ")
_GRAVITY = ("gravityX", "gravityY", "gravityZ")
_USER = ("accelerationX", "accelerationY", "accelerationZ")
_QUATERNION = ("quaternionW", "quaternionX", "quaternionY", "quaternionZ")


@dataclass(frozen=True)
class _Sign:
    """Sign of the acceleration that the metadata imply, and the reason."""

    factor: float
    reason: str


def read_watch(reading: ExportReading) -> DeviceRecording:
    """Read the device at the wrist from the sensors of the watch."""
    sign = _expected_sign(reading)
    attitude = reading.signal(_MOTION, _QUATERNION)
    raw = _acceleration(reading)
    if raw is not None:
        raw = Signal(raw.time_s, raw.values * reading.note(units.detect_acceleration_unit(raw.values)))
        if attitude is not None:
            attitude, conversion = signs.resolve_attitude_direction(raw, attitude)
            reading.note(conversion)
    rate = reading.signal(_MOTION, _RATE)
    field = reading.signal("WatchMagnetometer", AXES)
    pressure = reading.signal("WatchBarometer", ("pressure",))
    return DeviceRecording(
        name="watch",
        model="watch",
        platform=reading.metadata.get("platform", "").lower(),
        specific_force=None if raw is None else upwards(reading, raw, attitude, sign.factor, sign.reason),
        linear_acceleration=_without_gravity(reading, sign) if raw is None else None,
        rotation_rate=rate,
        magnetic_field=field,
        attitude=attitude,
        pressure=None if pressure is None else _in_pascal(reading, pressure),
    )


def _expected_sign(reading: ExportReading) -> _Sign:
    standardised = reading.metadata.get("standardisation", "").lower() == "true"
    android = reading.metadata.get("platform", "").lower() == "android"
    if standardised or android:
        return _Sign(1.0, "standardised units" if standardised else "the metadata name Android")
    return _Sign(-1.0, "Core Motion's sign of the watch")


def _acceleration(reading: ExportReading) -> Signal | None:
    """Read acceleration with gravity, still with the recorder's unit and sign."""
    user, gravity = reading.signal(_MOTION, _USER), reading.signal(_MOTION, _GRAVITY)
    if user is not None and gravity is not None:
        reading.decisions.append("specific force is acceleration + gravity of WristMotion")
        return reading.add_gravity(user, gravity)
    raw = reading.signal(_RAW)
    if raw is not None:
        reading.decisions.append(f"specific force is {_RAW}, because WristMotion has no gravity")
    return raw


def _without_gravity(reading: ExportReading, sign: _Sign) -> Signal | None:
    user = reading.signal(_MOTION, _USER)
    if user is None:
        return None
    reading.warnings.append("WristMotion has no gravity: steps can be counted, but there is no track")
    unit = detect_linear_acceleration_unit(user.values)
    return Signal(user.time_s, user.values * (sign.factor * reading.note(unit)))


def _in_pascal(reading: ExportReading, pressure: Signal) -> Signal:
    return Signal(pressure.time_s, pressure.values * reading.note(units.detect_pressure_unit(pressure.values)))
