"""The slope and the curvature that Newton's method sees of taut tethers are those of their error."""

import gtsam
import numpy as np
import pytest

from pdr_est.estimators.factor_graph.tether_constraints import TetherConstraints
from pdr_est.estimators.factor_graph.tether_factors import tether_factors

POSE = np.array([[0.0, 0.0, 0.3], [0.6, 0.4, -1.0], [1.0, 1.0, 2.0]])


def tethers_of(ends: list[list[int]], max_distance_m: list[float]) -> TetherConstraints:
    keys = np.array(ends)
    return TetherConstraints.between_places(
        keys, keys, np.ones(keys.shape), np.array(max_distance_m), np.full(len(ends), 0.1)
    )


def after(pose: np.ndarray, change: np.ndarray) -> np.ndarray:
    """Poses (n, 3) that moved along their own axes (n, 3)."""
    c, s = np.cos(pose[:, 2]), np.sin(pose[:, 2])
    forward, left, turn = change.T
    return pose + np.stack([c * forward - s * left, s * forward + c * left, turn], axis=1)


def vector_of(change: np.ndarray) -> gtsam.VectorValues:
    vector = gtsam.VectorValues()
    for key, own in enumerate(change):
        vector.insert(key, own)
    return vector


def values_at(pose: np.ndarray) -> gtsam.Values:
    values = gtsam.Values()
    for key, own in enumerate(pose):
        values.insert(key, gtsam.Pose2(*own))
    return values


def linear_factors(tethers: TetherConstraints) -> gtsam.GaussianFactorGraph:
    """Range factors of the active tethers at POSE, linearised, and their stiffness."""
    near = tethers.linearised(POSE)
    active = near.violation_m > 0.0
    linear = gtsam.GaussianFactorGraph()
    linear.push_back(tether_factors(tethers, active, POSE).graph.linearize(values_at(POSE)))
    linear.push_back(near.stiffness_factors(active, near.violation_m))
    return linear


@pytest.mark.parametrize("move", [[2e-3, 0.0], [0.0, 2e-3], [1e-3, -2e-3]])
def test_taut_tethers_in_second_order(move: list[float]) -> None:
    tethers = tethers_of([[0, 1], [0, 2]], [0.5, 5.0])
    near, linear = tethers.linearised(POSE), linear_factors(tethers)
    assert linear.size() == 2  # range and stiffness; the other is slack
    change = np.zeros((3, 3))
    change[0, :2] = move
    error = near.tethers.error(after(POSE, change))
    assert abs(linear.error(vector_of(change)) - error) < 3e-5 * near.tethers.error(POSE)
    assert near.error(change, near.violation_m) == pytest.approx(linear.error(vector_of(change)), rel=1e-12)


def test_a_line_that_turns_with_those_who_hold_it_costs_what_it_did() -> None:
    tethers = tethers_of([[0, 1]], [0.5])
    linear = linear_factors(tethers)
    angle = 0.1
    to_own = -POSE[:, 2]
    swing = angle * np.stack([-POSE[:, 1], POSE[:, 0]], axis=1)  # of the whole walk about the origin
    c, s = np.cos(to_own), np.sin(to_own)
    change = np.stack(
        [c * swing[:, 0] - s * swing[:, 1], s * swing[:, 0] + c * swing[:, 1], np.full(3, angle)], axis=1
    )
    assert linear.error(vector_of(change)) == pytest.approx(tethers.error(POSE), rel=1e-12)


def test_a_tether_between_places_on_the_way_from_one_pose_to_the_next() -> None:
    places = TetherConstraints.between_places(
        np.array([[0, 1], [0, 2]]),
        np.array([[0, 2], [0, 2]]),
        np.array([[1.0, 0.25], [1.0, 1.0]]),
        np.array([0.5, 0.1]),
        np.array([0.1, 0.1]),
    )
    distance_m = np.array([np.hypot(0.6 + 0.25 * 0.4, 0.4 + 0.25 * 0.6), np.hypot(1.0, 1.0)])
    assert places.linearised(POSE).distance_m == pytest.approx(distance_m)
    assert places.error(POSE) == pytest.approx(0.5 * np.sum(((distance_m - [0.5, 0.1]) / 0.1) ** 2))
    rng = np.random.default_rng(8)
    for change in (np.zeros((3, 3)), *(1e-2 * rng.standard_normal((4, 3, 3)))):
        pose = after(POSE, change)
        made = tether_factors(places, np.array([True, True]), pose)
        values = values_at(pose)
        values.insert(made.auxiliary)
        assert made.graph.error(values) == pytest.approx(places.error(pose), rel=1e-6)
        # The auxiliary variables are where the error is least.
        linear = made.graph.linearize(values)
        slope = linear.gradientAtZero()
        assert all(np.abs(slope.at(key)).max() < 1e-3 for key in list(made.auxiliary.keys()))


def test_slack_tethers_have_no_factors() -> None:
    tethers = tethers_of([[0, 1], [0, 2]], [1.0, 5.0])
    assert linear_factors(tethers).size() == 0
    assert tethers.error(POSE) == 0.0
