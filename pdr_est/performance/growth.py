"""How time and memory of the smoother grow with the length of a walk."""

import multiprocessing
import time

from pdr_est.estimators import estimate_walk
from pdr_est.performance.memory import peak_mb
from pdr_est.performance.odometry import SIGMA_SCALE, START, STEP_S, walk_of


def growth(minutes: float, devices: int) -> dict[str, float]:
    """CPU seconds of smoothing a walk of that length, and by how many MB it raises the peak memory of a process:
    peak_mb, of which memory_mb are the walk's.

    The peak is that of a process's whole life, so it is one of its own. NaN where the platform does not tell.
    """
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        return pool.apply(_smoothed, (minutes, devices))


def _smoothed(minutes: float, devices: int) -> dict[str, float]:
    estimate_walk("factor-graph", walk_of(10)[0], START, SIGMA_SCALE)  # loads what is loaded at first use
    steps = round(60.0 * minutes / STEP_S)
    known, tethers = walk_of(steps, devices)
    before_mb, begin = peak_mb(), time.process_time()
    estimate_walk("factor-graph", known, START, SIGMA_SCALE, tethers)
    seconds = time.process_time() - begin
    most_mb = peak_mb()
    return {
        "steps": float(steps * devices),
        "seconds": seconds,
        "memory_mb": most_mb - before_mb,
        "peak_mb": most_mb,
    }
