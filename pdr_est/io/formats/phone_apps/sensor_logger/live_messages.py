"""Parse the messages that Sensor Logger pushes over HTTP while it records: one JSON object each."""

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

from pdr_est.errors import RecordingError

Readings = Sequence[tuple[int, Sequence[float]]]
"""Pairs of Unix time, ns, and values."""

LONGEST_LINE = 16 * 1024**2
"""Largest number of characters of a message: ten minutes of all sensors at 100 Hz, for a phone without a network."""

_LONGEST_NAME = 200
_T = TypeVar("_T", int, float)

_XYZ = ("x", "y", "z")
_FIELDS: Mapping[str, tuple[str, ...]] = {
    "accelerometer": _XYZ,
    "gravity": _XYZ,
    "totalacceleration": _XYZ,
    "gyroscope": _XYZ,
    "magnetometer": _XYZ,
    "orientation": ("qw", "qx", "qy", "qz"),
    "location": ("latitude", "longitude", "horizontalAccuracy"),
}
_LATEST_NS = 4_000_000_000 * 10**9  # a Unix time in the year 2096


@dataclass(frozen=True)
class LiveMessage:
    """Readings that a phone sent at once.

    Attributes
    ----------
    device
        Identity of the phone.
    session
        Identity of the recording; a new one begins when the user starts again.
    number
        Number of the message within the session; None when it has none.
    rows
        Sensor -> pairs of Unix time, ns, and values, of the sensors that are used.
    """

    device: str
    session: str
    number: int | None
    rows: Mapping[str, Readings]


def parse_live_message(line: str) -> LiveMessage:
    """Parse one message.

    Raises
    ------
    RecordingError
        When the line is not a message of Sensor Logger, or a reading of a known sensor is damaged.
    """
    if len(line) > LONGEST_LINE:
        raise RecordingError(f"longer than {LONGEST_LINE >> 20} MiB, which no message is")
    try:
        message = json.loads(line)
    except json.JSONDecodeError as error:
        raise RecordingError(f"not JSON: damaged or cut off at character {error.pos + 1} of {len(line)}") from error
    except (ValueError, RecursionError) as error:
        raise RecordingError(
            "the JSON cannot be read: a number is too long, or lists are nested too deeply"
        ) from error
    if not isinstance(message, dict) or not isinstance(message.get("payload"), list):
        raise RecordingError("not a message of Sensor Logger: the list payload is missing")
    rows: dict[str, list[tuple[int, list[float]]]] = {}
    for number, reading in enumerate(message["payload"], start=1):
        sensor, time_ns, values = _parse_reading(number, reading)
        if values is not None:
            rows.setdefault(sensor, []).append((time_ns, values))
    identity = message.get("messageId")
    return LiveMessage(
        device=_identity(message, "deviceId") or "device",
        session=_identity(message, "sessionId"),
        number=identity if isinstance(identity, int) and not isinstance(identity, bool) else None,
        rows=rows,
    )


def _identity(message: Mapping[str, Any], key: str) -> str:
    """Return the name of a phone or session; empty if there is none."""
    value = message.get(key)
    if value is None:
        return ""
    if not isinstance(value, str | int) or len(str(value)) > _LONGEST_NAME:
        raise RecordingError(f"{key} is not a text of at most {_LONGEST_NAME} characters")
    return str(value)


def _parse_reading(number: int, reading: Any) -> tuple[str, int, list[float] | None]:
    """Parse sensor, time and values of a reading; the values are None for a sensor that is not used."""
    place = f"reading {number} of the payload"
    if not isinstance(reading, dict):
        raise RecordingError(f"{place} is damaged: it is not an object with name, time and values")
    missing = [name for name in ("name", "time", "values") if name not in reading]
    if missing:
        raise RecordingError(f"{place} is damaged: {missing[0]} is missing")
    sensor, values = str(reading["name"]), reading["values"]
    time_ns = _number(f"{place} ({sensor}): time", reading["time"], int)
    if not 0 <= time_ns < _LATEST_NS:
        raise RecordingError(f"{place} ({sensor}) is damaged: time {time_ns} is not a Unix time in ns")
    if sensor not in _FIELDS:
        return sensor, time_ns, None
    lacking = [name for name in _FIELDS[sensor] if not isinstance(values, dict) or name not in values]
    if lacking:
        raise RecordingError(f"{place} ({sensor}) is damaged: the value {lacking[0]} is missing")
    return sensor, time_ns, [_number(f"{place} ({sensor}): {name}", values[name], float) for name in _FIELDS[sensor]]


def _number(place: str, value: Any, kind: Callable[[Any], _T]) -> _T:
    try:
        return kind(value)
    except (TypeError, ValueError, OverflowError):
        raise RecordingError(f"{place} is damaged: {value!r} is not a number") from None
