"""Marginal covariances by elimination against those of GTSAM itself."""

from dataclasses import replace

import gtsam
import numpy as np
import pytest
from estimator_walks import DEVICE, fix, heading_prior, simulate, winding

from pdr_est.estimators.common.timeline import build_timeline
from pdr_est.estimators.factor_graph.factors import add_anchors, add_motion, motion_noise
from pdr_est.estimators.factor_graph.initial_values import initial_states
from pdr_est.estimators.factor_graph.keys import GraphKeys
from pdr_est.estimators.factor_graph.marginals import marginal_covariances
from pdr_est.types.measurements import LoopClosure, StartPose


@pytest.mark.parametrize("with_references", [False, True])
@pytest.mark.parametrize("closed", [False, True])
def test_they_are_those_of_gtsam(closed: bool, with_references: bool) -> None:
    rng = np.random.default_rng(2)
    walk = simulate(rng, 2.0 * winding(15, rng), fix_every=6, sigma_fix_m=0.3)
    priors = [replace(heading_prior(k, walk.truth[k, 2] - 1.0), relative=True) for k in (2, 7, 13)]
    measurements = [
        *walk.measurements,
        fix(3.4, 2.0, 0.1),
        *(priors if with_references else []),
        *([LoopClosure(DEVICE, 0.5)] if closed else []),
    ]
    timeline = build_timeline(DEVICE, 0.0, measurements)
    start = StartPose((0.0, 0.0), 0.0, 0.1, 0.1)
    states = initial_states([timeline], [], [start], 0.1)[0]
    keys = GraphKeys.of_timelines([timeline])
    assert keys.present_references == ([len(timeline.nodes)] if with_references else [])
    graph = gtsam.NonlinearFactorGraph()
    add_anchors(graph, [timeline], keys, [start], [states])
    add_motion(graph, timeline.nodes, 0, motion_noise(timeline.nodes).models, 1.0)
    values = gtsam.Values()
    for i, state in enumerate(states):
        values.insert(i, gtsam.Pose2(*state.mean[:3]))
    for key in keys.present_references:
        values.insert(key, gtsam.Pose2(0.0, 0.0, 1.0))
    order = [*reversed(range(keys.poses)), *keys.present_references]
    found = marginal_covariances(graph.linearize(values), order)
    exact = gtsam.Marginals(graph, values)
    assert sorted(found) == sorted(order)
    for key in range(len(order)):
        expected = exact.marginalCovariance(key)
        np.testing.assert_allclose(found[key], expected, atol=1e-6 * np.abs(expected).max())


def test_variables_of_other_sizes_and_variables_that_are_eliminated_before() -> None:
    """Two poses, a landmark seen from both, and a pose that is not asked for."""
    graph, values = gtsam.NonlinearFactorGraph(), gtsam.Values()
    tight = gtsam.noiseModel.Isotropic.Sigma(3, 0.1)
    graph.add(gtsam.PriorFactorPose2(0, gtsam.Pose2(), tight))
    graph.add(gtsam.BetweenFactorPose2(0, 1, gtsam.Pose2(1.0, 0.0, 0.2), tight))
    graph.add(gtsam.BetweenFactorPose2(1, 3, gtsam.Pose2(0.5, 0.0, 0.0), tight))
    for key, range_m in ((0, 2.0), (1, 1.5), (3, 1.3)):
        graph.add(gtsam.RangeFactor2D(key, 2, range_m, gtsam.noiseModel.Isotropic.Sigma(1, 0.2)))
    graph.add(gtsam.PriorFactorPoint2(2, np.array([1.0, 1.5]), gtsam.noiseModel.Isotropic.Sigma(2, 1.0)))
    for key, pose in ((0, gtsam.Pose2()), (1, gtsam.Pose2(1.0, 0.0, 0.2)), (3, gtsam.Pose2(1.5, 0.1, 0.2))):
        values.insert(key, pose)
    values.insert(2, np.array([1.0, 1.5]))
    found, exact = marginal_covariances(graph.linearize(values), [1, 0, 2], [3]), gtsam.Marginals(graph, values)
    assert {key: own.shape for key, own in found.items()} == {0: (3, 3), 1: (3, 3), 2: (2, 2)}
    for key, own in found.items():
        np.testing.assert_allclose(own, exact.marginalCovariance(key), atol=1e-12)
