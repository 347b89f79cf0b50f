"""A program that is asked to end, as by `kill` or a closed terminal, leaves nothing half-written."""

import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from cli_runs import PROGRAM

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="no such signals")


def wait_for_writing(folder: Path, process: "subprocess.Popen[str]") -> None:
    deadline = time.monotonic() + 60.0
    while not any(path.name.endswith(".partial") for path in folder.iterdir()):
        if time.monotonic() > deadline or process.poll() is not None:
            pytest.fail("the run never began to write")
        time.sleep(0.005)


@pytest.mark.parametrize("name", ["SIGTERM", pytest.param("SIGHUP", marks=pytest.mark.slow)])
def test_a_request_to_end_leaves_everything_as_it_was(name: str, good: Path, tmp_path: Path) -> None:
    command = (*PROGRAM, "smooth", str(good), "-o", str(tmp_path / "out"), "-q")
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as process:
        wait_for_writing(tmp_path, process)
        process.send_signal(getattr(signal, name))
        _, stderr = process.communicate(timeout=60)
    assert (process.returncode, stderr) == (128 + getattr(signal, name), "")
    assert list(tmp_path.iterdir()) == []


def test_a_live_walk_that_is_ended_keeps_its_estimates(tmp_path: Path) -> None:
    output = tmp_path / "lines.jsonl"
    command = (*PROGRAM, "track", "-", "-o", str(output))
    message = '{"deviceId": "a", "payload": [{"name": "gyroscope", "time": 1, "values": {"x": 0, "y": 0, "z": 0}}]}\n'
    with subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        wait_for_writing(tmp_path, process)
        assert process.stdin is not None
        process.stdin.write(message)
        process.stdin.flush()
        time.sleep(0.3)
        process.send_signal(signal.SIGTERM)
        _, stderr = process.communicate(timeout=60)
    assert process.returncode == 0, stderr
    assert [path.name for path in tmp_path.iterdir()] == ["lines.jsonl"]
