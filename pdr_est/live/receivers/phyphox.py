"""phyphox's remote access: the phone is the server, and this computer asks it for new samples again and again.

The experiment's own description tells which buffers hold which sensor, since each experiment names them as it likes.
"""

import http.client
import json
import threading
import urllib.request
from dataclasses import dataclass
from typing import Any
from urllib.parse import urlsplit

import numpy as np

from pdr_est.errors import ConfigError, PdrError, RecordingError
from pdr_est.frames import Array
from pdr_est.live.phones import PhoneMonitor
from pdr_est.live.receivers.arrival import ArrivalClock
from pdr_est.live.session import LiveSession
from pdr_est.types.sensors import Channel, SensorBlock

POLL_EVERY_S = 0.1
"""Pause between two questions, s."""

_RETRY_AFTER_S = 2.0
_TIMEOUT_S = 5.0
_MOST_BYTES = 16 * 1024**2
_CHANNELS = {
    "accelerometer": Channel.SPECIFIC_FORCE,
    "gyroscope": Channel.ROTATION_RATE,
    "magnetic_field": Channel.MAGNETIC_FIELD,
}


@dataclass(frozen=True)
class SensorBuffers:
    """Buffers of an experiment that hold one sensor.

    Attributes
    ----------
    channel
        The sensor.
    time
        Name of the buffer with the times.
    axes
        Names of the buffers with x, y and z.
    """

    channel: Channel
    time: str
    axes: tuple[str, str, str]


def sensor_buffers(config: Any) -> tuple[SensorBuffers, ...]:
    """Find the buffers of the sensors in the description of an experiment, the answer to `/config`.

    Raises
    ------
    RecordingError
        If the answer is none of phyphox.
    """
    inputs = config.get("inputs") if isinstance(config, dict) else None
    if not isinstance(inputs, list):
        raise RecordingError("the answer is no description of an experiment of phyphox")
    found = []
    for one in inputs:
        channel = _CHANNELS.get(str(one.get("source"))) if isinstance(one, dict) else None
        outputs = one.get("outputs") if channel is not None else None
        if channel is None or not isinstance(outputs, list):
            continue
        names: dict[str, str] = {}
        for output in outputs:
            names |= {str(key): str(name) for key, name in output.items()} if isinstance(output, dict) else {}
        if {"x", "y", "z", "t"} <= set(names):
            found.append(SensorBuffers(channel, names["t"], (names["x"], names["y"], names["z"])))
    return tuple(found)


class PhyphoxPhone:
    """A phone whose experiment is asked for new samples, in a thread of its own.

    Parameters
    ----------
    session
        Walk that the phone takes part in.
    address
        Address that phyphox shows when remote access is switched on, such as http://192.168.0.5:8080.

    Raises
    ------
    ConfigError
        If the address is none.
    """

    def __init__(self, session: LiveSession, address: str) -> None:
        self._address = base_address(address)
        self._session = session
        self._phone: PhoneMonitor = session.join("phyphox")
        self._buffers: tuple[SensorBuffers, ...] = ()
        self._newest: dict[str, float] = {}
        self._placed_until_s: dict[Channel, float] = {}
        self._experiment = ""
        self._clock = ArrivalClock(always=True)
        self._thread = threading.Thread(target=self._poll, name="phyphox", daemon=True)

    def start(self) -> None:
        """Begin to ask."""
        self._thread.start()

    def _poll(self) -> None:
        pause_s = 0.0
        while not self._session.ended.wait(pause_s):
            try:
                if not self._buffers:
                    self._buffers = sensor_buffers(self._ask("/config"))
                self._take(self._ask(self._question()))
                pause_s = POLL_EVERY_S
            except PdrError as error:
                self._phone.remark = f"{self._phone.name}: {error}"
                pause_s = _RETRY_AFTER_S

    def _ask(self, path: str) -> Any:
        hint = "look whether phyphox shows the experiment, with remote access switched on"
        try:
            with urllib.request.urlopen(self._address + path, timeout=_TIMEOUT_S) as answer:
                content = answer.read(_MOST_BYTES + 1)
            if len(content) > _MOST_BYTES:
                raise RecordingError(f"{self._address}: an answer of more than {_MOST_BYTES >> 20} MiB: {hint}")
            return json.loads(content)
        except (OSError, ValueError, RecursionError, http.client.HTTPException) as error:
            raise RecordingError(f"{self._address}: no answer ({error}): {hint}") from error

    def _question(self) -> str:
        if not self._buffers:
            raise RecordingError(
                f"{self._address}: the experiment has neither accelerometer nor gyroscope: add a simple experiment "
                "with both (the plus sign)"
            )
        asked = []
        for one in self._buffers:
            since = f"{self._newest[one.time]!r}" if one.time in self._newest else "full"
            asked.append(f"{one.time}={since}")
            asked += [f"{axis}={since}" + (f"|{one.time}" if since != "full" else "") for axis in one.axes]
        return "/get?" + "&".join(asked)

    def _take(self, answer: Any) -> None:
        try:
            status, buffers = answer["status"], answer["buffer"]
            session, measuring = str(status["session"]), bool(status["measuring"])
            columns = {name: _column(buffers[name]["buffer"]) for name in self._names()}
        except (TypeError, KeyError, ValueError, OverflowError) as error:
            self._buffers = ()  # another experiment may have been opened
            raise RecordingError(f"{self._address}: an answer that is none of phyphox: load it again") from error
        if self._experiment and session != self._experiment:  # the samples were cleared, and their time begins anew
            self._newest, self._clock = {}, ArrivalClock(always=True)
            self._experiment = session
            return
        self._experiment = session
        self._phone.remark = "" if measuring else f"{self._phone.name}: phyphox does not measure: press play"
        self._hand_on(columns)

    def _names(self) -> list[str]:
        return [name for one in self._buffers for name in (one.time, *one.axes)]

    def _hand_on(self, columns: dict[str, Array]) -> None:
        ends = [float(np.nanmax(columns[one.time])) for one in self._buffers if np.isfinite(columns[one.time]).any()]
        if not ends:
            return
        shift_s = self._clock.to_walk(max(ends), self._session.now_s)
        blocks = []
        for one in self._buffers:
            count = min(len(columns[name]) for name in (one.time, *one.axes))
            time_s = columns[one.time][:count]
            values = np.stack([columns[axis][:count] for axis in one.axes], axis=1)
            good = (
                np.isfinite(time_s)
                & np.isfinite(values).all(axis=1)
                & (time_s > self._newest.get(one.time, float("-inf")))
            )
            if good.any():
                self._newest[one.time] = float(time_s[good].max())
                blocks.append(self._in_order(SensorBlock(one.channel, time_s[good] + shift_s, values[good])))
        self._session.take(self._phone, blocks)

    def _in_order(self, block: SensorBlock) -> SensorBlock:
        """Leave out what is placed before earlier samples, which may be a few after the phone's clock began anew."""
        later = block.time_s > self._placed_until_s.get(block.channel, float("-inf"))
        if later.any():
            self._placed_until_s[block.channel] = float(block.time_s[later].max())
        return SensorBlock(block.channel, block.time_s[later], block.values[later])


def base_address(address: str) -> str:
    """Return scheme, host and port of the address that phyphox shows.

    Parameters
    ----------
    address
        What the user states, such as 192.168.0.5:8080.

    Raises
    ------
    ConfigError
        If it is none.
    """
    try:
        parts = urlsplit(address if "//" in address else f"http://{address}")
        is_address = parts.scheme in ("http", "https") and bool(parts.hostname) and parts.port != 0
    except ValueError:  # a port that is no number, or brackets that do not close
        is_address = False
    if not is_address or any(not character.isprintable() or character == " " for character in address):
        raise ConfigError(f"--phyphox {address}: no address: give the one that phyphox shows, http://…:8080")
    return f"{parts.scheme}://{parts.netloc}"


def _column(given: Any) -> Array:
    """Return the numbers of a buffer; null is NaN."""
    column: Array = np.array(given, dtype=np.float64)
    return column.reshape(-1)
