"""The command: what it prints, refuses and leaves behind, also when it is killed."""

import json
import signal
import ssl
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from urllib.request import urlopen

import pytest
from click.testing import CliRunner
from live_walks import motion_rows
from two_phones import recorded
from websockets.sync.client import ClientConnection, connect

from pdr_est.cli import main
from pdr_est.cli.work.online import live
from pdr_est.io.formats.registry import read
from pdr_est.live.addresses import is_loopback, make_certificate, new_token, qr_code_text


@contextmanager
def running(*options: str) -> Iterator[tuple[subprocess.Popen[str], str]]:
    """Run the command on a free port; give its process and the address of its page."""
    call = (sys.executable, "-m", "pdr_est", "live", "--port", "0", *options)
    with subprocess.Popen(call, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout is not None
            line = process.stdout.readline()
            assert line.startswith("page: "), process.communicate()
            yield process, line.removeprefix("page: ").strip()
        finally:
            process.kill()


def link(address: str) -> ClientConnection:
    return connect(f"{address.replace('http', 'ws')}link", proxy=None)


def now_of(page: ClientConnection) -> float:
    """Ask for the time of the walk, s."""
    page.send(json.dumps({"type": "ping", "sent": 0}))
    while (pong := json.loads(page.recv(timeout=20.0)))["type"] != "pong":
        pass
    return float(pong["now_s"])


def test_a_killed_server_keeps_what_it_had_received(tmp_path: Path) -> None:
    out, count = tmp_path / "out", 0
    with running("-o", str(out)) as (process, address), link(address) as page:
        page.send(json.dumps({"type": "phone", "id": "a"}))
        begin_s = now_of(page) - 20.0
        for second in range(20):
            rows = motion_rows(recorded(1).devices[0], begin_s, second, second + 1.0)
            page.send(json.dumps({"type": "motion", "rows": rows}))
            count += len(rows)
        now_of(page)  # by now the rows have been taken
        process.kill()
    device = read(out / "phone.csv").devices[0]
    assert device.specific_force is not None
    assert len(device.specific_force) == count


@pytest.mark.slow
def test_an_interrupt_ends_the_walk_and_a_second_one_the_server(tmp_path: Path) -> None:
    with running("-o", str(tmp_path / "out")) as (process, address):
        with urlopen(address, timeout=20.0) as page:
            assert page.status == 200
        process.send_signal(signal.SIGINT)
        time.sleep(1.0)
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=30.0)
        assert process.returncode == 0
        assert "nothing was received" in errors
        assert "Traceback" not in errors


@pytest.mark.slow
def test_a_request_to_end_ends_everything(tmp_path: Path) -> None:
    with running("-o", str(tmp_path / "out")) as (process, address):
        with urlopen(address, timeout=20.0) as page:
            assert page.status == 200
        process.send_signal(signal.SIGTERM)
        process.communicate(timeout=30.0)
        assert process.returncode == 0


def test_others_reach_the_page_encrypted_only(tmp_path: Path) -> None:
    with running("-o", str(tmp_path / "out"), "--host", "0.0.0.0") as (process, address):
        assert address.startswith("https://")
        port = address.split(":")[2].split("/")[0]
        assert process.stdout is not None
        process.stdout.readline()
        push = process.stdout.readline().removeprefix("push: ").strip()
        assert push.startswith("http://")
        trusting = ssl.create_default_context()
        trusting.check_hostname, trusting.verify_mode = False, ssl.CERT_NONE
        token = address.split("/")[3]
        with urlopen(f"https://127.0.0.1:{port}/{token}/", context=trusting, timeout=20.0) as page:
            assert b"Live walk" in page.read()


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--replay", "absent.csv"], "absent.csv"),
        (["--replay", "x.csv", "--phyphox", "1.2.3.4"], "leave out --phyphox"),
        (["--fixes", "points.csv"], "only the word recording"),
        (["--speed", "0"], "--speed"),
        (["--host", "192.0.2.1"], "cannot be opened"),
        (["-o", "."], "exists already"),
    ],
)
def test_what_cannot_be_is_refused_in_words(
    options: list[str], words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    result = CliRunner().invoke(main, ["live", "--port", "0", *options])
    assert result.exit_code == 2
    assert words in result.output


@pytest.mark.parametrize("refused", [["--host", "192.0.2.1"], ["--phyphox", "http://[::1"]])
def test_what_is_refused_leaves_no_folder(refused: list[str], tmp_path: Path) -> None:
    """The same call works once the port is free: OUT must be new."""
    out = tmp_path / "out"
    assert CliRunner().invoke(main, ["live", "--port", "0", "-o", str(out), *refused]).exit_code == 2
    assert not out.exists()


def test_without_the_extra_the_command_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(live, "find_spec", lambda name: None if name == "uvicorn" else object())
    result = CliRunner().invoke(main, ["live"])
    assert result.exit_code == 2
    assert "needs uvicorn: install pdr-est[live]" in result.output


def test_addresses_are_secret_and_short_enough_to_scan() -> None:
    assert new_token() != new_token()
    assert len(new_token()) >= 20
    drawing = qr_code_text(f"https://192.168.100.100:8765/{new_token()}/")
    assert max(map(len, drawing.splitlines())) < 200
    assert [is_loopback(host) for host in ("127.0.0.1", "::1", "localhost", "0.0.0.0", "10.0.0.1", "name")] == [
        True,
        True,
        True,
        False,
        False,
        False,
    ]


def test_the_certificate_is_for_this_computer(tmp_path: Path) -> None:
    from cryptography import x509

    certificate, key = make_certificate(tmp_path, ["192.168.0.7", "localhost"])
    made = x509.load_pem_x509_certificate(certificate.read_bytes())
    names = made.extensions.get_extension_for_class(x509.SubjectAlternativeName).value
    assert [str(one) for one in names.get_values_for_type(x509.IPAddress)] == ["192.168.0.7"]
    ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER).load_cert_chain(certificate, key)
