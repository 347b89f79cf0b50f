import math
from dataclasses import replace

import numpy as np
import pytest

from pdr_est.evaluate.heading_errors import heading_at, heading_net_error_deg, turn_error_deg


@pytest.fixture
def turning(make_track):
    """A track of one pose a second for 60 s with given headings in degrees, wrapped as an estimator might."""

    def make(heading_deg):
        time_s = np.arange(61.0)
        heading = np.radians([heading_deg(t) for t in time_s])
        track = make_track(time_s, np.zeros((61, 2)))
        return replace(track, heading_rad=np.arctan2(np.sin(heading), np.cos(heading)))

    return make


def steps_of(*turns):
    """Heading over time that changes at once at some times. turns: (time_s, degrees)."""
    return lambda t: 170.0 + sum(angle for time_s, angle in turns if t >= time_s)


def test_exact_turns_have_no_error_whatever_the_wrapping(turning):
    track = turning(steps_of((20.0, 90.0), (40.0, 45.0)))
    angles = np.radians([90.0, 45.0])
    assert turn_error_deg(track, np.array([20.0, 40.0]), angles) == pytest.approx(0.0, abs=1e-9)
    assert heading_net_error_deg(track, 0.0, 60.0, angles) == pytest.approx(0.0, abs=1e-9)


def test_errors_by_hand(turning):
    # Turned by 80, -50 and 60 degrees where 90, -45 and 90 are right: errors 10, 5 and 30, net 90 - 135 = -45.
    track = turning(steps_of((10.0, 80.0), (30.0, -50.0), (50.0, 60.0)))
    times, angles = np.array([10.0, 30.0, 50.0]), np.radians([90.0, -45.0, 90.0])
    assert turn_error_deg(track, times, angles) == pytest.approx(10.0)
    assert heading_net_error_deg(track, 0.0, 60.0, angles) == pytest.approx(45.0)


def test_a_turn_is_measured_from_two_seconds_before_to_two_after(turning):
    # Ten degrees a second: 40 in the window.
    track = turning(lambda t: 10.0 * t)
    assert turn_error_deg(track, np.array([30.0]), np.radians([40.0])) == pytest.approx(0.0, abs=1e-9)


def test_turning_round_by_either_side_is_the_same(turning):
    track = turning(lambda t: -45.0 * np.clip(t - 28.0, 0.0, 4.0))
    assert turn_error_deg(track, np.array([30.0]), np.radians([180.0])) == pytest.approx(0.0, abs=1e-6)


def test_what_happens_outside_the_annotated_walk_does_not_count(turning):
    track = turning(steps_of((5.0, 70.0), (30.0, 90.0), (58.0, 70.0)))
    assert heading_net_error_deg(track, 10.0, 50.0, np.radians([90.0])) == pytest.approx(0.0, abs=1e-9)


def test_no_turn_no_error(turning):
    assert math.isnan(turn_error_deg(turning(steps_of()), np.array([]), np.array([])))


def test_headings_between_poses_and_beyond_them(make_track):
    track = replace(make_track([0.0, 1.0], np.zeros((2, 2))), heading_rad=np.array([3.0, -3.0]))
    middle = 3.0 + (np.pi - 3.0)
    np.testing.assert_allclose(heading_at(track, np.array([-5.0, 0.5, 9.0])), [3.0, middle, 2.0 * np.pi - 3.0])
