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
    assert len(found) == len(order)
    for key in range(len(order)):
        expected = exact.marginalCovariance(key)
        np.testing.assert_allclose(found[key], expected, atol=1e-6 * np.abs(expected).max())
