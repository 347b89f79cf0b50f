"""Locks between programs: one at a time, nothing left behind, and no program waits for a dead one."""

import subprocess
import sys
import time
from pathlib import Path

import pytest

from pdr_est.errors import OutputError
from pdr_est.output.file_lock import locked

HOLDER = """
import sys, time
from pathlib import Path
from pdr_est.output.file_lock import locked
with locked(Path(sys.argv[1])):
    print("held", flush=True)
    time.sleep(float(sys.argv[2]))
"""


def holder(target: Path, for_s: float) -> "subprocess.Popen[str]":
    """Another program that holds the lock."""
    process = subprocess.Popen(
        (sys.executable, "-c", HOLDER, str(target), str(for_s)), stdout=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "held\n"
    return process


def test_another_program_waits_until_the_block_ends(tmp_path: Path) -> None:
    with holder(tmp_path / "file", 0.7):
        begun = time.monotonic()
        with locked(tmp_path / "file"):
            assert time.monotonic() - begun > 0.3
    assert list(tmp_path.iterdir()) == []


def test_a_killed_program_holds_nothing(tmp_path: Path) -> None:
    with holder(tmp_path / "file", 60.0) as process:
        process.kill()
        process.wait()
        with locked(tmp_path / "file"):
            pass
    assert list(tmp_path.iterdir()) == []


def test_the_lock_ends_with_an_error(tmp_path: Path) -> None:
    with pytest.raises(KeyError), locked(tmp_path / "file"):
        raise KeyError
    with locked(tmp_path / "file"):
        pass


def test_a_folder_that_is_missing(tmp_path: Path) -> None:
    with (
        pytest.raises(OutputError, match=r"file: cannot be locked .*: choose a file elsewhere"),
        locked(tmp_path / "nowhere" / "file"),
    ):
        pass
