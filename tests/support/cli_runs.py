"""Runs of the command line, and what every refusal and every interruption must look like."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from pdr_est.cli import main

PROGRAM = (sys.executable, "-c", "from pdr_est.cli import main; main()")
RESULT_FILES = {"track.csv", "steps.csv", "track.tum", "track.geojson", "summary.json", "report.html"}
EARTH_FILES = {"track.kml", "track.gpx"}
"""Files that are written as well where the track can be placed on the Earth."""


def run(*arguments: object) -> Result:
    """Call `pdr-est` with these arguments; an exception that is no exit fails the test with its own traceback."""
    result = CliRunner().invoke(main, [str(argument) for argument in arguments], prog_name="pdr-est")
    if result.exception is not None and not isinstance(result.exception, SystemExit):
        raise result.exception
    return result


def refused(*arguments: object) -> str:
    """The one line on stderr of a call that must be refused with exit code 2 and without any output."""
    result = run(*arguments)
    assert result.exit_code == 2, result.output
    assert result.stdout == ""
    assert result.stderr.startswith("Error: ")
    assert result.stderr.count("\n") == 1
    assert result.stderr.endswith("\n")
    return result.stderr.removeprefix("Error: ").rstrip("\n")


def smooth_refused(recording: Path, folder: Path, *options: object) -> str:
    """The line of a refused `smooth`, which must leave neither its output folder nor a temporary one in `folder`."""
    folder.mkdir(exist_ok=True)
    before = sorted(path.name for path in folder.iterdir())
    line = refused("smooth", recording, "-o", folder / "out", *options)
    assert sorted(path.name for path in folder.iterdir()) == before
    return line


def smoothed(recording: Path, out: Path, *options: object) -> Result:
    """A `smooth` that must succeed with all its files."""
    result = run("smooth", recording, "-o", out, *options)
    assert result.exit_code == 0, result.output
    written = {path.name for path in out.iterdir() if not path.name.startswith(".")}
    assert written - EARTH_FILES - {"truth.tum"} == RESULT_FILES
    placed = json.loads((out / "summary.json").read_text(encoding="utf-8"))["on_earth"]["placed"]
    assert written & EARTH_FILES == (EARTH_FILES if placed else set())
    assert [path.name for path in out.parent.iterdir() if path.name.endswith(".partial")] == []
    return result


def _heeds_interrupts() -> None:
    """A shell that runs the tests in the background has its children ignore Ctrl-C."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def interrupt(command: Sequence[str], folder: Path, delay_s: float = 0.0) -> None:
    """Press Ctrl-C so long after a run has begun to write in a folder; it must end with a word and no traceback."""
    with subprocess.Popen(
        command,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        preexec_fn=_heeds_interrupts,
    ) as process:
        deadline = time.monotonic() + 60.0
        while not any(path.name.endswith(".partial") for path in folder.iterdir()):
            if time.monotonic() > deadline or process.poll() is not None:
                pytest.fail("the run never began to write")
            time.sleep(0.005)
        time.sleep(delay_s)
        os.killpg(process.pid, signal.SIGINT)  # a terminal sends it to all processes of a program
        stdout, stderr = process.communicate(timeout=60)
    assert (process.returncode, stdout, stderr.strip()) == (1, "", "Aborted!")
