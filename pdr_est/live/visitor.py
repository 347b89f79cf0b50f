"""One page that is open somewhere: what it says, and the messages that wait for it."""

import asyncio
import math
from typing import Any

from pdr_est.errors import RecordingError
from pdr_est.live.receivers.browser_phone import BrowserPhone
from pdr_est.live.session import LiveSession, Message

_MOST_WAITING = 500
_LONGEST_NAME = 64
_LONGEST_AGO_S = 600.0


class Visitor:
    """A page with its WebSocket.

    Parameters
    ----------
    session
        The walk.
    phones
        Phones by the identity of their page, common to all visitors, so that a page that returns is the same phone.
    """

    def __init__(self, session: LiveSession, phones: dict[str, BrowserPhone]) -> None:
        self._session, self._phones = session, phones
        self._waiting: asyncio.Queue[Message | None] = asyncio.Queue()
        self._loop: asyncio.AbstractEventLoop | None = None
        self._phone: BrowserPhone | None = None

    def enter(self, loop: asyncio.AbstractEventLoop) -> list[Message]:
        """Begin to wait for messages; return those that tell everything that was before."""
        self._loop = loop
        return self._session.listen(self._hear)

    def leave(self) -> None:
        """Wait for messages no more."""
        self._session.unlisten(self._hear)

    def post(self, message: Message) -> None:
        """Add a message, or the end where too many wait for a page that is slow."""
        self._waiting.put_nowait(message if self._waiting.qsize() < _MOST_WAITING else None)

    async def next_message(self) -> Message | None:
        """Return the next message; None if the page was too slow."""
        return await self._waiting.get()

    def take(self, message: dict[str, Any]) -> Message | None:
        """Take what the page says; return the answer, if there is one.

        Raises
        ------
        RecordingError
            When it is damaged, or more than the limits allow.
        """
        match message.get("type"):
            case "ping":
                return {"type": "pong", "sent": message.get("sent"), "now_s": self._session.now_s}
            case "phone":
                return self._join(str(message.get("id", ""))[:_LONGEST_NAME])
            case "motion" if self._phone is not None:
                self._phone.take(message)
            case "fix":
                ago_s = min(max(_number(message, "ago_s"), 0.0), _LONGEST_AGO_S)
                time_s = self._session.data_time_s - ago_s
                x_m, y_m, sigma_m = (_number(message, name) for name in ("x_m", "y_m", "sigma_m"))
                self._session.take_fix(x_m, y_m, sigma_m, time_s)
            case "stop":
                self._session.stop()
        return None

    def _join(self, identity: str) -> Message:
        if identity not in self._phones:
            try:
                phone = self._session.join("browser")
            except RecordingError as error:  # the page still shows the walk, and may state positions
                return {"type": "refused", "reason": str(error)}
            self._phones[identity] = BrowserPhone(self._session, phone)
        self._phone = self._phones[identity]
        return {"type": "joined", "device": self._phone.phone.name}

    def _hear(self, message: Message) -> None:
        """Take a message of the walk, which comes from any thread."""
        if self._loop is not None and not self._loop.is_closed():
            self._loop.call_soon_threadsafe(self.post, message)


def _number(message: dict[str, Any], name: str) -> float:
    value = message.get(name)
    try:
        number = math.nan if isinstance(value, bool) or not isinstance(value, int | float) else float(value)
    except OverflowError:  # an integer of hundreds of digits
        number = math.inf
    if not math.isfinite(number):
        raise RecordingError(f"a position whose {name} is {str(value)[:40]}: give a number")
    return number
