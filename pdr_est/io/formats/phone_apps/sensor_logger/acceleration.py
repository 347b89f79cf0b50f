"""Choose the acceleration of a Sensor Logger export, whose `Accelerometer` is without gravity."""

from collections.abc import Mapping

from pdr_est.errors import RecordingError
from pdr_est.io.conversion.gravity_content import has_gravity
from pdr_est.io.conversion.raw_device import RawDevice, RawSensor, RawSignal
from pdr_est.io.formats.phone_apps.sensor_logger.reading import ExportReading

_FORCE_SENSORS = ("TotalAcceleration", "Accelerometer", "AccelerometerUncalibrated")

WITHOUT_GRAVITY = (
    "none of Gravity, TotalAcceleration and AccelerometerUncalibrated has it: switch on Gravity (or Total "
    "Acceleration on Android)"
)
"""Advice for an export of acceleration without gravity."""


def expected_sign(metadata: Mapping[str, str]) -> tuple[float | None, str]:
    """Find the sign of the acceleration that the metadata imply, and why."""
    platform = metadata.get("platform", "").lower()
    if platform == "android":
        return 1.0, "the metadata name Android"
    if platform == "ios":
        standardised = metadata.get("standardisation", "").lower() == "true"
        return (1.0, "iOS with standardisation") if standardised else (-1.0, "iOS without standardisation")
    return None, "the metadata name no platform"


def add_acceleration(reading: ExportReading, device: RawDevice) -> None:
    """Give the device the sensors that hold its acceleration, with gravity where the export has it.

    Raises
    ------
    RecordingError
        For an accelerometer without rows that no other sensor replaces.
    """
    total = reading.signal("TotalAcceleration")
    if total is not None:
        device.signals[RawSensor.FORCE] = RawSignal(total, "TotalAcceleration")
        return
    user = reading.signal("Accelerometer")
    if user is not None and has_gravity(user.values):
        reading.decisions.append("Accelerometer is with gravity by its values")
        device.signals[RawSensor.FORCE] = RawSignal(user, "Accelerometer")
        return
    gravity = None if user is None else reading.signal("Gravity")
    if user is not None and gravity is not None:
        device.signals[RawSensor.LINEAR] = RawSignal(user, "Accelerometer")
        device.signals[RawSensor.GRAVITY] = RawSignal(gravity, "Gravity")
        return
    raw = reading.signal("AccelerometerUncalibrated")
    if raw is not None:
        reading.decisions.append("AccelerometerUncalibrated is used: there is no other accelerometer with gravity")
        device.signals[RawSensor.FORCE] = RawSignal(raw, "AccelerometerUncalibrated")
    elif user is not None:
        device.signals[RawSensor.LINEAR] = RawSignal(user, "Accelerometer", 1.0)
    else:
        _explain_missing(reading)


def _explain_missing(reading: ExportReading) -> None:
    empty = [sensor for sensor in _FORCE_SENSORS if sensor in reading.export.empty]
    if empty:
        raise RecordingError(
            f"{reading.export.place}: {empty[0]} has no rows and no other sensor replaces it; "
            "export the recording again"
        )
    reading.warnings.append("no accelerometer in the export")
