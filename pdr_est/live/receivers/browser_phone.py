"""Motion events of a phone's own browser (`DeviceMotionEvent`), as the page sends them.

A row is `[time_s, ax, ay, az, alpha, beta, gamma]`: time on the clock of the walk, which the page compares with this
computer's when it connects; acceleration with gravity, m/s²; rotation about x, y and z, deg/s. Browsers on iOS give
the acceleration with the opposite sign. The orientation of the phone, which all browsers define alike, tells; without
it, the platform does.
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from pdr_est.errors import RecordingError
from pdr_est.frames import Array
from pdr_est.live.phones import PhoneMonitor
from pdr_est.live.session import LiveSession
from pdr_est.types.sensors import Channel, SensorBlock

_WIDTH = 7
_LONGEST_AGO_S, _LONGEST_AHEAD_S = 150.0, 2.0
_ALIGNED = 0.6  # cosine between measured and expected direction of gravity, as for recordings
_FEWEST_MPS2 = 3.0  # below it the mean acceleration of the first rows is no gravity


class BrowserPhone:
    """One phone whose browser sends its motion events.

    Parameters
    ----------
    session
        Walk that the phone takes part in.
    phone
        Counts of what it sends.
    """

    def __init__(self, session: LiveSession, phone: PhoneMonitor) -> None:
        self._session, self.phone = session, phone
        self._sign: float | None = None
        self._newest_s = -math.inf

    def take(self, message: dict[str, Any]) -> None:
        """Take a message with `rows`, and optionally `up` (direction of up in device axes, unit vector) and `ios`.

        Raises
        ------
        RecordingError
            When it is damaged, or from another time than now.
        """
        rows = _numbers(message.get("rows"), _WIDTH, self.phone.name)
        if not len(rows):
            return
        time_s, now_s = rows[:, 0], self._session.now_s
        if not (np.isfinite(time_s).all() and now_s - _LONGEST_AGO_S < time_s.min() <= time_s.max()):
            raise RecordingError(f"{self.phone.name}: samples without a time, or from long ago: load the page again")
        if time_s.max() > now_s + _LONGEST_AHEAD_S:
            raise RecordingError(f"{self.phone.name}: samples from the future: load the page again")
        # Events come in order; what a page sends again after it lost the connection has been taken already.
        rows = rows[(np.diff(time_s, prepend=self._newest_s) > 0.0) & (time_s > self._newest_s)]
        if not len(rows):
            return
        self._newest_s = float(rows[-1, 0])
        force, rate = rows[:, 1:4], np.radians(rows[:, 4:7])
        if self._sign is None:
            self._sign = _sign(force, message.get("up"), bool(message.get("ios")))
        blocks = []
        for channel, values in ((Channel.SPECIFIC_FORCE, self._sign * force), (Channel.ROTATION_RATE, rate)):
            known = np.isfinite(values).all(axis=1)
            blocks.append(SensorBlock(channel, rows[known, 0].copy(), values[known]))
        self._session.take(self.phone, blocks)


def _numbers(given: Any, width: int, place: str) -> Array:
    """Return rows (n, width) of numbers; null is NaN."""
    if not isinstance(given, list) or not all(isinstance(row, list) and len(row) == width for row in given):
        raise RecordingError(f"{place}: a message without rows of {width} numbers: load the page again")
    try:
        return np.array(given, dtype=np.float64).reshape(-1, width)
    except (TypeError, ValueError, OverflowError) as error:
        raise RecordingError(f"{place}: a message with something else than numbers: load the page again") from error


def _sign(force: Array, up: Any, is_ios: bool) -> float:
    """Return the factor of the acceleration: 1, or -1 where it points down at rest."""
    usual = -1.0 if is_ios else 1.0
    mean = force[np.isfinite(force).all(axis=1)].mean(axis=0) if np.isfinite(force).all(axis=1).any() else np.zeros(3)
    if not _is_direction(up) or np.linalg.norm(mean) < _FEWEST_MPS2:
        return usual
    cosine = float(mean @ np.array(up, dtype=np.float64)) / float(np.linalg.norm(mean) * np.linalg.norm(up))
    return math.copysign(1.0, cosine) if abs(cosine) > _ALIGNED else usual


def _is_direction(up: Any) -> bool:
    if not isinstance(up, Sequence) or len(up) != 3 or not all(isinstance(value, int | float) for value in up):
        return False
    return all(abs(value) <= 2.0 for value in up) and 0.5 < math.hypot(*up) < 2.0
