"""CPU time of the smoother against GTSAM's own optimiser on the same graph."""

import time
from collections.abc import Sequence

import gtsam
import numpy as np

from pdr_est.estimators import estimate_walk
from pdr_est.estimators.common.initial_state import starts_of
from pdr_est.estimators.common.tethers import node_tethers_between
from pdr_est.estimators.common.timeline import build_timeline
from pdr_est.estimators.factor_graph.build import build_graph
from pdr_est.estimators.factor_graph.initial_values import initial_states
from pdr_est.estimators.factor_graph.newton import CONTINUATION_FACTORS
from pdr_est.estimators.factor_graph.smoother import with_large_stack
from pdr_est.performance.odometry import SIGMA_SCALE, START, walk_of
from pdr_est.types.measurements import DeviceMeasurements, DeviceTether

_MAX_ACTIVE_SETS = 20  # solutions by bare GTSAM, each with the tethers that the last one left violated


def smoothing_seconds(steps: int, devices: int) -> dict[str, float]:
    """Measure CPU seconds of smoothing a walk, by the estimator `factor-graph` and by bare GTSAM.

    Parameters
    ----------
    steps : int
        Steps of each device.
    devices : int
        Number of devices, 1 or 2.

    Returns
    -------
    dict of str to float
        ``poses``: number of poses. ``smoothing``: all that `factor-graph` does, from the measurements to the track.
        ``start``: its part for the initial values. ``bare``: what a user of GTSAM would do with `build_graph`: build
        the graph, run the Levenberg-Marquardt optimiser with its default parameters, and compute the marginal
        covariances of all poses. For two devices the optimiser runs again and again with the tethers that are active
        then, at first softened.
        ``marginals``: its part for these covariances, 0 where GTSAM cannot compute them. ``ratio``: smoothing over
        bare.
    """
    known, tethers = walk_of(steps, devices)
    split_times_s = sorted({tether.time_s for tether in tethers})
    timelines = [build_timeline(one.device, one.start_s, one.measurements, split_times_s) for one in known]
    begin = time.process_time()
    estimate_walk("factor-graph", known, START, SIGMA_SCALE, tethers)
    smoothing_s = time.process_time() - begin
    starts, node_tethers = starts_of(timelines, START), node_tethers_between(timelines, tethers)
    begin = time.process_time()
    initial_states(timelines, node_tethers, starts, SIGMA_SCALE)
    start_s = time.process_time() - begin
    bare_s, marginals_s = with_large_stack(lambda: _bare(known, tethers))
    return {
        "poses": float(sum(len(timeline.nodes) for timeline in timelines)),
        "smoothing": smoothing_s,
        "start": start_s,
        "bare": bare_s,
        "marginals": marginals_s,
        "ratio": smoothing_s / bare_s,
    }


def _bare(known: Sequence[DeviceMeasurements], tethers: Sequence[DeviceTether]) -> tuple[float, float]:
    """Solve the public graph by GTSAM alone; return CPU seconds of everything and of the marginal covariances."""
    begin = time.process_time()
    built = build_graph(known, tethers=tethers, start=START, sigma_length_scale=SIGMA_SCALE)
    found = _optimised(built.graph, built.values) if not tethers else built.values
    for softening in CONTINUATION_FACTORS if tethers else ():
        for _ in range(_MAX_ACTIVE_SETS):
            before, built = built.active_tethers, built.with_tethers_at(found, softening)
            found = _optimised(built.graph, built.values)
            if built.active_tethers == before:
                break
    optimised = time.process_time()
    try:
        marginals = gtsam.Marginals(built.graph, found)
        np.array([marginals.marginalCovariance(key) for key in range(built.keys.poses)])
    except RuntimeError:  # long walks are too ill-conditioned for its Cholesky factorisation
        return optimised - begin, 0.0
    ended = time.process_time()
    return ended - begin, ended - optimised


def _optimised(graph: gtsam.NonlinearFactorGraph, values: gtsam.Values) -> gtsam.Values:
    return gtsam.LevenbergMarquardtOptimizer(graph, values, gtsam.LevenbergMarquardtParams()).optimize()
