"""Growth of time and memory of the smoother with the length of a walk."""

import multiprocessing
import time

from pdr_est.estimators import estimate_walk
from pdr_est.performance.memory import peak_mb
from pdr_est.performance.odometry import SIGMA_SCALE, START, STEP_S, walk_of


def growth(minutes: float, devices: int) -> dict[str, float]:
    """Measure the CPU time and the memory of smoothing a walk, in a process of its own.

    Parameters
    ----------
    minutes : float
        Length of the walk.
    devices : int
        Number of devices.

    Returns
    -------
    dict
        steps, seconds (CPU time), peak_mb (peak memory of the process) and memory_mb (part of it that the walk
        needs); NaN where the platform does not report memory.
    """
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        return pool.apply(_measure_smoothing, (minutes, devices))


def _measure_smoothing(minutes: float, devices: int) -> dict[str, float]:
    estimate_walk("factor-graph", walk_of(10)[0], START, SIGMA_SCALE)  # imports what is imported at first use
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
