"""Connections of clients that have not named the secret part of an address: few of them, and none for long."""

import asyncio
from collections.abc import Callable
from typing import Any

from uvicorn.protocols.http.h11_impl import H11Protocol

from pdr_est.live.limits import LiveLimits


class Strangers:
    """The connections of one port whose clients nobody knows yet.

    Whoever holds connections open without a token takes no place of a phone: the oldest one is closed for a new one.

    Parameters
    ----------
    limits
        How many there may be, and for how long.
    knows
        Tells whether a path begins with the secret part of an address.
    """

    def __init__(self, limits: LiveLimits, knows: Callable[[str], bool]) -> None:
        self.patience_s, self.knows = limits.stranger_s, knows
        self._most = limits.strangers
        self._waiting: dict[asyncio.Transport, None] = {}  # the oldest one first

    def admit(self, connection: asyncio.Transport) -> None:
        """Take in a new connection; the oldest stranger makes place for it."""
        self._waiting[connection] = None
        if len(self._waiting) > self._most:
            oldest = next(iter(self._waiting))
            self.forget(oldest)
            oldest.abort()

    def forget(self, connection: asyncio.Transport) -> None:
        """Take out a connection that is closed, or whose client is known."""
        self._waiting.pop(connection, None)

    def turn_away(self, connection: asyncio.Transport) -> None:
        """Close a connection whose client has still not become known."""
        if connection in self._waiting:
            self.forget(connection)
            connection.abort()


class _GuardedProtocol(H11Protocol):
    """HTTP of a client who is a stranger until a request names the token."""

    strangers: Strangers

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        super().connection_made(transport)
        self.strangers.admit(transport)
        self._patience = self.loop.call_later(self.strangers.patience_s, self.strangers.turn_away, transport)

    def data_received(self, data: bytes) -> None:
        super().data_received(data)
        if self.scope is not None and self.strangers.knows(self.scope["path"]):
            self._become_known()

    def connection_lost(self, exc: Exception | None) -> None:
        self._become_known()
        super().connection_lost(exc)

    def _become_known(self) -> None:
        self._patience.cancel()
        self.strangers.forget(self.transport)


def guarded_protocol(limits: LiveLimits, knows: Callable[[str], bool]) -> type[asyncio.Protocol]:
    """Make the protocol class of one port.

    Parameters
    ----------
    limits
        How many strangers there may be, and for how long.
    knows
        Tells whether a path begins with the secret part of an address.
    """
    own: dict[str, Any] = {"strangers": Strangers(limits, knows)}
    return type("GuardedProtocol", (_GuardedProtocol,), own)
