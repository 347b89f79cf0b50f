"""The person's heading: exact answers of the weights and of the average over strides."""

import numpy as np
import pytest

from pdr_est.estimators.person.heading import heading_of_person, over_strides
from pdr_est.frames import Array
from pdr_est.types.steps import CarryingMode
from pdr_est.types.track import Track

STEPS = 31
TIMES_S = 0.5 * np.arange(STEPS)
BOTH = np.ones((2, STEPS), dtype=np.bool_)


def device(heading_rad: Array | float, sigma_rad: Array | float) -> Track:
    return Track(
        time_s=TIMES_S,
        moving_from_s=np.concatenate([TIMES_S[:1], TIMES_S[:-1]]),
        device=np.array(["a"] * STEPS),
        position_m=np.zeros((STEPS, 2)),
        heading_rad=np.broadcast_to(heading_rad, STEPS).astype(np.float64),
        covariance_m2=np.tile(np.eye(2), (STEPS, 1, 1)),
        sigma_heading_rad=np.broadcast_to(sigma_rad, STEPS).astype(np.float64),
        mode=np.full(STEPS, CarryingMode.POCKET, dtype=np.int8),
        step_length_m=np.full(STEPS, 0.7),
        kind="smoothed",
        estimator="factor-graph",
    )


def test_the_say_of_a_device_goes_by_its_variance() -> None:
    heading, variance = heading_of_person([device(0.1, 0.1), device(0.3, np.sqrt(0.03))], TIMES_S, BOTH)
    np.testing.assert_allclose(heading, 0.75 * 0.1 + 0.25 * 0.3, rtol=1e-6)  # variances 0.01 and 0.03
    np.testing.assert_allclose(variance, 0.75 * 0.01 + 0.25 * 0.03, rtol=1e-6)


def test_where_devices_set_off_in_different_directions_the_person_does_not_turn() -> None:
    # The first one defines the frame: exactly known at the start. Neither turns.
    frame, other = device(0.0, 0.08 * np.sqrt(TIMES_S / TIMES_S[-1])), device(-0.1, 0.08)
    heading, _ = heading_of_person([frame, other], TIMES_S, BOTH)
    np.testing.assert_allclose(heading, heading[0], atol=1e-9)


def test_a_device_that_is_not_there_has_no_say() -> None:
    present = BOTH.copy()
    present[1, 20:] = False
    heading, variance = heading_of_person([device(0.0, 0.1), device(0.2, 0.1)], TIMES_S, present)
    np.testing.assert_allclose([heading[0], heading[-1]], [0.1, 0.0], atol=1e-6)
    np.testing.assert_allclose(variance[-1], 0.01, rtol=1e-6)


def test_headings_that_unwrap_to_either_side_are_the_same() -> None:
    turned = np.where(TIMES_S > 7.0, np.pi, 0.0)
    by_left, by_right = device(turned - 1e-3 * (TIMES_S > 7.0), 0.1), device(-turned + 1e-3 * (TIMES_S > 7.0), 0.1)
    heading, _ = heading_of_person([by_left, by_right], TIMES_S, BOTH)
    np.testing.assert_allclose(np.cos(heading), np.where(TIMES_S > 7.0, -1.0, 1.0), atol=1e-5)


def test_what_goes_to_and_fro_with_the_legs_cancels_and_counts_as_uncertain() -> None:
    sway = 0.05 * (-1.0) ** np.arange(STEPS)
    heading, variance = over_strides(0.3 + sway, np.full(STEPS, 0.01))
    np.testing.assert_allclose(heading, 0.3, atol=1e-12)
    np.testing.assert_allclose(variance, 0.01 + 0.05**2, rtol=1e-9)


def test_the_ends_get_the_mean_of_the_first_and_the_last_strides() -> None:
    drift = 0.01 * np.arange(STEPS)
    heading, _ = over_strides(drift, np.full(STEPS, 0.01))
    np.testing.assert_allclose(heading[:6], drift[5])  # of the steps 1 to 9; row 0 is the start
    np.testing.assert_allclose(heading[5:-4], drift[5:-4])
    np.testing.assert_allclose(heading[-5:], drift[-5])


def test_a_turn_stays_as_sharp_as_it_is() -> None:
    turn = np.where(np.arange(STEPS) < 15, 0.0, np.pi / 2.0)
    heading, variance = over_strides(turn, np.full(STEPS, 0.01))
    np.testing.assert_allclose(heading, turn)
    np.testing.assert_allclose(variance, 0.01)


def test_near_a_turn_the_average_is_over_fewer_strides() -> None:
    swaying = np.where(np.arange(STEPS) < 15, 0.0, np.pi / 2.0) + 0.05 * (-1.0) ** np.arange(STEPS)
    heading, _ = over_strides(swaying, np.full(STEPS, 0.01))
    np.testing.assert_allclose(heading[:13], 0.0, atol=1e-12)  # two steps before the turn two strides still fit
    np.testing.assert_allclose(heading[13:17], swaying[13:17])
    np.testing.assert_allclose(heading[17:], np.pi / 2.0, atol=1e-12)


def test_a_known_direction_at_the_start_is_kept() -> None:
    variance = 0.001 * np.arange(STEPS)
    heading, spread = over_strides(0.01 * np.arange(STEPS), variance)
    assert (heading[0], spread[0]) == (0.0, 0.0)
    assert heading[1] == pytest.approx(0.05)


@pytest.mark.parametrize("rows", [1, 2, 5])
def test_too_few_steps_for_a_stride_keep_their_headings(rows: int) -> None:
    heading, variance = over_strides(np.linspace(0.0, 0.1, rows), np.full(rows, 0.01))
    np.testing.assert_array_equal(heading, np.linspace(0.0, 0.1, rows))
    np.testing.assert_array_equal(variance, np.full(rows, 0.01))
