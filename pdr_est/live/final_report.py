"""Smooth a walk when it has ended, in a process of its own, so that the server keeps answering."""

import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from pdr_est.errors import EstimationError
from pdr_est.output.atomic_output import written_files

REPORT_FILE = "report.html"
"""Name of the report among the results."""


def smooth_walk_files(
    recordings: Sequence[Path], options: Sequence[str], config_file: Path, folder: Path
) -> frozenset[str]:
    """Run `pdr-est smooth` and return the names of the files that it wrote into a folder.

    Parameters
    ----------
    recordings
        Recordings of the devices.
    options
        Its options about fixes and plans.
    config_file
        Configuration.
    folder
        Folder to make.

    Raises
    ------
    EstimationError
        If the walk cannot be smoothed; the message is that of the command.
    """
    call = [sys.executable, "-m", "pdr_est", "smooth", *map(str, recordings), "-o", str(folder), "--quiet"]
    call += ["--config", str(config_file), *options]
    done = subprocess.run(call, capture_output=True, text=True, check=False, env={**os.environ, "PYTHONUTF8": "1"})
    if done.returncode:
        last = (done.stderr.strip().splitlines() or ["it ended without a word"])[-1]
        raise EstimationError(f"the walk cannot be smoothed: {last.removeprefix('Error: ')}")
    return frozenset(written_files(folder))
