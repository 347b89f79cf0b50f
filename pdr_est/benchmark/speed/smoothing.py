"""Smoothing against the bare GTSAM optimisation of the same graph from the same start."""

import time
from collections.abc import Sequence

import gtsam
import numpy as np

from pdr_est.benchmark.speed.odometry import SIGMA_SCALE, START, walk_of
from pdr_est.estimators import estimate_walk
from pdr_est.estimators.factor_graph import initial_states
from pdr_est.estimators.gtsam_factors import Keys, add_motion, anchors, motion_noise
from pdr_est.estimators.large_stack import with_large_stack
from pdr_est.estimators.motion import Moments
from pdr_est.estimators.ties import Tie, starts_of, ties_between
from pdr_est.estimators.timeline import Timeline, build_timeline
from pdr_est.records import StartPose


def smoothing_seconds(steps: int, devices: int) -> dict[str, float]:
    """CPU seconds for a walk of so many steps.

    smoothing: all of it, from measurements to a track with covariances. start: the filter that it begins with. bare:
    build the same graph in GTSAM and optimise it by its Levenberg and Marquardt method as it comes, from the same
    start, with tethers as range factors with a dead zone. marginals: GTSAM's own covariances of all poses behind
    that, NaN where it finds the system indeterminate. ratio: smoothing without the start over bare;
    ratio_with_marginals: the same over both, which is the same work.
    """
    known, tethers = walk_of(steps, devices)
    begin = time.process_time()
    estimate_walk("factor-graph", known, START, SIGMA_SCALE, tethers)
    smoothing_s = time.process_time() - begin
    moments_s = sorted({tether.time_s for tether in tethers})
    timelines = [build_timeline(one.device, one.start_s, one.measurements, moments_s) for one in known]
    starts, ties = starts_of(timelines, START), ties_between(timelines, tethers)
    begin = time.process_time()
    guesses = initial_states(timelines, ties, starts, SIGMA_SCALE)
    start_s = time.process_time() - begin
    bare_s, marginals_s = with_large_stack(lambda: _bare(timelines, ties, starts, guesses))
    own_s = smoothing_s - start_s
    return {
        "poses": float(sum(len(timeline.nodes) for timeline in timelines)),
        "smoothing": smoothing_s,
        "start": start_s,
        "bare": bare_s,
        "marginals": marginals_s,
        "ratio": own_s / bare_s,
        "ratio_with_marginals": own_s / (bare_s + marginals_s),
    }


def _bare(
    timelines: Sequence[Timeline], ties: Sequence[Tie], starts: Sequence[StartPose], guesses: Sequence[list[Moments]]
) -> tuple[float, float]:
    begin = time.process_time()
    keys = Keys.of(timelines)
    graph = anchors(timelines, keys, starts, guesses)
    values = gtsam.Values()
    for timeline, first, guess in zip(timelines, keys.first, guesses, strict=True):
        add_motion(graph, timeline.nodes, first, motion_noise(timeline.nodes).models, float(guess[-1].mean[3]))
        for i, state in enumerate(guess, first):
            values.insert(i, gtsam.Pose2(*state.mean[:3]))
    for tie in ties:
        dead_zone = gtsam.noiseModel.mEstimator.L2WithDeadZone.Create(tie.max_distance_m / tie.sigma_m)
        noise = gtsam.noiseModel.Robust.Create(dead_zone, gtsam.noiseModel.Isotropic.Sigma(1, tie.sigma_m))
        graph.add(gtsam.RangeFactorPose2(*keys.of_tie(tie), 0.0, noise))
    found = gtsam.LevenbergMarquardtOptimizer(graph, values, gtsam.LevenbergMarquardtParams()).optimize()
    optimised = time.process_time()
    try:
        marginals = gtsam.Marginals(graph, found)
        np.array([marginals.marginalCovariance(key) for key in range(keys.poses)])
    except RuntimeError:  # long walks are too ill-conditioned for its Cholesky factorisation
        return optimised - begin, float("nan")
    return optimised - begin, time.process_time() - optimised
