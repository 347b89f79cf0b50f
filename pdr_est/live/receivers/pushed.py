"""Messages that Sensor Logger pushes by HTTP while it records."""

import threading
from dataclasses import replace

from pdr_est.errors import RecordingError
from pdr_est.io.formats.phone_apps.sensor_logger.live import LiveReader, LiveUpdate, Platform
from pdr_est.io.formats.phone_apps.sensor_logger.live_messages import LiveMessage, parse_live_message
from pdr_est.live.phones import PhoneMonitor
from pdr_est.live.receivers.arrival import ArrivalClock
from pdr_est.live.session import LiveSession
from pdr_est.types.sensors import SensorBlock


class PushedMessages:
    """Reader of the messages of all phones that push to this server.

    Parameters
    ----------
    session
        Walk that the phones take part in.
    platform
        Platform of the phones; None to detect it.
    with_fixes
        True to use the positions that the phones send.
    """

    def __init__(self, session: LiveSession, platform: Platform | None = None, with_fixes: bool = False) -> None:
        self._session, self._with_fixes = session, with_fixes
        self._reader = LiveReader(platform, None if session.plan is None else session.plan.origin)
        self._phones: dict[str, PhoneMonitor] = {}
        self._clocks: dict[str, ArrivalClock] = {}
        self._lock = threading.Lock()
        session.before_end.append(self.flush)

    def take(self, text: str) -> None:
        """Record and read one message.

        Raises
        ------
        RecordingError
            When it is no message of Sensor Logger, or of one phone too many.
        OutputError
            When it cannot be written.
        """
        message = parse_live_message(text)
        with self._lock:
            self._take(message, text)

    def _take(self, message: LiveMessage, text: str) -> None:
        if message.device not in self._phones:
            self._phones[message.device] = self._session.join("sensor-logger")
            self._clocks[message.device] = ArrivalClock()
        phone = self._phones[message.device]
        phone.heard |= {sensor for sensor, rows in message.rows.items() if rows}
        self._session.keep_message(text)
        news = self._reader.push_message(message)
        self._hand_on(news)
        for fix in news.fixes if self._with_fixes else ():
            shift_s = (self._reader.epoch_s or 0.0) - self._session.epoch_s
            shift_s += self._clocks[message.device].to_walk(fix.time_s + shift_s, self._session.now_s)
            self._session.put_fix(replace(fix, time_s=fix.time_s + shift_s))

    def flush(self) -> None:
        """Hand on what waits for missing messages and for gravity; called once, at the end."""
        with self._lock:
            self._hand_on(self._reader.flush())

    def _hand_on(self, news: LiveUpdate) -> None:
        for note in news.notes:
            self._session.tell(self._in_names_of_walk(note))
        blocks: dict[str, list[SensorBlock]] = {}
        for device, block in news.blocks:
            blocks.setdefault(device, []).append(self._on_clock_of_walk(device, block))
        for device, of_device in blocks.items():
            self._session.take(self._phones[device], of_device)

    def _on_clock_of_walk(self, device: str, block: SensorBlock) -> SensorBlock:
        zero_s = self._reader.epoch_s
        if zero_s is None:
            raise RecordingError(f"{device}: samples without a time: start the recording in the app again")
        clock, phone = self._clocks[device], self._phones[device]
        own_s = zero_s - self._session.epoch_s
        own_s += clock.to_walk(float(block.time_s.max()) + own_s, self._session.now_s)
        if clock.is_wrong:
            self._session.tell(
                f"{phone.name}: its clock is {clock.ahead_s:+.0f} s off from this computer's; its samples are placed "
                "by their arrival, to about a second: set the clocks by the network"
            )
        return replace(block, time_s=block.time_s + own_s)

    def _in_names_of_walk(self, note: str) -> str:
        device, colon, words = note.partition(": ")
        return f"{self._phones[device].name}{colon}{words}" if device in self._phones else note
