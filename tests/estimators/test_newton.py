"""The slope and the curvature that Newton's method sees of taut tethers are those of their error."""

import gtsam
import numpy as np

from pdr_est.estimators.gtsam_newton import Tethers


def test_taut_tethers_in_second_order() -> None:
    tethers = Tethers(np.array([[0, 1], [0, 2]]), np.array([0.5, 5.0]), np.array([0.1, 0.1]))
    pose = np.array([[0.0, 0.0, 0.3], [0.6, 0.4, -1.0], [1.0, 1.0, 2.0]])
    linear = tethers.taut(pose, resisting=True)
    assert linear.size() == 1  # the other is slack

    def error(move: np.ndarray) -> float:
        """move: of pose 0 along its own axes."""
        c, s = np.cos(0.3), np.sin(0.3)
        there = pose.copy()
        there[0, :2] += np.array([[c, -s], [s, c]]) @ move
        return tethers.error(there)

    change = gtsam.VectorValues()
    for move in np.array([[2e-3, 0.0], [0.0, 2e-3], [1e-3, -2e-3]]):
        change = gtsam.VectorValues()
        change.insert(0, np.array([*move, 0.0]))
        change.insert(1, np.zeros(3))
        assert abs(linear.error(change) - error(move)) < 3e-5 * error(np.zeros(2))
    slack = tethers.taut(np.array([[0.0, 0.0, 0.0], [0.3, 0.0, 0.0], [1.0, 0.0, 0.0]]), resisting=True)
    assert slack.size() == 0
