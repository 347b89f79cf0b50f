"""Combine the messages that Sensor Logger pushes over HTTP while it records to samples, fixes and notes.

The messages carry no metadata. The sign of the acceleration, which is opposite on iPhones, follows from the platform
if that is given, from the phone's own attitude if it is sent, or else from gravity, for a phone whose screen faces
up. Specific force is accelerometer plus gravity, each sample with gravity interpolated to its time.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from pdr_est.errors import RecordingError
from pdr_est.io.conversion import signs
from pdr_est.io.conversion.gnss import gnss_fixes
from pdr_est.io.formats.phone_apps.sensor_logger.live_messages import LiveMessage, parse_live_message
from pdr_est.io.formats.phone_apps.sensor_logger.live_times import LiveTimes
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import GeoOrigin, Signal
from pdr_est.types.sensors import Channel, SensorBlock

Platform = Literal["ios", "android"]

_SIGN_DECISION_S = 2.0  # of acceleration and gravity, until the sign is decided
_LONGEST_WAIT_S = 60.0  # of acceleration for its gravity
_MAX_WAITING = 8  # messages that came early wait for a missing one, which is then given up
_FARTHEST = 1000  # messages that may be missing before one that is no stray
_MOST_PHONES = 16
_NS = 1_000_000_000


@dataclass(frozen=True)
class LiveUpdate:
    """Content of one or more messages.

    Attributes
    ----------
    blocks
        Pairs of device name and samples, on a clock that starts with the first reading.
    fixes
        Position fixes in the map frame, whose origin is the first valid fix.
    notes
        Notes for the user.
    """

    blocks: tuple[tuple[str, SensorBlock], ...] = ()
    fixes: tuple[PositionFix, ...] = ()
    notes: tuple[str, ...] = ()


class LiveReader:
    """Reader of the messages of any number of phones, in any order. Time zero is the first reading of all.

    It keeps no more than what waits for its turn.

    Parameters
    ----------
    platform
        Platform of the phones; None to find the sign of the acceleration from the data.
    origin
        Origin of the map frame, such as that of a floor plan; None for the first valid position of a phone.
    """

    def __init__(self, platform: Platform | None = None, origin: GeoOrigin | None = None) -> None:
        self._platform = platform
        self._common = _Common(origin)
        self._phones: dict[str, _Phone] = {}

    @property
    def epoch_s(self) -> float | None:
        """Return the Unix time of time zero, s; None before the first reading."""
        return self._common.epoch_s

    def push(self, line: str) -> LiveUpdate:
        """Take one message.

        Raises
        ------
        RecordingError
            When the line is not a message of Sensor Logger, or of one phone too many; nothing of it is taken then.
        """
        return self.push_message(parse_live_message(line))

    def push_message(self, message: LiveMessage) -> LiveUpdate:
        """Take one message that is parsed already.

        Raises
        ------
        RecordingError
            When it is of one phone too many; nothing of it is taken then.
        """
        name = message.device
        if name not in self._phones:
            if len(self._phones) >= _MOST_PHONES:
                raise RecordingError(
                    f"a message of one more phone than the {_MOST_PHONES} that a person may carry: track each person "
                    "by a call of its own"
                )
            self._phones[name] = _Phone(name, self._platform, self._common)
        return self._phones[name].push(message)

    def flush(self) -> LiveUpdate:
        """Return what was waiting for missing messages and for gravity; call it once, at the end."""
        updates = [phone.flush() for phone in self._phones.values()]
        return _join(updates)


class _Common:
    """Time zero of all phones, and their map frame: east and north of an origin, by default the first valid fix."""

    def __init__(self, origin: GeoOrigin | None) -> None:
        self._zero_ns: int | None = None
        self._origin = origin

    @property
    def epoch_s(self) -> float | None:
        """Return time zero as Unix time, s; None before the first reading."""
        return None if self._zero_ns is None else self._zero_ns / _NS

    def zero_ns(self, message: LiveMessage) -> int:
        """Return time zero, which is that of the first reading."""
        if self._zero_ns is None:
            self._zero_ns = min(time_ns for rows in message.rows.values() for time_ns, _ in rows)
        return self._zero_ns

    def fixes(self, name: str, located: Signal) -> LiveUpdate:
        """Make fixes from latitude, longitude and accuracy (n, 3)."""
        time_s, values = located.time_s, located.values
        if self._origin is not None:  # the first of all rows is the origin
            time_s = np.concatenate([time_s[:1], time_s])
            values = np.concatenate([[[self._origin.latitude_deg, self._origin.longitude_deg, 1.0]], values])
        found = gnss_fixes(time_s, *values.T)
        notes = tuple(f"{name}: {warning}" for warning in found.warnings)
        if self._origin is not None:
            return LiveUpdate(fixes=found.fixes[1:], notes=notes)
        self._origin = found.origin
        return LiveUpdate(fixes=found.fixes, notes=notes)


class _Phone:
    """Messages of one phone in their order, and the sign of its acceleration."""

    def __init__(self, name: str, platform: Platform | None, common: _Common) -> None:
        self._name, self._platform, self._common = name, platform, common
        self._times = LiveTimes()
        self._zero_ns = 0
        self._session, self._next_id = "", 0
        self._far_id: int | None = None  # of the latest message a long way out of order
        self._waiting: dict[int, LiveMessage] = {}
        self._sign: float | None = None
        self._user, self._gravity, self._attitude = _empty(3), _empty(3), _empty(4)
        self._total = False
        self._warned = False  # that acceleration is left out

    def push(self, message: LiveMessage) -> LiveUpdate:
        number = message.number
        if number is None:
            return self._read(message)
        if message.session != self._session:
            update = self._read_in_order(give_up=True)
            self._session, self._next_id = message.session, number
            return _join([update, self.push(message)])
        if not 0 <= number - self._next_id <= _FARTHEST:
            return self._push_far(number, message)
        self._waiting[number] = message
        return self._read_in_order(give_up=len(self._waiting) > _MAX_WAITING)

    def _push_far(self, number: int, message: LiveMessage) -> LiveUpdate:
        """Take a message whose number is lower than or far from the next: a second one in a row counts anew."""
        counts_anew = self._far_id is not None and number == self._far_id + 1 and self._is_newer(message)
        self._far_id = number
        if counts_anew:
            update = self._read_in_order(give_up=True)
            self._next_id, self._far_id = number + 1, None
            return _join([update, self._read(message)])
        words = "came after later ones" if number < self._next_id else "has a number far from the one before"
        return LiveUpdate(notes=(f"{self._name}: message {number} {words} and is left out",))

    def _is_newer(self, message: LiveMessage) -> bool:
        newest_ns = self._times.newest_ns()
        times = [time_ns for rows in message.rows.values() for time_ns, _ in rows]
        return newest_ns is None or (bool(times) and min(times) > newest_ns)

    def flush(self) -> LiveUpdate:
        update = self._read_in_order(give_up=True)
        messages, notes = self._times.flush()
        rest = [self._read_now(message) for message in messages]
        return _join([update, self._noted(notes), *rest, self._force(at_end=True)])

    def _read_in_order(self, give_up: bool) -> LiveUpdate:
        updates = []
        while self._waiting:
            number = min(self._waiting)
            if number > self._next_id:
                if not give_up:
                    break
                missing = number - self._next_id
                updates.append(
                    LiveUpdate(notes=(f"{self._name}: {missing} messages before message {number} are missing",))
                )
            updates.append(self._read(self._waiting.pop(number)))
            self._next_id = number + 1
        return _join(updates)

    def _read(self, message: LiveMessage) -> LiveUpdate:
        messages, notes = self._times.push(message)
        return _join([self._noted(notes), *(self._read_now(one) for one in messages)])

    def _noted(self, notes: Sequence[str]) -> LiveUpdate:
        return LiveUpdate(notes=tuple(f"{self._name}: {note}" for note in notes))

    def _read_now(self, message: LiveMessage) -> LiveUpdate:
        self._zero_ns = self._common.zero_ns(message)
        signals = {sensor: self._signal(rows) for sensor, rows in message.rows.items()}
        blocks: list[tuple[str, SensorBlock]] = []
        for sensor, channel in (("magnetometer", Channel.MAGNETIC_FIELD), ("gyroscope", Channel.ROTATION_RATE)):
            if sensor in signals:
                blocks.append((self._name, SensorBlock(channel, signals[sensor].time_s, signals[sensor].values)))
        if "totalacceleration" in signals and not self._total:
            self._total, self._user = True, _empty(3)
        self._user = _append(self._user, signals.get("totalacceleration" if self._total else "accelerometer"))
        self._gravity = _append(self._gravity, signals.get("gravity"))
        self._attitude = _append(self._attitude, signals.get("orientation"))
        fixes = self._common.fixes(self._name, signals["location"]) if "location" in signals else LiveUpdate()
        return _join([LiveUpdate(blocks=tuple(blocks)), self._force(at_end=False), fixes, self._limit_waiting()])

    def _limit_waiting(self) -> LiveUpdate:
        """Limit how long acceleration, gravity and attitude wait for each other."""
        signals = (self._user, self._gravity, self._attitude)
        begin_s = (
            max((float(signal.time_s.max()) for signal in signals if len(signal)), default=-np.inf) - _LONGEST_WAIT_S
        )
        left_out = bool((self._user.time_s < begin_s).any())
        self._user, self._gravity, self._attitude = (_from_time(signal, begin_s) for signal in signals)
        if not left_out or self._warned:
            return LiveUpdate()
        self._warned = True
        text = "acceleration without gravity is left out: switch on gravity or total acceleration in the app"
        return LiveUpdate(notes=(f"{self._name}: {text}",))

    def _signal(self, rows: Sequence[tuple[int, Sequence[float]]]) -> Signal:
        time_s = np.array([(time_ns - self._zero_ns) / _NS for time_ns, _ in rows])
        return Signal(time_s, np.array([values for _, values in rows], dtype=np.float64))

    def _force(self, at_end: bool) -> LiveUpdate:
        """Compute the specific force of the samples whose gravity is known."""
        known_s = np.inf if self._total or at_end else (self._gravity.time_s.max() if len(self._gravity) else -np.inf)
        ready = self._user.time_s <= known_s
        if not ready.any() or (not self._total and not len(self._gravity)):
            return LiveUpdate()
        force = Signal(self._user.time_s[ready], self._user.values[ready].copy())
        if self._sign is None and not at_end and force.time_s[-1] - force.time_s[0] < _SIGN_DECISION_S:
            return LiveUpdate()
        if not self._total:
            order = np.argsort(self._gravity.time_s, kind="stable")
            gravity_s, gravity = self._gravity.time_s[order], self._gravity.values[order]
            force.values[:] += np.stack([np.interp(force.time_s, gravity_s, axis) for axis in gravity.T], axis=1)
        notes = self._decide_sign(force) if self._sign is None else ()
        self._user = Signal(self._user.time_s[~ready], self._user.values[~ready])
        self._gravity = _from_time(self._gravity, float(force.time_s.max()) - _SIGN_DECISION_S)
        self._attitude = _empty(4)  # it is not needed any more
        sign = 1.0 if self._sign is None else self._sign
        block = SensorBlock(Channel.SPECIFIC_FORCE, force.time_s, sign * force.values)
        return LiveUpdate(blocks=((self._name, block),), notes=notes)

    def _decide_sign(self, force: Signal) -> tuple[str, ...]:
        if self._platform is not None:
            self._sign = -1.0 if self._platform == "ios" and not self._total else 1.0
            return ()
        attitude = self._attitude if len(self._attitude) > 1 else None
        up = float(np.median(force.values[:, 2]))
        reason = "gravity along the normal of the screen, if the screen faces up"
        conversion = signs.detect_force_sign(force, attitude, -1.0 if up < 0.0 else 1.0, reason)
        self._sign = conversion.factor
        return (f"{self._name}: {conversion.decision}; use --platform if that is wrong", *conversion.warnings)


def _join(updates: Sequence[LiveUpdate]) -> LiveUpdate:
    return LiveUpdate(
        tuple(block for one in updates for block in one.blocks),
        tuple(fix for one in updates for fix in one.fixes),
        tuple(note for one in updates for note in one.notes),
    )


def _empty(width: int) -> Signal:
    return Signal(np.zeros(0), np.zeros((0, width)))


def _append(signal: Signal, more: Signal | None) -> Signal:
    if more is None:
        return signal
    return Signal(np.concatenate([signal.time_s, more.time_s]), np.concatenate([signal.values, more.values]))


def _from_time(signal: Signal, from_s: float) -> Signal:
    keep = signal.time_s >= from_s
    return Signal(signal.time_s[keep], signal.values[keep])
