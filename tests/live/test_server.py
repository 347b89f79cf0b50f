"""The web application over real sockets: who gets in, what is taken, and what stays hidden."""

import json
import socket
import time
from collections.abc import Callable
from contextlib import ExitStack, suppress
from pathlib import Path

import pytest
from live_walks import PAGE, PUSH, Served, pushed_text, served
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import ClientConnection, connect

from pdr_est.io.formats.registry import read
from pdr_est.live.poses import MODES
from pdr_est.live.session import LiveSession, Message
from pdr_est.report.live_page import render_live_page

NewWalk = Callable[..., LiveSession]
ALL = ("gravity", "accelerometer", "gyroscope")


def link(server: Served, token: str = PAGE, **headers: str) -> ClientConnection:
    return connect(f"ws://127.0.0.1:{server.port}/{token}/link", additional_headers=headers, proxy=None)


def heard(page: ClientConnection, kind: str) -> Message:
    """The next message of a kind."""
    while True:
        message = json.loads(page.recv(timeout=20.0))
        if message["type"] == kind:
            return message


def end_of(page: ClientConnection) -> str:
    """Wait until the server closes the connection; return its reason."""
    try:
        while True:
            page.recv(timeout=20.0)
    except ConnectionClosed as closed:
        return "" if closed.rcvd is None else closed.rcvd.reason


@pytest.mark.parametrize(
    "path",
    ["", "page", f"{PUSH}/", "page-token", "wrong/", "wrong/report/report.html", f"{PAGE}/report/report.html"],
)
def test_without_the_token_there_is_nothing(new_walk: NewWalk, path: str) -> None:
    with served(new_walk(None)) as server:
        assert server.ask(path)[0] in (404, 405)


def test_the_page_may_run_its_own_scripts_only(new_walk: NewWalk) -> None:
    page, policy = render_live_page(MODES)
    with served(new_walk(None)) as server:
        status, text, headers = server.ask(f"{PAGE}/")
    assert (status, text) == (200, page)
    assert headers["content-security-policy"] == policy
    assert "default-src 'none'" in policy
    assert "unsafe-inline" not in policy.split("style-src")[0]
    assert headers["referrer-policy"] == "no-referrer"
    assert "http" not in page.split("<style>")[0]  # nothing is loaded from elsewhere


def test_only_the_named_files_of_the_report_are_served(new_walk: NewWalk, tmp_path: Path) -> None:
    for name in ("report.html", "secret.txt"):
        (tmp_path / name).write_text(name, encoding="utf-8")
    (tmp_path.parent / "outside.txt").write_text("outside", encoding="utf-8")
    with served(new_walk(None)) as server:
        server.application.publish_report(tmp_path, ["report.html"])
        assert server.ask(f"{PAGE}/report/report.html")[:2] == (200, "report.html")
        for path in ("secret.txt", "../outside.txt", "..%2foutside.txt", "%2e%2e/outside.txt", "/etc/passwd", ""):
            assert server.ask(f"{PAGE}/report/{path}")[0] == 404, path
        assert server.ask("wrong/report/report.html")[0] == 404


def test_pushed_messages_are_recorded_and_shown(new_walk: NewWalk, tmp_path: Path) -> None:
    with served(new_walk(tmp_path / "walk")) as server, link(server) as page:
        heard(page, "status")
        for number in range(4):
            text = pushed_text(ALL, number, time_s=server.session.epoch_s + number)
            assert server.ask(f"{PUSH}/push", text.encode())[:2] == (200, "ok")
        (phone,) = heard(page, "status")["phones"]
    assert [sensor["name"] for sensor in phone["sensors"]] == ["accelerometer", "gyroscope"]
    device = read(tmp_path / "walk" / "phone.csv").devices[0]
    assert device.rotation_rate is not None
    assert len(device.rotation_rate) == 400


@pytest.mark.parametrize(
    ("content", "status", "words"),
    [(b"nonsense", 400, "JSON"), (b"\xff\xfe{", 400, "JSON"), (b" " * 2_000_000, 413, "MiB")],
)
def test_a_bad_push_is_refused_in_words(new_walk: NewWalk, content: bytes, status: int, words: str) -> None:
    with served(new_walk(None, push_bytes=1_000_000)) as server:
        found, text, _ = server.ask(f"{PUSH}/push", content)
        assert found == status
        assert words in text
        assert server.ask(f"{PAGE}/push", content)[0] == 404  # a page's token does not push
        assert server.ask(f"{PUSH}/push", pushed_text(ALL).encode())[0] == 200  # and the next one is taken


def test_a_page_becomes_a_phone_states_positions_and_stops(new_walk: NewWalk, tmp_path: Path) -> None:
    with served(new_walk(tmp_path / "walk")) as server, link(server) as page:
        page.send(json.dumps({"type": "ping", "sent": 5.0}))
        pong = heard(page, "pong")
        assert pong["sent"] == 5.0
        assert pong["now_s"] == pytest.approx(server.session.now_s, abs=2.0)
        page.send(json.dumps({"type": "phone", "id": "a"}))
        assert heard(page, "joined")["device"] == "phone"
        rows = [[pong["now_s"] + 0.01 * i, 0.0, 0.0, 9.8, 0.0, 0.0, 0.0] for i in range(10)]
        page.send(json.dumps({"type": "motion", "rows": rows, "up": [0, 0, 1], "ios": False}))
        page.send(json.dumps({"type": "fix", "x_m": 1.0, "y_m": 2.0, "sigma_m": 0.5, "ago_s": 1.0}))
        while not (fixes := heard(page, "fixes")["fixes"]):
            pass
        assert fixes[0][1:] == [1.0, 2.0, 0.25, 0.0, 0.25]
        with link(server) as again:  # a page that comes back is the same phone, and another one is not
            again.send(json.dumps({"type": "phone", "id": "a"}))
            assert heard(again, "joined")["device"] == "phone"
            again.send(json.dumps({"type": "phone", "id": "b"}))
            assert heard(again, "joined")["device"] == "phone-2"
            assert heard(again, "status")["phones"]
        page.send(json.dumps({"type": "stop"}))
        while heard(page, "state")["state"] == "walking":
            pass
        assert server.session.ended.wait(20.0)
    assert (tmp_path / "walk" / "fixes.csv").is_file()


@pytest.mark.parametrize(
    "text",
    ["", "[]", "null", "{", "[" * 10_000, json.dumps({"type": ["fix"]}), json.dumps({"type": "motion", "rows": 1})],
)
def test_nonsense_does_no_harm(new_walk: NewWalk, text: str) -> None:
    with served(new_walk(None)) as server, link(server) as page:
        page.send(text)
        page.send(json.dumps({"type": "ping", "sent": 1}))
        assert heard(page, "pong")["sent"] == 1


@pytest.mark.parametrize(
    "message",
    [
        {"type": "fix", "x_m": "1", "y_m": 0, "sigma_m": 1, "ago_s": 0},
        {"type": "fix", "x_m": 1, "y_m": 0, "sigma_m": 0, "ago_s": 0},
        {"type": "fix"},
        {"type": "fix", "x_m": 10**400, "y_m": 0, "sigma_m": 1, "ago_s": 0},
    ],
)
def test_a_damaged_position_ends_the_connection_and_is_told(new_walk: NewWalk, message: Message) -> None:
    with served(new_walk(None)) as server:
        with link(server) as page:
            page.send(json.dumps(message))
            assert "a position" in end_of(page)
        with link(server) as page:
            assert "position" in heard(page, "notes")["notes"][0]


def test_a_direction_of_huge_numbers_does_no_harm(new_walk: NewWalk) -> None:
    with served(new_walk(None)) as server, link(server) as page:
        page.send(json.dumps({"type": "phone", "id": "a"}))
        row = [server.session.now_s, 0.1, 0.2, 9.8, 0.0, 0.0, 0.0]
        page.send(json.dumps({"type": "motion", "rows": [row], "up": [10**400, 0, 1]}))
        page.send(json.dumps({"type": "ping", "sent": 1}))
        assert heard(page, "pong")["sent"] == 1


def test_a_phone_too_many_is_told_and_its_page_stays_open(new_walk: NewWalk) -> None:
    with served(new_walk(None, phones=1)) as server, link(server) as page:
        page.send(json.dumps({"type": "phone", "id": "a"}))
        assert heard(page, "joined")["device"] == "phone"
        page.send(json.dumps({"type": "phone", "id": "b"}))
        assert "no more than 1 phone" in heard(page, "refused")["reason"]
        page.send(json.dumps({"type": "ping", "sent": 1}))
        assert heard(page, "pong")["sent"] == 1


def test_a_message_that_is_too_large_ends_the_connection(new_walk: NewWalk) -> None:
    with served(new_walk(None, message_bytes=10_000)) as server, link(server) as page:
        page.send("x" * 20_000)
        end_of(page)


def test_other_pages_and_strangers_get_no_connection(new_walk: NewWalk) -> None:
    with served(new_walk(None)) as server:
        for token, headers in (("wrong", {}), (PUSH, {}), (PAGE, {"Origin": "http://elsewhere.example"})):
            with pytest.raises((InvalidStatus, ConnectionClosed)), link(server, token, **headers) as page:
                page.recv(timeout=20.0)
        with link(server, PAGE, Origin=f"http://127.0.0.1:{server.port}") as page:
            heard(page, "status")


def test_the_number_of_pages_is_bounded(new_walk: NewWalk) -> None:
    with served(new_walk(None, pages=2)) as server:
        with link(server) as first, link(server) as second:
            heard(first, "status")
            heard(second, "status")
            with link(server) as third:
                assert end_of(third) == "too many pages are open"
        with link(server) as fourth:
            heard(fourth, "status")


def idle(server: Served, begin: bytes = b"") -> socket.socket:
    """A connection that sends next to nothing."""
    connection = socket.create_connection(("127.0.0.1", server.port), timeout=20.0)
    connection.sendall(begin)
    return connection


@pytest.mark.parametrize("begin", [b"", b"GET /wrong/ HTTP/1.1\r\nHost: a\r\n\r\n", b"POST /wrong/pu"])
def test_who_holds_connections_without_a_token_keeps_nobody_out(new_walk: NewWalk, begin: bytes) -> None:
    limits = {"connections": 6, "strangers": 3}
    with served(new_walk(None, **limits)) as server, ExitStack() as waiting, link(server) as page:
        heard(page, "status")
        for _ in range(20):
            waiting.enter_context(idle(server, begin))
        assert server.ask(f"{PAGE}/")[0] == 200
        assert server.ask(f"{PUSH}/push", pushed_text(ALL).encode())[0] == 200
        heard(page, "status")  # the page that was open stays so


def test_a_connection_that_never_names_the_token_is_closed(new_walk: NewWalk) -> None:
    begun = b"GET /wrong/ HTTP/1.1\r\n"
    with served(new_walk(None, stranger_s=0.2)) as server, idle(server, begun) as stranger, link(server) as page:
        with suppress(ConnectionResetError):
            assert stranger.recv(10) == b""
        time.sleep(0.3)
        heard(page, "status")


def test_the_number_of_connections_is_bounded(new_walk: NewWalk) -> None:
    with served(new_walk(None, connections=3)) as server, ExitStack() as waiting:
        for _ in range(5):
            waiting.enter_context(socket.create_connection(("127.0.0.1", server.port), timeout=20.0))
        time.sleep(0.2)
        assert server.ask(f"{PAGE}/")[0] == 503
