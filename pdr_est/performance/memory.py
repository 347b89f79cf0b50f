"""Memory of this process, in MB of 2**20 bytes: what it has now, and the most that it ever had."""

import sys
from pathlib import Path

_STATUS = Path("/proc/self/status")  # of Linux


def resident_mb() -> float:
    """Now. NaN where the platform does not tell."""
    return _of_status("VmRSS:")


def peak_mb() -> float:
    """The most so far. NaN where the platform does not tell.

    Linux counts into the `ru_maxrss` of a process what its parent had when it began, which hides what a small one
    needs; its status file does not.
    """
    found = _of_status("VmHWM:")
    if found == found or sys.platform == "win32":
        return found
    import resource  # of POSIX only

    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return float(peak / (2**20 if sys.platform == "darwin" else 2**10))


def _of_status(name: str) -> float:
    try:
        lines = _STATUS.read_text(encoding="ascii").splitlines()
    except OSError:
        return float("nan")
    found = next((line for line in lines if line.startswith(name)), None)
    return float("nan") if found is None else float(found.split()[1]) / 2**10
