"""The joint model of fixes and steps against independent computations."""

import numpy as np
import pytest
from estimator_walks import DEVICE, simulate, winding
from scipy.stats import multivariate_normal

from pdr_est.estimators.common.motion_model import STATES, GaussianState
from pdr_est.estimators.common.timeline import Timeline, build_timeline
from pdr_est.estimators.fix_checks.dead_reckoned_path import DeadReckonedPath, ReckonedPoints
from pdr_est.estimators.fix_checks.position_regression import UNKNOWN_POSITION_M, PlacementPrior, Regression, regress
from pdr_est.estimators.reckoned_poses import reckon
from pdr_est.frames import Array

WALK = simulate(np.random.default_rng(3), winding(120, np.random.default_rng(4)) * 3.0, fix_every=9)
PRIOR = PlacementPrior(0.0, 0.3, 0.1)


def path_and_points() -> tuple[DeadReckonedPath, ReckonedPoints, Timeline]:
    path = DeadReckonedPath(0.0, WALK.odometry)
    return path, path.at(np.array([fix.time_s for fix in WALK.fixes])), build_timeline(DEVICE, 0.0, WALK.measurements)


def solved(leave_out: int | None = None) -> Regression:
    path, points, _ = path_and_points()
    keep = np.array([i for i in range(len(points)) if i != leave_out])
    own = points.rows(keep)
    fixes_m = np.array([fix.position_m for fix in WALK.fixes])[keep]
    white_m2 = np.array([fix.covariance_m2 for fix in WALK.fixes])[keep]
    return regress(fixes_m, own.position_m, path.covariance(own, own, 0), white_m2, PRIOR, 0.0)


def test_the_path_is_that_of_dead_reckoning() -> None:
    path, points, timeline = path_and_points()
    nodes = [node for node in timeline.nodes if node.fixes]
    states = reckon(timeline.nodes, 0, GaussianState(np.zeros(STATES), np.zeros((STATES, STATES))))
    at = [timeline.nodes.index(node) for node in nodes]
    np.testing.assert_allclose(points.position_m, [states[i].mean[:2] for i in at], atol=1e-9)
    np.testing.assert_allclose(path.variance(points, 0), [states[i].covariance[:2, :2] for i in at], atol=1e-9)


def test_errors_of_two_points_are_those_up_to_the_earlier_and_its_swing() -> None:
    path, points, timeline = path_and_points()
    some, others = points.rows(np.array([5])), points.rows(np.array([9]))
    begin = int(some.pose[0])
    start = GaussianState(np.zeros(STATES), np.zeros((STATES, STATES)))
    nodes = [node for node in timeline.nodes if node.is_step]
    before = reckon(tuple(nodes[: begin + 1]), 0, start)[-1]
    way = others.position_m[0] - some.position_m[0]
    swing = np.array([[1.0, 0.0, -way[1]], [0.0, 1.0, way[0]]])
    expected = before.covariance[:2, :3] @ swing.T
    np.testing.assert_allclose(path.covariance(some, others, 0), expected, atol=1e-9)


def test_evidence_is_the_density_of_all_fixes() -> None:
    path, points, _ = path_and_points()
    q = points.position_m - points.position_m[0]
    left = np.stack([-q[:, 1], q[:, 0]], axis=1)
    design = np.stack([q, left], axis=2).reshape(-1, 2)
    covariance = path.covariance(points, points, 0) + design @ np.diag([0.1**2, 0.3**2]) @ design.T
    covariance += np.kron(np.full((len(q), len(q)), UNKNOWN_POSITION_M**2) + 0.25 * np.eye(len(q)), np.eye(2))
    fixes_m = np.array([fix.position_m for fix in WALK.fixes])
    residual = (fixes_m - fixes_m[0] - q).ravel()
    expected = multivariate_normal(np.zeros(len(residual)), covariance, allow_singular=True).logpdf(residual)
    assert solved().log_evidence == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize("left_out", [0, 6, 13])
def test_a_fix_is_predicted_from_the_others(left_out: int) -> None:
    path, points, _ = path_and_points()
    without = solved(left_out)
    others = points.rows(np.array([i for i in range(len(points)) if i != left_out]))
    one = points.rows(np.array([left_out]))
    difference_m, covariance_m2 = without.predict(
        np.array([WALK.fixes[left_out].position_m]),
        one.position_m,
        path.covariance(one, others, 0),
        path.variance(one, 0),
        others.position_m,
    )
    whole = solved()
    np.testing.assert_allclose(whole.left_out_m[left_out], difference_m[0], atol=1e-4)
    np.testing.assert_allclose(whole.left_out_m2[left_out], covariance_m2[0], atol=1e-3)


def test_heading_and_scale_are_found() -> None:
    found = solved()
    sigma: Array = np.sqrt(np.diag(found.placement_covariance))
    assert abs(found.heading_rad) < 3.0 * sigma[0]
    assert abs(found.log_scale) < 3.0 * sigma[1]
    assert sigma[1] < 0.05
    assert 0.5 < found.squared / (2 * len(WALK.fixes) - 2) < 1.6
