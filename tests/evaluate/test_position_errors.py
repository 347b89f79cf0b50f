"""Metrics against values computed by hand; the arithmetic stands in the comments."""

import math

import numpy as np
import pytest

from pdr_est.evaluate import position_errors as metrics
from pdr_est.evaluate.rigid_alignment import RigidTransform
from pdr_est.types.steps import CarryingMode

HOLDING, SWING, TRANS = CarryingMode.HOLDING, CarryingMode.SWING, CarryingMode.TRANS

# The truth goes 30 m east and then 40 m north; the track goes 33 m and then 44 m: ten percent too long.
TRUTH_M = np.array([[0.0, 0.0], [30.0, 0.0], [30.0, 40.0]])
LONG_M = np.array([[0.0, 0.0], [33.0, 0.0], [33.0, 44.0]])
ANYWHERE = RigidTransform(2.0, np.array([-70.0, 300.0]))


def test_error_open_is_the_mean_over_the_later_points():
    # Aligned at the start: errors 0, 3, |(3, 4)| = 5. Mean of the later ones (3 + 5) / 2 = 4; of all it were 8/3.
    assert metrics.error_open(ANYWHERE.apply(LONG_M), TRUTH_M) == pytest.approx(4.0)


def test_error_open_does_not_set_the_direction_by_a_near_point():
    # The second point, 4 m away, was clicked 3 m to the left of its true place. The direction comes from the third
    # one, so the errors are |(5, 0) - (4, 3)| = sqrt(1 + 9) and 0: mean sqrt(10) / 2.
    truth = np.array([[0.0, 0.0], [4.0, 3.0], [40.0, 0.0]])
    track = np.array([[0.0, 0.0], [5.0, 0.0], [40.0, 0.0]])
    assert metrics.error_open(track, truth) == pytest.approx(math.sqrt(10.0) / 2.0)


def test_final_drift_is_the_last_error_by_the_length_of_the_truth():
    # 5 m after 30 + 40 m.
    assert metrics.final_drift(ANYWHERE.apply(LONG_M), TRUTH_M) == pytest.approx(5.0 / 70.0)


def test_ate_of_two_points_shares_the_difference_of_the_distances():
    # 10 m and 14 m: after alignment each end is (14 - 10) / 2 = 2 m off, so the root mean square is 2.
    track = np.array([[0.0, 0.0], [0.0, 14.0]])
    truth = np.array([[5.0, 5.0], [15.0, 5.0]])
    assert metrics.ate_rigid(track, truth) == pytest.approx(2.0)


def test_ate_is_of_the_distance_and_not_of_each_coordinate():
    # A square of side 2 and one of side 4 about the same centre: each corner is off by (1, 1), sqrt(2) m. The root
    # mean square over coordinates would be 1.
    square = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    assert metrics.ate_rigid(ANYWHERE.apply(2.0 * square), square) == pytest.approx(math.sqrt(2.0))


def test_ate_is_the_root_of_the_mean_square_and_not_the_mean():
    # Points on a line at -3, 0, 3 and -3, 1.5, 1.5: means 0 and 0, direction kept (dot product 9 + 0 + 4.5 > 0).
    # Errors 0, 1.5, 1.5: root of (0 + 2.25 + 2.25) / 3 = sqrt(1.5); the mean would be 1.
    truth = np.array([[-3.0, 0.0], [0.0, 0.0], [3.0, 0.0]])
    track = np.array([[-3.0, 0.0], [1.5, 0.0], [1.5, 0.0]])
    assert metrics.ate_rigid(track, truth) == pytest.approx(math.sqrt(1.5))


def test_length_ratio_takes_the_tracks_own_poses_and_interpolated_ends(make_track):
    # The track goes (0,0) -> (4,0) -> (4,4) in 4 s each. From 1 s to 7 s: (1,0) -> (4,0) -> (4,3): 3 + 3 = 6 m. The
    # truth's two points are 8 m apart. The straight line between the ends of the track would be sqrt(18).
    track = make_track([0.0, 4.0, 8.0], [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0]])
    ratio = metrics.length_ratio(track, np.array([1.0, 7.0]), np.array([[0.0, 0.0], [8.0, 0.0]]))
    assert ratio == pytest.approx(6.0 / 8.0)


def test_length_ratio_of_a_scaled_track_is_the_scale(make_track):
    times = [0.0, 30.0, 70.0]
    assert metrics.length_ratio(make_track(times, LONG_M), np.array(times), TRUTH_M) == pytest.approx(1.1)


def test_length_of_gps_truth_leaves_near_fixes_out(make_track):
    # Fixes at 0, 3, 6, 9, 12, 13 m to the east that jump 1 m north and back. At least 5 m from the last one kept are
    # (6, 0) and (12, 0): the truth's length is 6 + 6 m. The track from 0 s to 4 s is 12 m long.
    truth = np.array([[0.0, 0.0], [3.0, 1.0], [6.0, 0.0], [9.0, 1.0], [12.0, 0.0], [13.0, 1.0]])
    times = np.arange(6.0)
    track = make_track(times, np.column_stack([3.0 * times, np.zeros(6)]))
    np.testing.assert_array_equal(metrics.thinned(truth, 5.0), [0, 2, 4])
    assert metrics.length_ratio(track, times, truth, least_leg_m=5.0) == pytest.approx(1.0)


def test_without_a_least_leg_every_point_counts(make_track):
    truth = np.array([[0.0, 0.0], [0.0, 0.0], [1.0, 0.0]])
    np.testing.assert_array_equal(metrics.thinned(truth, 0.0), [0, 1, 2])


def test_a_standing_walk_has_no_ratio_and_no_drift(make_track):
    still = np.zeros((3, 2))
    track = make_track([0.0, 1.0, 2.0], still)
    assert math.isnan(metrics.length_ratio(track, np.arange(3.0), still))
    assert math.isnan(metrics.final_drift(still, still))
    assert metrics.ate_rigid(still, still) == 0.0


def test_a_track_that_never_moves_is_scored_and_not_excused(make_track):
    track = make_track([0.0], [[0.0, 0.0]])
    still = np.zeros((3, 2))
    # Errors 30 and |(30, 40)| = 50.
    assert metrics.error_open(still, TRUTH_M) == pytest.approx(40.0)
    assert metrics.length_ratio(track, np.arange(3.0), TRUTH_M) == 0.0


def modes(*labels):
    return np.array(labels, dtype=np.int8)


def test_mode_accuracy_is_weighted_by_time():
    # 0.5 + 0.5 s right of 2.5 s; by number of steps it would be 2/3.
    accuracy = metrics.mode_accuracy(
        np.array([0.5, 1.5, 0.5]), [HOLDING, SWING, HOLDING], modes(HOLDING, HOLDING, HOLDING)
    )
    assert accuracy == pytest.approx(0.4)


def test_transition_counts_as_wrong():
    assert metrics.mode_accuracy(np.array([1.0, 1.0]), [HOLDING, TRANS], modes(HOLDING, HOLDING)) == pytest.approx(
        0.5
    )


def test_each_step_is_compared_with_the_mode_of_its_own_time():
    accuracy = metrics.mode_accuracy(np.array([1.0, 3.0]), [HOLDING, SWING], modes(SWING, SWING))
    assert accuracy == pytest.approx(0.75)


def test_mode_accuracy_without_steps_is_not_known():
    assert math.isnan(metrics.mode_accuracy(np.array([]), [], modes()))


@pytest.mark.parametrize(
    ("total_m", "covered"), [(100.0, 1.0), (110.5, 1.0), (110.6, 0.0), (90.5, 1.0), (90.4, 0.0), (0.0, 0.0)]
)
def test_a_length_is_within_its_sigma_by_the_logarithm(total_m, covered):
    assert metrics.within_sigma(total_m, 100.0, 0.1) == covered


def test_legs_by_hand():
    # True legs (10, 0), (0, 10); the track's (11, 0), (0, 10), turned anyhow. Lengths: errors 1 and 0, mean 0.5.
    # The best rotation leaves the angles as they are (dot product 110 + 100, cross product 0): vectors 1 and 0.
    # Turn: the second leg is 10 m to the left of the first one in both: 0.
    truth = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 10.0]])
    track = ANYWHERE.apply(np.array([[0.0, 0.0], [11.0, 0.0], [11.0, 10.0]]))
    values, counts = metrics.leg_metrics(track, truth)
    expected = {"leg_length_mae_m": 0.5, "leg_vector_mae_m": 0.5, "leg_turn_mae_m": 0.0}
    assert values == pytest.approx(expected, abs=1e-12)
    assert counts == {"legs": 2, "leg_turns": 1}


def test_a_leg_of_the_wrong_direction_is_half_as_wrong_after_the_rotation_but_its_turn_is_not():
    # The track goes 10 m east and 10 m on; the truth turns left. Sum of the products with the true legs as complex
    # numbers: 10 * 10 + 10 * 10i, so the track is turned by 45 degrees: each leg is off by 2 * 10 * sin(22.5 deg).
    # Seen from the first leg, the second one is at (10, 0) and not at (0, 10): 10 * sqrt(2).
    truth = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 10.0]])
    values, _ = metrics.leg_metrics(np.array([[0.0, 0.0], [10.0, 0.0], [20.0, 0.0]]), truth)
    assert values["leg_length_mae_m"] == pytest.approx(0.0)
    assert values["leg_vector_mae_m"] == pytest.approx(20.0 * math.sin(math.radians(22.5)))
    assert values["leg_turn_mae_m"] == pytest.approx(10.0 * math.sqrt(2.0))


def test_a_short_leg_has_a_length_but_gives_no_direction_to_the_next_one():
    # Legs of 0.9 m (true), then 10 m: too short. Then 10 m of the truth, of which the track has 0.4 m: no direction.
    truth = np.array([[0.0, 0.0], [0.9, 0.0], [10.9, 0.0], [10.9, 10.0]])
    track = np.array([[0.0, 0.0], [0.9, 0.0], [1.3, 0.0], [1.3, 10.0]])
    values, counts = metrics.leg_metrics(track, truth)
    assert values["leg_length_mae_m"] == pytest.approx(9.6 / 3.0)
    assert "leg_turn_mae_m" not in values
    assert counts == {"legs": 3, "leg_turns": 0}


def test_legs_of_a_track_that_never_moved():
    values, _ = metrics.leg_metrics(np.zeros((2, 2)), np.array([[0.0, 0.0], [3.0, 4.0]]))
    assert values == pytest.approx({"leg_length_mae_m": 5.0, "leg_vector_mae_m": 5.0})
