"""Smoothing against the bare GTSAM solution of the same graph."""

import time
from collections.abc import Sequence

import gtsam
import numpy as np

from pdr_est.estimators.common.initial_state import starts_of
from pdr_est.estimators.common.motion_model import STATES, GaussianState
from pdr_est.estimators.common.tethers import NodeTether, node_tethers_between
from pdr_est.estimators.common.timeline import Timeline, build_timeline
from pdr_est.estimators.factor_graph import smoother as factor_graph
from pdr_est.estimators.factor_graph.deep_stack import with_large_stack
from pdr_est.estimators.factor_graph.factors import Keys, add_motion, anchors, displacement, motion_noise
from pdr_est.estimators.factor_graph.initial_values import initial_states
from pdr_est.performance.odometry import SIGMA_SCALE, START, walk_of
from pdr_est.types.measurements import StartPose


def smoothing_seconds(steps: int, devices: int) -> dict[str, float]:
    """CPU seconds for a walk of so many steps, both ways from the same timelines on.

    smoothing: all that `factor-graph` does, the filter that it starts from, the length scale's part, the tethers
    between tethers and the track included; start: the filter's part of it. bare: what a user of GTSAM would write:
    build the same graph, values to start from by composing the odometry, Levenberg and Marquardt's optimiser as it
    comes, and the marginal covariances of all poses; tethers are range factors with a dead zone. marginals: the last
    part of it. Where GTSAM finds the system indeterminate its covariances count as no work, in its favour. ratio:
    smoothing over bare.
    """
    known, tethers = walk_of(steps, devices)
    split_times_s = sorted({tether.time_s for tether in tethers})
    timelines = [build_timeline(one.device, one.start_s, one.measurements, split_times_s) for one in known]
    begin = time.process_time()
    factor_graph.estimate(timelines, tethers, START, SIGMA_SCALE)
    smoothing_s = time.process_time() - begin
    starts, node_tethers = starts_of(timelines, START), node_tethers_between(timelines, tethers)
    begin = time.process_time()
    initial_states(timelines, node_tethers, starts, SIGMA_SCALE)
    start_s = time.process_time() - begin
    bare_s, marginals_s = with_large_stack(lambda: _bare(timelines, node_tethers, starts))
    return {
        "poses": float(sum(len(timeline.nodes) for timeline in timelines)),
        "smoothing": smoothing_s,
        "start": start_s,
        "bare": bare_s,
        "marginals": marginals_s,
        "ratio": smoothing_s / bare_s,
    }


def _bare(
    timelines: Sequence[Timeline], node_tethers: Sequence[NodeTether], starts: Sequence[StartPose]
) -> tuple[float, float]:
    begin = time.process_time()
    keys, guesses = Keys.of(timelines), [_known_start(timeline) for timeline in timelines]
    graph, values = anchors(timelines, keys, starts, guesses), gtsam.Values()
    for timeline, first in zip(timelines, keys.first, strict=True):
        add_motion(graph, timeline.nodes, first, motion_noise(timeline.nodes).models, 1.0)
        pose = gtsam.Pose2()
        values.insert(first, pose)
        for i, node in enumerate(timeline.nodes[1:], first + 1):
            pose = pose.compose(displacement(node, 1.0))
            values.insert(i, pose)
    for node_tether in node_tethers:
        dead_zone = gtsam.noiseModel.mEstimator.L2WithDeadZone.Create(
            node_tether.max_distance_m / node_tether.sigma_m
        )
        noise = gtsam.noiseModel.Robust.Create(dead_zone, gtsam.noiseModel.Isotropic.Sigma(1, node_tether.sigma_m))
        graph.add(gtsam.RangeFactorPose2(*keys.of_node_tether(node_tether), 0.0, noise))
    found = gtsam.LevenbergMarquardtOptimizer(graph, values, gtsam.LevenbergMarquardtParams()).optimize()
    optimised = time.process_time()
    try:
        marginals = gtsam.Marginals(graph, found)
        np.array([marginals.marginalCovariance(key) for key in range(keys.poses)])
    except RuntimeError:  # long walks are too ill-conditioned for its Cholesky factorisation
        return optimised - begin, 0.0
    ended = time.process_time()
    return ended - begin, ended - optimised


def _known_start(timeline: Timeline) -> list[GaussianState]:
    at_start = GaussianState(np.zeros(STATES), np.zeros((STATES, STATES)))
    return [at_start] * len(timeline.nodes)
