"""Slope and curvature of the linear system of active tethers are those of their cost."""

import gtsam
import numpy as np
import pytest

from pdr_est.estimators.factor_graph.marginals import ordering_of
from pdr_est.estimators.factor_graph.newton import Variables, linear_system
from pdr_est.estimators.factor_graph.tether_factors import tether_factors
from pdr_est.estimators.pose_chains.tether_constraints import TetherConstraints

POSE = np.array([[0.0, 0.0, 0.3], [0.6, 0.4, -1.0], [1.0, 1.0, 2.0]])
VARIABLES = Variables(3, (2, 1, 0), ordering_of((2, 1, 0)), None)


def values_of(pose: np.ndarray) -> gtsam.Values:
    values = gtsam.Values()
    for key, own in enumerate(pose):
        values.insert(key, gtsam.Pose2(*own))
    return values


def linear_of(tethers: TetherConstraints) -> gtsam.GaussianFactorGraph:
    """The linear system of the tethers alone at POSE."""
    nothing = gtsam.NonlinearFactorGraph()
    return linear_system(nothing, tethers, values_of(POSE), VARIABLES, with_stiffness=True).factors


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


@pytest.mark.parametrize("move", [[2e-3, 0.0], [0.0, 2e-3], [1e-3, -2e-3]])
def test_active_tethers_in_second_order(move: list[float]) -> None:
    tethers = tethers_of([[0, 1], [0, 2]], [0.5, 5.0])
    near, linear = tethers.linearised(POSE), linear_of(tethers)
    assert linear.size() == 2  # distance and stiffness of the one; the other one holds
    change = np.zeros((3, 3))
    change[0, :2] = move
    error = tethers.error(after(POSE, change))
    assert abs(linear.error(vector_of(change)) - error) < 3e-5 * tethers.error(POSE)
    assert near.error(change, near.violation_m) == pytest.approx(linear.error(vector_of(change)), rel=1e-12)


def test_a_tether_that_turns_with_the_poses_at_its_ends_costs_what_it_did() -> None:
    tethers = tethers_of([[0, 1]], [0.5])
    angle = 0.1
    to_own = -POSE[:, 2]
    swing = angle * np.stack([-POSE[:, 1], POSE[:, 0]], axis=1)  # of the whole walk about the origin
    c, s = np.cos(to_own), np.sin(to_own)
    change = np.stack(
        [c * swing[:, 0] - s * swing[:, 1], s * swing[:, 0] + c * swing[:, 1], np.full(3, angle)], axis=1
    )
    assert linear_of(tethers).error(vector_of(change)) == pytest.approx(tethers.error(POSE), rel=1e-12)


PLACES = TetherConstraints.between_places(
    np.array([[0, 1], [0, 2], [1, 0]]),
    np.array([[0, 2], [0, 2], [2, 0]]),
    np.array([[1.0, 0.25], [1.0, 1.0], [0.6, 1.0]]),
    np.array([0.5, 0.1, 0.2]),
    np.array([0.1, 0.1, 0.05]),
)


def test_a_place_between_two_poses_is_on_the_straight_line() -> None:
    distance_m = np.array(
        [np.hypot(0.6 + 0.25 * 0.4, 0.4 + 0.25 * 0.6), np.hypot(1.0, 1.0), np.hypot(0.6 + 0.24, 0.4 + 0.36)]
    )
    assert PLACES.linearised(POSE).distance_m == pytest.approx(distance_m)
    violation_sigmas = (distance_m - [0.5, 0.1, 0.2]) / [0.1, 0.1, 0.05]
    assert PLACES.error(POSE) == pytest.approx(0.5 * np.sum(violation_sigmas**2))


def test_factors_of_tethers_have_their_cost_and_its_slope() -> None:
    made = tether_factors(PLACES, np.array([True, True, True]), POSE)
    names = [type(made.graph.at(i)).__name__ for i in range(made.graph.size())]
    assert [names.count(name) for name in ("RangeFactorPose2", "BetweenFactorPose2", "LinearContainerFactor")] == [
        3,
        4,
        2,
    ]
    values = values_of(POSE)
    values.insert(made.auxiliary)
    assert made.graph.error(values) == pytest.approx(PLACES.error(POSE), rel=1e-9)
    gradient, step = made.graph.linearize(values).gradientAtZero(), 1e-6
    for key in made.auxiliary.keys():  # noqa: SIM118
        assert gradient.at(key) == pytest.approx(np.zeros(3), abs=1e-6)  # auxiliary variables are at their optimum
    for key in range(3):
        for axis in range(3):
            change = np.zeros((3, 3))
            change[key, axis] = step
            slope = (PLACES.error(after(POSE, change)) - PLACES.error(after(POSE, -change))) / (2.0 * step)
            assert gradient.at(key)[axis] == pytest.approx(slope, abs=1e-5)


def test_factors_of_tethers_are_exact_at_other_positions_too() -> None:
    made = tether_factors(PLACES, np.array([True, True, True]), POSE)
    elsewhere = POSE + np.array([[2.0, 1.0, 0.0], [-1.0, 3.0, 0.0], [0.5, -4.0, 0.0]])
    values = values_of(elsewhere)
    values.insert(tether_factors(PLACES, np.array([True, True, True]), elsewhere).auxiliary)
    assert made.graph.error(values) == pytest.approx(PLACES.error(elsewhere), rel=1e-9)


def test_tethers_that_hold_have_no_factors() -> None:
    tethers = tethers_of([[0, 1], [0, 2]], [1.0, 5.0])
    assert linear_of(tethers).size() == 0
    assert tethers.error(POSE) == 0.0
