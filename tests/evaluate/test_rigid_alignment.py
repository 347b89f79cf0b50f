import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pdr_est.evaluate.rigid_alignment import RigidTransform, best_alignment, direction_point, start_alignment
from pdr_est.frames import wrap_angle

POINTS_M = np.array([[0.0, 0.0], [8.0, 1.0], [25.0, -3.0], [24.0, 14.0], [2.0, 11.0]])
ALIGNMENTS = pytest.mark.parametrize("alignment", [best_alignment, start_alignment])


def test_rotation_is_counter_clockwise_about_the_origin():
    quarter = RigidTransform(np.pi / 2, np.array([10.0, 0.0]))
    np.testing.assert_allclose(
        quarter.apply(np.array([[1.0, 0.0], [0.0, 1.0]])), [[10.0, 1.0], [9.0, 0.0]], atol=1e-15
    )


@ALIGNMENTS
@given(
    rotation=st.floats(-np.pi, np.pi),
    x=st.floats(-1e3, 1e3),
    y=st.floats(-1e3, 1e3),
)
def test_a_known_transform_is_recovered(alignment, rotation, x, y):
    true = RigidTransform(rotation, np.array([x, y]))
    found = alignment(POINTS_M, true.apply(POINTS_M))
    np.testing.assert_allclose(wrap_angle(found.rotation_rad - rotation), 0.0, atol=1e-9)
    np.testing.assert_allclose(found.translation_m, true.translation_m, atol=1e-8)


@ALIGNMENTS
def test_scale_is_never_absorbed(alignment):
    moved = alignment(1.1 * POINTS_M, POINTS_M).apply(1.1 * POINTS_M)
    legs = np.linalg.norm(np.diff(moved, axis=0), axis=1)
    np.testing.assert_allclose(legs, 1.1 * np.linalg.norm(np.diff(POINTS_M, axis=0), axis=1))


def test_a_mirrored_track_is_not_mirrored_back():
    mirrored = POINTS_M * [1.0, -1.0]
    left = best_alignment(mirrored, POINTS_M).apply(mirrored) - POINTS_M
    assert np.abs(left).max() > 1.0


def test_best_alignment_is_not_worse_than_any_near_it():
    track = POINTS_M + np.random.default_rng(1).normal(0.0, 1.0, POINTS_M.shape)
    best = best_alignment(track, POINTS_M)

    def cost(rotation, translation):
        return np.square(RigidTransform(rotation, translation).apply(track) - POINTS_M).sum()

    least = cost(best.rotation_rad, best.translation_m)
    for turn in (-1e-3, 1e-3):
        assert cost(best.rotation_rad + turn, best.translation_m) > least
    for shift in ([1e-3, 0.0], [-1e-3, 0.0], [0.0, 1e-3], [0.0, -1e-3]):
        assert cost(best.rotation_rad, best.translation_m + np.array(shift)) > least


def test_direction_is_set_by_the_first_point_at_least_20_m_away():
    # Distances from the first point: 0, 12, 19.99, 20, 30.
    assert direction_point(np.array([[0, 0], [12, 0], [0, 19.99], [0, 20], [30, 0]], dtype=float)) == 3


def test_direction_is_set_by_the_farthest_point_when_none_is_20_m_away():
    assert direction_point(np.array([[0, 0], [3, 0], [9, 0], [5, 0]], dtype=float)) == 2


def test_distance_that_sets_the_direction_is_the_truths_and_not_the_tracks():
    truth = np.array([[0.0, 0.0], [5.0, 0.0], [20.0, 0.0]])
    track = np.array([[0.0, 0.0], [30.0, 0.0], [0.0, 22.0]])  # 30 m away where the truth is only 5 m away
    assert start_alignment(track, truth).rotation_rad == pytest.approx(-np.pi / 2)


def test_a_track_that_has_not_moved_takes_the_truths_direction_from_east():
    transform = start_alignment(np.zeros((2, 2)), np.array([[1.0, 1.0], [1.0, 31.0]]))
    np.testing.assert_allclose(transform.apply(np.zeros((1, 2))), [[1.0, 1.0]])
