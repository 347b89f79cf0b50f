"""Names that Sensor Logger gives its sensors, and how they are recognised in the names of files and columns."""

import re

MOTION_SENSORS = (
    "TotalAcceleration",
    "Accelerometer",
    "AccelerometerUncalibrated",
    "Gravity",
    "Gyroscope",
    "GyroscopeUncalibrated",
    "Magnetometer",
    "MagnetometerUncalibrated",
    "Orientation",
)
WATCH_SENSORS = (
    "WristMotion",
    "WatchAccelerometerUncalibrated",
    "WatchMagnetometer",
    "WatchBarometer",
    "WatchLocation",
)
_OTHER_SENSORS = ("Location", "LocationGps", "LocationNetwork", "Barometer", "Pedometer", "Annotation", "Metadata")
KNOWN_SENSORS = (*MOTION_SENSORS, *WATCH_SENSORS, *_OTHER_SENSORS)

_BY_LENGTH = sorted(KNOWN_SENSORS, key=len, reverse=True)
_IN_A_NAME = {name: re.compile(rf"(?<![^\W_]){name}(?![^\W\d_])", re.IGNORECASE) for name in _BY_LENGTH}


def sensor_of_name(name: str) -> str:
    """Return the sensor that the name of a file or a label names, such as `Walking_TotalAcceleration`.

    A name without a known sensor is returned as it is.
    """
    joined = name.replace(" ", "")
    for known in _BY_LENGTH:
        if joined.casefold() == known.casefold():
            return known
    for known in _BY_LENGTH:
        if _IN_A_NAME[known].search(name):
            return known
    return name


def column_of_title(title: str) -> tuple[str, str] | None:
    """Split a title of a combined table, such as `accelerometer_x`, into the sensor and its column.

    Returns
    -------
    tuple of str, or None
        The sensor by its usual name and the column; None for a title that names no known sensor.
    """
    for known in _BY_LENGTH:
        if title.casefold().startswith(known.casefold()):
            rest = title[len(known) :]
            column = rest.lstrip("_. ")
            if column and column != rest:
                return known, column
    return None
