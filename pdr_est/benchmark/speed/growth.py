"""How time and memory of the smoother grow with the length of a walk."""

import multiprocessing
import sys
import time

from pdr_est.benchmark.speed.odometry import SIGMA_SCALE, START, STEP_S, walk_of
from pdr_est.estimators import estimate_walk


def growth(minutes: float, devices: int) -> dict[str, float]:
    """CPU seconds of smoothing a walk of that length, and by how many MB it raises the peak memory of a process.

    The peak is that of a process's whole life, so it is one of its own. NaN where the platform does not tell.
    """
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        return pool.apply(_smoothed, (minutes, devices))


def _smoothed(minutes: float, devices: int) -> dict[str, float]:
    estimate_walk("factor-graph", walk_of(10)[0], START, SIGMA_SCALE)  # loads what is loaded at first use
    steps = round(60.0 * minutes / STEP_S)
    known, tethers = walk_of(steps, devices)
    before_mb, begin = _peak_mb(), time.process_time()
    estimate_walk("factor-graph", known, START, SIGMA_SCALE, tethers)
    seconds = time.process_time() - begin
    return {"steps": float(steps * devices), "seconds": seconds, "memory_mb": _peak_mb() - before_mb}


def _peak_mb() -> float:
    if sys.platform == "win32":
        return float("nan")
    import resource  # of POSIX only

    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return float(peak / (2**20 if sys.platform == "darwin" else 2**10))
