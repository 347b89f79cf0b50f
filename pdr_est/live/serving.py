"""Run the web application on its ports until somebody ends it."""

import asyncio
import contextlib
import signal
import socket
from collections.abc import Awaitable, Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import uvicorn

from pdr_est.errors import OutputError
from pdr_est.live.limits import LiveLimits
from pdr_est.live.strangers import guarded_protocol


@dataclass(frozen=True)
class Port:
    """One port with the application that answers there.

    Attributes
    ----------
    application
        The ASGI application.
    listening
        Socket that listens already.
    knows
        Tells whether a path begins with the secret part of an address of the application.
    certificate, key
        Files for encryption; None without it.
    """

    application: Any
    listening: socket.socket
    knows: Callable[[str], bool]
    certificate: Path | None = None
    key: Path | None = None


def listen_on(host: str, port: int) -> socket.socket:
    """Open a port; 0 lets the system choose one.

    Raises
    ------
    OutputError
        If it cannot be opened.
    """
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    listening = socket.socket(family, socket.SOCK_STREAM)
    listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listening.bind((host, port))
        listening.listen()  # whoever comes before the server is ready waits
    except (OSError, OverflowError) as error:
        listening.close()
        raise OutputError(
            f"{host}:{port}: cannot be opened ({error}): choose another --port, or a --host that this computer has"
        ) from error
    return listening


async def serve_ports(
    ports: Sequence[Port], limits: LiveLimits, on_interrupt: Callable[[], bool], until: Awaitable[None]
) -> None:
    """Serve until `until` is done, or a signal ends it.

    Parameters
    ----------
    ports
        The ports.
    limits
        Limits of messages and connections.
    on_interrupt
        Called at Ctrl-C; returns True if it has found something to end, so that the server goes on. A request to end
        the program (SIGTERM) always ends the server.
    until
        What to wait for.
    """
    servers = [_Server(_settings(port, limits)) for port in ports]
    loop, stop = asyncio.get_running_loop(), asyncio.Event()

    def interrupt() -> None:
        if not on_interrupt():
            stop.set()

    with contextlib.suppress(NotImplementedError, RuntimeError, ValueError):  # not the main thread, or Windows
        loop.add_signal_handler(signal.SIGINT, interrupt)
        loop.add_signal_handler(signal.SIGTERM, stop.set)
    serving = [
        asyncio.create_task(server.serve(sockets=[port.listening]))
        for server, port in zip(servers, ports, strict=True)
    ]
    ends = [asyncio.ensure_future(until), asyncio.create_task(stop.wait())]
    try:
        await asyncio.wait([*ends, *serving], return_when=asyncio.FIRST_COMPLETED)
    finally:
        for server in servers:
            server.should_exit = True
            server.force_exit = True
        for end in ends:
            end.cancel()
        await asyncio.gather(*serving, return_exceptions=True)


class _Server(uvicorn.Server):
    """Server that leaves signals to `serve_ports`."""

    @contextlib.contextmanager
    def capture_signals(self) -> Iterator[None]:
        yield


def _settings(port: Port, limits: LiveLimits) -> uvicorn.Config:
    return uvicorn.Config(
        port.application,
        log_level="critical",
        access_log=False,
        lifespan="off",
        http=guarded_protocol(limits, port.knows),
        ws="websockets-sansio",
        ws_max_size=limits.message_bytes,
        ws_per_message_deflate=False,  # small messages: compressing them only costs time
        limit_concurrency=limits.connections,
        timeout_keep_alive=30,
        server_header=False,
        proxy_headers=False,
        ssl_certfile=port.certificate,
        ssl_keyfile=port.key,
    )
