"""Memory of this process, in MB of 2**20 bytes."""

import sys
from pathlib import Path

_STATUS = Path("/proc/self/status")  # of Linux


def resident_mb() -> float:
    """Return the resident memory, MB; NaN where the platform does not report it."""
    return _status_mb("VmRSS:")


def peak_mb() -> float:
    """Return the peak memory so far, MB; NaN where the platform does not report it.

    On Linux `ru_maxrss` of a process includes the memory of its parent at the start, which hides the need of a small
    process; the status file does not.
    """
    found = _status_mb("VmHWM:")
    if found == found or sys.platform == "win32":
        return found
    import resource  # of POSIX only

    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return float(peak / (2**20 if sys.platform == "darwin" else 2**10))


def _status_mb(name: str) -> float:
    try:
        lines = _STATUS.read_text(encoding="ascii").splitlines()
    except OSError:
        return float("nan")
    found = next((line for line in lines if line.startswith(name)), None)
    return float("nan") if found is None else float(found.split()[1]) / 2**10
