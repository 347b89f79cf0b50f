"""phyphox's remote access, asked by a phone's stand-in over a real socket."""

import json
import socket
import threading
import time
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any
from urllib.parse import parse_qsl, urlsplit

import numpy as np
import pytest
from live_walks import ended

from pdr_est.errors import ConfigError, RecordingError
from pdr_est.io.formats.registry import read
from pdr_est.live.receivers.phyphox import PhyphoxPhone, sensor_buffers

CONFIG = {
    "title": "raw",
    "inputs": [
        {"source": "accelerometer", "outputs": [{"x": "ax"}, {"y": "ay"}, {"z": "az"}, {"t": "at"}]},
        {"source": "gyroscope", "outputs": [{"x": "gx"}, {"y": "gy"}, {"z": "gz"}, {"abs": "g"}, {"t": "gt"}]},
        {"source": "light", "outputs": [{"x": "lux"}]},
    ],
}


class Phone:
    """A phone that measures at 100 Hz since it was made, and the questions that it was asked."""

    def __init__(self) -> None:
        self.begun_s, self.session, self.measuring = time.monotonic(), "a1", True
        self.questions: list[dict[str, str]] = []

    def answer(self, path: str) -> Any:
        parts = urlsplit(path)
        if parts.path == "/config":
            return CONFIG
        self.questions.append(dict(parse_qsl(parts.query)))
        buffers = {
            name: {"size": 0, "buffer": self.buffer(name, since)} for name, since in self.questions[-1].items()
        }
        return {"buffer": buffers, "status": {"session": self.session, "measuring": self.measuring}}

    def buffer(self, name: str, since: str) -> list[float | None]:
        times = np.round(np.arange(0.0, time.monotonic() - self.begun_s, 0.01), 8)
        if since != "full":
            times = times[times > float(since.partition("|")[0])]
        if name in ("at", "gt"):
            return times.tolist()
        values: list[float | None] = np.full(len(times), 9.8 if name == "az" else 0.01).tolist()
        return [
            None if name == "gx" and time_s == 0.05 else value for time_s, value in zip(times, values, strict=True)
        ]


@pytest.fixture
def phone() -> Iterator[tuple[Phone, str]]:
    """A phone with its address."""
    stand_in = Phone()

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            content = json.dumps(stand_in.answer(self.path)).encode()
            self.send_response(200)
            self.send_header("Content-Length", str(len(content)))
            self.end_headers()
            self.wfile.write(content)

        def log_message(self, *_: object) -> None:
            """Quiet."""

    with ThreadingHTTPServer(("127.0.0.1", 0), Handler) as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        yield stand_in, f"127.0.0.1:{server.server_address[1]}"
        server.shutdown()
        thread.join()


def test_every_sample_comes_once(new_walk: Any, tmp_path: Path, phone: tuple[Phone, str]) -> None:
    stand_in, address = phone
    session = new_walk(tmp_path / "walk")
    polled = PhyphoxPhone(session, address)
    session.start()
    polled.start()
    time.sleep(1.5)
    now_s = session.now_s
    ended(session)
    device = read(tmp_path / "walk" / "phone.csv").devices[0]
    force, rate = device.specific_force, device.rotation_rate
    assert force is not None
    assert rate is not None
    np.testing.assert_allclose(np.diff(force.time_s), 0.01, atol=1e-6)
    assert len(rate) in (len(force) - 1, len(force) - 2)  # without the one that the phone does not know
    assert len(force) > 60
    assert force.time_s[-1] == pytest.approx(now_s, abs=1.0)
    assert stand_in.questions[0]["ax"] == "full"
    assert stand_in.questions[-1]["ax"].endswith("|at")


def test_samples_after_a_restart_are_taken(new_walk: Any, tmp_path: Path, phone: tuple[Phone, str]) -> None:
    stand_in, address = phone
    session = new_walk(tmp_path / "walk")
    polled = PhyphoxPhone(session, address)
    session.start()
    polled.start()
    time.sleep(0.7)
    stand_in.begun_s, stand_in.session = time.monotonic(), "b2"
    time.sleep(0.9)
    ended(session)
    force = read(tmp_path / "walk" / "phone.csv").devices[0].specific_force
    assert force is not None
    assert (np.diff(force.time_s) > 0.0).all()
    assert force.time_s[-1] - force.time_s[0] > 1.0


def test_a_phone_that_does_not_measure_is_told(new_walk: Any, phone: tuple[Phone, str]) -> None:
    stand_in, address = phone
    stand_in.measuring = False
    session = new_walk(None)
    polled = PhyphoxPhone(session, address)
    session.start()
    polled.start()
    time.sleep(0.5)
    assert any("press play" in words for words in session.status()["missing"])
    ended(session)


def test_a_phone_that_does_not_answer_is_told(new_walk: Any) -> None:
    session = new_walk(None)
    polled = PhyphoxPhone(session, "127.0.0.1:9")
    session.start()
    polled.start()
    time.sleep(0.5)
    assert any("no answer" in words for words in session.status()["missing"])
    ended(session)


@pytest.mark.parametrize(
    "address",
    ["ftp://phone", "file:///etc/passwd", "http://", "http://[::1", "phone:808080", "phone:x", "a b", "phone\n:80"],
)
def test_other_addresses_are_refused(new_walk: Any, address: str) -> None:
    with pytest.raises(ConfigError, match="--phyphox"):
        PhyphoxPhone(new_walk(None), address)


@pytest.mark.parametrize("config", [None, [], {}, {"inputs": 1}])
def test_other_descriptions_are_refused(config: object) -> None:
    with pytest.raises(RecordingError, match="phyphox"):
        sensor_buffers(config)


def test_a_server_that_speaks_something_else_is_told_and_asked_again(new_walk: Any) -> None:
    """An answer that is no HTTP does not end the asking."""
    asked = []
    with socket.create_server(("127.0.0.1", 0)) as listening:

        def talk() -> None:
            for _ in range(2):
                connection, _ = listening.accept()
                with connection:
                    asked.append(connection.recv(4096))
                    connection.sendall(b"220 mail.example ready\r\n")

        thread = threading.Thread(target=talk)
        thread.start()
        session = new_walk(None)
        polled = PhyphoxPhone(session, f"127.0.0.1:{listening.getsockname()[1]}")
        session.start()
        polled.start()
        thread.join(timeout=20.0)
        assert any("no answer" in words for words in session.status()["missing"])
        ended(session)
    assert len(asked) == 2


@pytest.mark.parametrize("outputs", [5, "x", [5], [None], {"x": "ax"}])
def test_a_damaged_description_has_no_sensor(outputs: object) -> None:
    assert sensor_buffers({"inputs": [{"source": "accelerometer", "outputs": outputs}]}) == ()


def test_an_experiment_without_times_has_no_sensor() -> None:
    outputs = [{"x": "ax"}, {"y": "ay"}, {"z": "az"}]
    assert sensor_buffers({"inputs": [{"source": "accelerometer", "outputs": outputs}, 5, {"source": 3}]}) == ()
