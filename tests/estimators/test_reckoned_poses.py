"""Dead reckoning of all poses at once against the motion model step by step."""

from dataclasses import replace

import numpy as np
import pytest
from estimator_walks import DEVICE, simulate, winding

from pdr_est.estimators.common.motion_model import STATES, GaussianState, reckon
from pdr_est.estimators.common.timeline import build_timeline
from pdr_est.estimators.reckoned_poses import reckon_means, reckon_poses


@pytest.mark.parametrize("anchor", [0, 17, 40])
def test_it_is_the_motion_model_in_both_directions(anchor: int) -> None:
    rng = np.random.default_rng(3)
    root = rng.normal(size=(STATES, STATES))
    skewed = np.array([[0.02, 0.004, 0.001], [0.004, 0.03, 0.006], [0.001, 0.006, 0.01]])
    steps = [replace(step, covariance=skewed) for step in simulate(rng, 3.0 * winding(40, rng)).odometry]
    nodes = build_timeline(DEVICE, 0.0, steps).nodes
    state = GaussianState(np.array([5e5, -20.0, 1.0, 0.1, 0.4]), root @ root.T)
    pose, covariance = reckon_poses(nodes, anchor, state)
    expected = reckon(nodes, anchor, state)
    assert pose == pytest.approx(np.array([one.mean[:3] for one in expected]), abs=1e-9)
    assert covariance == pytest.approx(np.array([one.covariance[:3, :3] for one in expected]), rel=1e-9, abs=1e-9)
    if anchor == 0:
        assert reckon_means(nodes, state.mean) == pytest.approx(np.array([one.mean for one in expected]), abs=1e-9)
