"""Live walks without phones: a session, messages of apps and pages, and servers of this process."""

import asyncio
import json
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import closing, contextmanager, suppress
from dataclasses import dataclass
from http.client import HTTPConnection
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import numpy as np

from pdr_est.config import Config
from pdr_est.live.limits import LiveLimits
from pdr_est.live.receivers.pushed import PushedMessages
from pdr_est.live.recording_files import LiveRecording
from pdr_est.live.server import LiveApp
from pdr_est.live.serving import Port, listen_on, serve_ports
from pdr_est.live.session import LiveSession
from pdr_est.types.recording import DeviceRecording

EKF = Config().with_estimator("ekf")
GRAVITY_MPS2 = 9.81
PAGE, PUSH = "page-token", "push-token"


def new_session(folder: Path | None, config: Config = EKF, **limits: Any) -> LiveSession:
    return LiveSession(config, None if folder is None else LiveRecording(folder), LiveLimits(**limits))


def ended(session: LiveSession) -> LiveSession:
    """Stop a session and wait until everything is processed."""
    session.stop()
    assert session.ended.wait(60.0)
    return session


def motion_rows(device: DeviceRecording, begin_s: float, from_s: float, to_s: float) -> list[list[float]]:
    """Rows as a page sends them, of the samples of a device in a time span; `begin_s` is added to their times."""
    force, rate = device.specific_force, device.rotation_rate
    assert force is not None
    assert rate is not None
    within = (force.time_s >= from_s) & (force.time_s < to_s)
    time_s = force.time_s[within]
    rows = np.column_stack([time_s + begin_s, force.values[within], np.degrees(rate.interpolated_at(time_s))])
    return rows.tolist()


def pushed_text(
    sensors: Sequence[str], number: int = 0, device: str = "abc", time_s: float | None = None, count: int = 100
) -> str:
    """A message of Sensor Logger: a phone that lies face up for a second, ending now."""
    end_ns = int((time.time() if time_s is None else time_s) * 1e9)
    values = {
        "gravity": {"x": 0.0, "y": 0.0, "z": GRAVITY_MPS2},
        "accelerometer": {"x": 0.1, "y": 0.0, "z": 0.0},
        "gyroscope": {"x": 0.0, "y": 0.0, "z": 0.01},
    }
    payload = [
        {"name": name, "time": end_ns - 10_000_000 * (count - 1 - i), "values": values[name]}
        for name in sensors
        for i in range(count)
    ]
    return json.dumps({"messageId": number, "sessionId": "walk", "deviceId": device, "payload": payload})


@dataclass(frozen=True)
class Served:
    """A server of this process."""

    session: LiveSession
    application: LiveApp
    port: int

    def url(self, path: str) -> str:
        return f"http://127.0.0.1:{self.port}/{path}"

    def ask(self, path: str, content: bytes | None = None, **headers: str) -> tuple[int, str, dict[str, str]]:
        """Status, text and headers of an answer."""
        address = urlsplit(self.url(path))
        connection = HTTPConnection(str(address.hostname), address.port, timeout=20.0)
        method = "GET" if content is None else "POST"
        place = address.path + (f"?{address.query}" if address.query else "")
        with closing(connection):
            with suppress(BrokenPipeError, ConnectionResetError):  # refused before all was sent: the answer is there
                named = {name.replace("_", "-"): text for name, text in headers.items()}
                connection.request(method, place, content, named)
            answer = connection.getresponse()
            return answer.status, answer.read().decode(), dict(answer.headers)


@contextmanager
def served(session: LiveSession) -> Iterator[Served]:
    """Serve a walk on a free port, in a thread."""
    application = LiveApp(session, PushedMessages(session), PAGE, PUSH)
    listening = listen_on("127.0.0.1", 0)
    port = listening.getsockname()[1]
    over = threading.Event()
    session.start()

    async def until() -> None:
        await asyncio.to_thread(over.wait)

    ports = [Port(application.pages(), listening, application.knows)]
    serving = serve_ports(ports, session.limits, session.stop, until())
    thread = threading.Thread(target=asyncio.run, args=(serving,))
    thread.start()
    try:
        yield Served(session, application, port)
    finally:
        ended(session)
        over.set()
        thread.join(30.0)
        listening.close()
