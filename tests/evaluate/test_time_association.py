import numpy as np
import pytest

from pdr_est.evaluate.time_association import associate

# A walk of 10 s at 1 m/s to the east; the recording goes on for 3 s more while the walker stands.
SPAN_S = (0.0, 13.0)


@pytest.fixture
def track(make_track):
    return make_track([0.0, 4.0, 10.0], [[0.0, 0.0], [4.0, 0.0], [10.0, 0.0]])


def test_track_is_interpolated_to_the_times_of_the_truth(track):
    pairs = associate(track, np.array([1.0, 4.0, 7.0]), np.zeros((3, 2)), SPAN_S)
    # 4 m in the first 4 s: 1 m at 1 s. 6 m in the next 6 s: 4 + 3 = 7 m at 7 s.
    np.testing.assert_allclose(pairs.track_m, [[1.0, 0.0], [4.0, 0.0], [7.0, 0.0]])
    assert pairs.not_scored == 0


def test_truth_keeps_its_own_times_and_places(track):
    truth = np.array([[5.0, 6.0], [7.0, 8.0]])
    pairs = associate(track, np.array([2.5, 20.0]), truth, SPAN_S)
    np.testing.assert_array_equal(pairs.time_s, [2.5])
    np.testing.assert_array_equal(pairs.truth_m, truth[:1])


def test_points_up_to_a_second_outside_take_the_tracks_end_and_farther_ones_are_counted(track):
    times = np.array([-1.01, -1.0, -0.5, 13.5, 14.0, 14.01])
    pairs = associate(track, times, np.zeros((6, 2)), SPAN_S)
    np.testing.assert_array_equal(pairs.time_s, [-1.0, -0.5, 13.5, 14.0])
    np.testing.assert_allclose(pairs.track_m, [[0.0, 0.0], [0.0, 0.0], [10.0, 0.0], [10.0, 0.0]])
    assert pairs.not_scored == 2


def test_a_point_where_the_walker_stands_at_the_end_of_the_recording_is_scored(track):
    # 2.9 s after the last pose, but sensors were still being recorded.
    pairs = associate(track, np.array([12.9]), np.zeros((1, 2)), SPAN_S)
    np.testing.assert_allclose(pairs.track_m, [[10.0, 0.0]])


def test_track_of_a_single_point_stands_there(make_track):
    pairs = associate(make_track([0.0], [[2.0, 3.0]]), np.array([0.0, 5.0]), np.zeros((2, 2)), SPAN_S)
    np.testing.assert_allclose(pairs.track_m, [[2.0, 3.0], [2.0, 3.0]])


def test_nothing_within_the_recording_gives_no_pair(track):
    pairs = associate(track, np.array([100.0, 200.0]), np.zeros((2, 2)), SPAN_S)
    assert len(pairs) == 0
    assert pairs.not_scored == 2
