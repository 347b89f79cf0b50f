"""The filter's use of filterpy, whose defaults turn wrong shapes into wrong numbers without a word."""

import numpy as np
import pytest
from estimator_walks import DEVICE, fix, heading_prior, simulate, winding

from pdr_est.estimators.common.motion_model import SOURCE_STATES, STATES, GaussianState, linearise, move
from pdr_est.estimators.common.timeline import Timeline, build_timeline
from pdr_est.estimators.kalman import ekf, rts_smoother
from pdr_est.estimators.kalman.offline_filter import run_filter
from pdr_est.estimators.reckoned_poses import reckon
from pdr_est.types.measurements import StartPose


def timeline() -> Timeline:
    rng = np.random.default_rng(1)
    walk = simulate(rng, winding(40, rng), fix_every=10)
    return build_timeline(DEVICE, 0.0, [*walk.measurements, fix(12.5, 8, 0, robust=True), heading_prior(20, 0.1)])


@pytest.mark.parametrize("start", [StartPose(), StartPose((0.0, 0.0), 0.0, 0.1, 0.1)], ids=["unknown", "known"])
def test_states_stay_one_dimensional_and_covariances_symmetric(start: StartPose) -> None:
    walk = timeline()
    (filtered,) = run_filter(walk, start, 0.1)
    assert filtered.pose.shape == (len(walk.nodes), 3)
    assert filtered.covariance.shape == (len(walk.nodes), 3, 3)
    for state in filtered.states:
        assert state.mean.shape == (STATES + SOURCE_STATES * len(state.sources),)
        assert state.covariance.shape == (len(state.mean),) * 2
        assert np.array_equal(state.covariance, state.covariance.T)
        assert np.linalg.eigvalsh(state.covariance)[0] >= 0.0
        assert np.linalg.eigvalsh(state.covariance[:STATES, :STATES])[0] > 0.0


def test_states_are_snapshots_not_views_of_the_running_filter() -> None:
    (filtered,) = run_filter(timeline(), StartPose((0.0, 0.0), 0.0, 0.1, 0.1), 0.1)
    assert filtered.states[0].mean[0] < 1.0 < filtered.states[-1].mean[0]
    assert filtered.states[0].covariance[0, 0] < filtered.states[9].covariance[0, 0]


def test_input_records_are_left_as_they_were() -> None:
    robust = fix(5, 100.0, 0.0, robust=True)
    walk = build_timeline(DEVICE, 0.0, [*simulate(np.random.default_rng(2), np.zeros(10)).odometry, robust])
    before = [node.covariance.copy() for node in walk.nodes]
    start = StartPose((0.0, 0.0), 0.0, 0.1, 0.1)
    first, second = ekf.estimate([walk], (), start, 0.1), ekf.estimate([walk], (), start, 0.1)
    assert np.array_equal(first.position_m, second.position_m)
    assert np.array_equal(robust.covariance_m2, 0.25 * np.eye(2))
    assert all(np.array_equal(node.covariance, old) for node, old in zip(walk.nodes, before, strict=True))


def test_jacobian_is_the_derivative_of_the_motion() -> None:
    node = timeline().nodes[7]
    state = np.array([3.0, 4.0, 2.0, 1.1, 0.2])
    jacobian, _ = linearise(state, node)
    numeric = [(move(state + h, node) - move(state - h, node)) / 2e-6 for h in 1e-6 * np.eye(5)]
    assert jacobian == pytest.approx(np.array(numeric).T, abs=1e-8)


def test_reckoning_back_undoes_reckoning_but_for_the_noise() -> None:
    nodes = timeline().nodes[6:8]
    before = GaussianState(np.array([3.0, 4.0, 2.0, 1.1, 0.2]), np.diag([0.1, 0.2, 0.03, 0.01, 0.3]))
    again = reckon(nodes, 1, reckon(nodes, 0, before)[1])[0]
    assert again.mean == pytest.approx(before.mean, abs=1e-12)
    jacobian, noise = linearise(before.mean, nodes[1])
    back = np.linalg.inv(jacobian)
    assert again.covariance == pytest.approx(before.covariance + 2.0 * back @ noise @ back.T, abs=1e-12)


def test_reckoning_from_any_node_gives_the_same_walk() -> None:
    nodes = timeline().nodes
    forwards = reckon(nodes, 0, GaussianState(np.array([3.0, 4.0, 2.0, 1.1, 0.2]), np.zeros((5, 5))))
    from_middle = reckon(nodes, 20, forwards[20])
    assert len(from_middle) == len(nodes)
    for one, other in zip(forwards, from_middle, strict=True):
        assert one.mean == pytest.approx(other.mean, abs=1e-9)


def test_smoothing_one_state_leaves_it() -> None:
    one = GaussianState(np.zeros(5), np.eye(5))
    assert rts_smoother.smooth(timeline().nodes[:1], (one,)) == [one]
