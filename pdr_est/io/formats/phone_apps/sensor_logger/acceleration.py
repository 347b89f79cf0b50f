"""Find the specific force in a Sensor Logger export, whose `Accelerometer` is without gravity."""

from collections.abc import Mapping

from pdr_est.errors import RecordingError
from pdr_est.frames import STANDARD_GRAVITY_MPS2, up_in_device
from pdr_est.io.conversion import signs, units
from pdr_est.io.conversion.gravity_content import has_gravity
from pdr_est.io.formats.phone_apps.sensor_logger.reading import ExportReading
from pdr_est.types.recording import Signal

_FORCE_SENSORS = ("TotalAcceleration", "Accelerometer", "AccelerometerUncalibrated")
_WITHOUT_GRAVITY = (
    "Accelerometer is without gravity, and none of Gravity, TotalAcceleration, AccelerometerUncalibrated and "
    "Orientation adds it: steps can be counted; switch on Gravity (or Total Acceleration on Android) for a track"
)


def expected_sign(metadata: Mapping[str, str]) -> tuple[float | None, str]:
    """Find the sign of the acceleration that the metadata imply, and why."""
    platform = metadata.get("platform", "").lower()
    if platform == "android":
        return 1.0, "the metadata name Android"
    if platform == "ios":
        standardised = metadata.get("standardisation", "").lower() == "true"
        return (1.0, "iOS with standardisation") if standardised else (-1.0, "iOS without standardisation")
    return None, "the metadata name no platform"


def acceleration_with_gravity(reading: ExportReading, attitude: Signal | None, sign: float | None) -> Signal | None:
    """Read the acceleration with gravity, m/s^2, still with the recorder's sign; None when there is none.

    Raises
    ------
    RecordingError
        For an accelerometer without rows that no other sensor replaces.
    """
    total = reading.signal("TotalAcceleration")
    if total is not None:
        reading.decisions.append("specific force is TotalAcceleration")
        return total
    user = reading.signal("Accelerometer")
    if user is not None and has_gravity(user.values):
        reading.decisions.append("specific force is Accelerometer: by its values it is with gravity")
        return user
    gravity = None if user is None else reading.signal("Gravity")
    if user is not None and gravity is not None:
        reading.decisions.append("specific force is Accelerometer + Gravity")
        return reading.add_gravity(user, gravity)
    raw = reading.signal("AccelerometerUncalibrated")
    if raw is not None:
        reading.decisions.append(
            "specific force is AccelerometerUncalibrated, because there is no accelerometer with gravity"
        )
        return Signal(raw.time_s, raw.values * reading.note(units.detect_acceleration_unit(raw.values)))
    if user is not None and attitude is not None:
        reading.decisions.append(
            "specific force is Accelerometer + gravity along the attitude, because there is no Gravity"
        )
        up = up_in_device(attitude.values) * (STANDARD_GRAVITY_MPS2 * (1.0 if sign is None else sign))
        return reading.add_gravity(user, Signal(attitude.time_s, up))
    if user is None:
        _explain_missing(reading)
    return None


def acceleration_without_gravity(reading: ExportReading, sign: float | None) -> Signal | None:
    """Read `Accelerometer`, m/s^2, with the sign of specific force; None when there is none."""
    user = reading.signal("Accelerometer")
    if user is None:
        return None
    reading.warnings.append(_WITHOUT_GRAVITY)
    reading.decisions.append("acceleration without gravity is Accelerometer")
    return Signal(user.time_s, user.values * (1.0 if sign is None else sign))


def upwards(reading: ExportReading, raw: Signal, attitude: Signal | None, sign: float | None, reason: str) -> Signal:
    """Give an acceleration with gravity the sign that points up at rest, and check its unit."""
    factor = reading.note(signs.detect_force_sign(raw, attitude, sign, reason))
    reading.note(units.detect_acceleration_unit(raw.values))
    return Signal(raw.time_s, raw.values * factor)


def _explain_missing(reading: ExportReading) -> None:
    empty = [sensor for sensor in _FORCE_SENSORS if sensor in reading.export.empty]
    if empty:
        raise RecordingError(
            f"{reading.export.place}: {empty[0]} has no rows and no other sensor replaces it; "
            "export the recording again"
        )
    reading.warnings.append("no accelerometer in the export")
