"""From steps to measurements: heading changes, covariances by hand, bridges over gaps."""

from dataclasses import replace

import numpy as np
import pytest
from signals import run, step

from pdr_est.front_end.odometry import Odometry, OdometryParams
from pdr_est.front_end.step_noise import course_covariance, step_covariance
from pdr_est.types.measurements import HeadingPrior, StepOdometry
from pdr_est.types.sensors import Hole
from pdr_est.types.steps import CarryingMode, Step, TurnHypothesis

PARAMETERS = OdometryParams(
    sigma_length_drift=0.1,
    sigma_direction_rad=0.2,
    sigma_heading_rad_per_sqrt_s=0.05,
    gap_speed_mps=1.5,
    sigma_gap_length=0.25,
)

TURNED, TURNED_MORE = step(1.0, 0.4, heading_rad=0.2), step(1.5, 1.0, heading_rad=1.5)


def odometry_of(*steps: Step, parameters: OdometryParams = PARAMETERS) -> list[StepOdometry]:
    return run(Odometry("left", parameters), steps)


def test_the_covariance_of_a_step_by_hand() -> None:
    found = step_covariance(length_m=0.8, sigma_length_m=0.08, sigma_direction_rad=0.2, sigma_heading_rad=0.05)
    least = 1e-6
    expected = [
        [0.0064 + least, 0.0, 0.0],
        [0.0, 0.64 * (0.0025 + 0.04) + least, 0.8 * 0.0025],
        [0.0, 0.8 * 0.0025, 0.0025 + least],
    ]
    np.testing.assert_allclose(found, expected, rtol=1e-12)


@pytest.mark.parametrize("length_m", [0.0, 1e-6, 0.7, 2.0])
@pytest.mark.parametrize("sigma_heading_rad", [0.0, 0.05, 1.0])
def test_a_covariance_is_always_regular(length_m: float, sigma_heading_rad: float) -> None:
    found = step_covariance(length_m, 0.1 * length_m, 0.18, sigma_heading_rad)
    assert np.linalg.eigvalsh(found).min() > 1e-8
    np.testing.assert_array_equal(found, found.T)


def test_the_first_step_changes_no_heading_and_takes_its_own_duration() -> None:
    (first,) = odometry_of(step(1.0, 0.6, length_m=0.5, heading_rad=2.5))
    assert (first.device, first.time_s, first.start_s, first.length_m) == ("left", 1.0, 0.6, 0.5)
    assert (first.heading_change_rad, first.mode, first.observed) == (0.0, CarryingMode.HOLDING, True)
    np.testing.assert_allclose(first.covariance, step_covariance(0.5, 0.05, 0.2, 0.05 * np.sqrt(0.4)))


def test_the_length_models_sigma_and_the_drift_add_up() -> None:
    (first,) = odometry_of(step(1.0, 0.6, length_m=0.5, sigma_length_m=0.12))
    np.testing.assert_allclose(first.covariance, step_covariance(0.5, 0.13, 0.2, 0.05 * np.sqrt(0.4)))


def test_the_heading_error_grows_with_the_time_since_the_last_step() -> None:
    _, second, third = odometry_of(step(1.0, 0.4), step(1.5, 1.0), step(9.5, 8.9))
    np.testing.assert_allclose(second.covariance, step_covariance(0.7, 0.07, 0.2, 0.05 * np.sqrt(0.5)))
    np.testing.assert_allclose(third.covariance, step_covariance(0.7, 0.07, 0.2, 0.05 * np.sqrt(8.0)))
    assert third.start_s == 8.9


def test_every_step_of_a_transition_may_have_turned_the_phone() -> None:
    trans = [replace(found, event=replace(found.event, mode=CarryingMode.TRANS)) for found in (TURNED, TURNED_MORE)]
    for before, after in ((TURNED, trans[1]), (trans[0], trans[1]), (trans[0], TURNED_MORE)):
        _, second = odometry_of(before, after)
        sigma = np.hypot(0.05 * np.sqrt(0.5), PARAMETERS.sigma_mode_change_rad)
        np.testing.assert_allclose(second.covariance, step_covariance(0.7, 0.07, 0.2, sigma))


@pytest.mark.parametrize(
    ("before_deg", "after_deg", "change_deg"),
    [(10.0, 40.0, 30.0), (40.0, 10.0, -30.0), (170.0, -170.0, 20.0), (-170.0, 170.0, -20.0), (-90.0, 80.0, 170.0)],
)
def test_the_heading_change_takes_the_short_way_round(before_deg: float, after_deg: float, change_deg: float) -> None:
    headings = np.deg2rad([before_deg, after_deg])
    _, second = odometry_of(
        step(1.0, 0.4, heading_rad=float(headings[0])), step(1.5, 1.0, heading_rad=float(headings[1]))
    )
    assert np.rad2deg(second.heading_change_rad) == pytest.approx(change_deg)


def test_a_gap_is_bridged_by_an_unobserved_walk() -> None:
    before, after = step(1.0, 0.4, heading_rad=3.0), step(4.0, 3.4, segment=1, heading_rad=-1.0)
    _, bridge, resumed = odometry_of(before, after)
    assert (bridge.start_s, bridge.time_s, bridge.observed) == (1.0, 3.4, False)
    assert (bridge.length_m, bridge.heading_change_rad) == (0.0, 0.0)
    reach, turn = 1.5 * 2.4, np.pi / np.sqrt(3.0)
    np.testing.assert_allclose(bridge.covariance, np.diag([reach**2, reach**2, turn**2]))
    # the new segment's yaw has a zero of its own: no heading change across the gap
    assert (resumed.heading_change_rad, resumed.start_s, resumed.time_s, resumed.observed) == (0.0, 3.4, 4.0, True)
    np.testing.assert_allclose(resumed.covariance, step_covariance(0.7, 0.07, 0.2, 0.05 * np.sqrt(0.6)))


def across(hole: Hole, after: Step, sigma_turn_rad: float = 0.2) -> Step:
    return replace(after, holes=(hole,), sigma_turn_rad=sigma_turn_rad)


def test_who_walks_on_over_a_short_gap_goes_the_way_of_that_time() -> None:
    """From 1.0 s to 2.4 s at 1.2 m/s, turned as the headings tell, with the doubt of the gap."""
    before = step(1.0, 0.5, length_m=0.6, heading_rad=0.3)
    after = across(Hole(1.3, 2.1), step(2.9, 2.4, heading_rad=0.8, segment=1))
    _, bridge, walked = odometry_of(before, after)
    assert (bridge.start_s, bridge.time_s, bridge.observed) == (1.0, 2.4, False)
    assert bridge.length_m == pytest.approx(1.2 * 1.4)
    assert bridge.heading_change_rad == pytest.approx(0.5)
    assert walked.heading_change_rad == 0.0
    sigma_m, sigma_rad = 0.25 * bridge.length_m, np.hypot(0.2, 0.05 * np.sqrt(1.4))
    np.testing.assert_allclose(bridge.covariance, np.diag([sigma_m, sigma_m, sigma_rad]) ** 2)


def test_who_stands_moves_in_the_gap_only() -> None:
    """Seen to stand for 30 s before and 8 s after a gap of 0.6 s."""
    after = across(Hole(31.0, 31.6), step(40.0, 39.6, heading_rad=0.1, segment=1), 0.06)
    _, bridge, _ = odometry_of(step(1.0, 0.5), after)
    assert bridge.length_m == 0.0
    assert np.sqrt(bridge.covariance[0, 0]) == pytest.approx(1.5 * 0.6)
    assert bridge.heading_change_rad == pytest.approx(0.1)


def test_a_gap_of_unknown_duration_lasts_for_the_whole_time_between_the_steps() -> None:
    after = across(Hole(1.2, 2.2, duration_known=False), step(3.0, 2.5, segment=1), np.pi / np.sqrt(3.0))
    _, bridge, _ = odometry_of(step(1.0, 0.5), after)
    assert np.sqrt(bridge.covariance[0, 0]) == pytest.approx(1.5 * 1.5)


def test_after_a_gap_that_nobody_describes_the_heading_is_anything() -> None:
    _, bridge, _ = odometry_of(step(1.0, 0.4), step(3600.0, 3599.4, segment=1))
    assert np.sqrt(bridge.covariance[2, 2]) == pytest.approx(np.pi / np.sqrt(3.0))
    assert np.sqrt(bridge.covariance[0, 0]) == pytest.approx(1.5 * 3598.4)


def test_a_bridge_of_no_time_is_regular() -> None:
    _, bridge, _ = odometry_of(step(1.0, 0.4), step(1.5, 1.0, segment=1))
    np.testing.assert_allclose(np.diag(bridge.covariance), [1e-6, 1e-6, np.pi**2 / 3.0])


def test_headings_of_a_segment_compare_among_themselves() -> None:
    headings = [(0, 0.1), (0, 0.3), (1, 2.0), (1, 1.9)]
    found = odometry_of(
        *(step(1.0 + i, 0.5 + i, segment=segment, heading_rad=yaw) for i, (segment, yaw) in enumerate(headings))
    )
    assert [o.heading_change_rad for o in found if o.observed] == pytest.approx([0.0, 0.2, 0.0, -0.1])


def in_mode(found: Step, mode: CarryingMode) -> Step:
    return replace(found, event=replace(found.event, mode=mode))


@pytest.mark.parametrize(
    ("before", "after", "follows", "besides"),
    [
        (CarryingMode.HOLDING, CarryingMode.POCKET, False, PARAMETERS.sigma_mode_change_rad),
        (CarryingMode.HOLDING, CarryingMode.POCKET, True, 0.0),
        (CarryingMode.HOLDING, CarryingMode.HOLDING, False, 0.0),
        (CarryingMode.UNKNOWN, CarryingMode.HOLDING, False, 0.0),
        (CarryingMode.HOLDING, CarryingMode.UNKNOWN, False, 0.0),
    ],
)
def test_a_change_of_mode_may_have_turned_a_phone_that_the_heading_does_not_follow(
    before: CarryingMode, after: CarryingMode, follows: bool, besides: float
) -> None:
    _, second = odometry_of(in_mode(TURNED, before), replace(in_mode(TURNED_MORE, after), placement_tracked=follows))
    sigma = np.hypot(0.05 * np.sqrt(0.5), besides)
    np.testing.assert_allclose(second.covariance, step_covariance(0.7, 0.07, 0.2, sigma))


def test_the_sigmas_of_a_mode_change_and_of_the_heading_stage_add_up() -> None:
    later = replace(in_mode(TURNED_MORE, CarryingMode.POCKET), sigma_turn_rad=0.3)
    _, second = odometry_of(TURNED, later)
    sigma = np.sqrt(0.05**2 * 0.5 + PARAMETERS.sigma_mode_change_rad**2 + 0.3**2)
    np.testing.assert_allclose(second.covariance, step_covariance(0.7, 0.07, 0.2, sigma))


def test_a_step_on_a_straight_path_is_followed_by_a_heading_prior() -> None:
    def on_path(found: Step) -> Step:
        return replace(found, path_heading_rad=0.25, sigma_path_heading_rad=0.08)

    parameters = OdometryParams(sigma_straight_rad=0.15)
    found = odometry_of(step(1.0, 0.4), on_path(TURNED_MORE), parameters=parameters)
    priors = [item for item in found if isinstance(item, HeadingPrior)]
    assert priors == [HeadingPrior("left", 1.5, 0.25, pytest.approx(0.17), relative=True)]  # type: ignore[arg-type]
    assert isinstance(found[found.index(priors[0]) - 1], StepOdometry)


def test_possible_turns_have_the_noise_of_the_step_and_their_mean_and_covariance_are_those_of_the_step() -> None:
    turns = (TurnHypothesis(0.75, 0.1, 0.05, "straight on"), TurnHypothesis(0.25, 1.3, 0.1, "principal axis"))
    undecided = replace(TURNED_MORE, turn_hypotheses=turns)
    _, found = odometry_of(TURNED, undecided)
    noise = 0.05**2 * 0.5
    sigmas = [one.sigma_rad for one in found.turn_hypotheses]
    assert sigmas == pytest.approx([np.sqrt(0.05**2 + noise), np.sqrt(0.1**2 + noise)])
    assert [one.heading_change_rad for one in found.turn_hypotheses] == [0.1, 1.3]
    assert 0.3 < found.heading_change_rad < 0.42
    off = np.array([0.1, 1.3]) - found.heading_change_rad
    spread = np.sum([0.75, 0.25] * (np.square(sigmas) + off**2))
    assert found.covariance[2, 2] == pytest.approx(spread + 1e-6)
    assert found.covariance[1, 2] == pytest.approx(found.length_m * spread)


def test_the_first_step_of_a_segment_has_no_possible_turns() -> None:
    turns = (TurnHypothesis(1.0, 0.1, 0.05, "straight on"),)
    (first,) = odometry_of(replace(TURNED, turn_hypotheses=turns))
    assert first.turn_hypotheses == ()


def test_a_doubtful_direction_of_motion_widens_the_step_and_not_its_heading() -> None:
    sure = step(1.0, 0.6, length_m=0.5)
    doubtful = replace(sure, sigma_course_rad=0.3)
    more = odometry_of(doubtful)[0].covariance - odometry_of(sure)[0].covariance
    directions = 0.3 * np.random.default_rng(1).standard_normal(400_000)
    by_sampling = [7.0 * 0.25 * np.var(np.cos(directions)), 7.0 * 0.25 * np.var(np.sin(directions)), 0.0]
    np.testing.assert_allclose(more, np.diag(by_sampling), rtol=0.02, atol=1e-12)


def test_a_step_that_may_lead_anywhere_has_half_its_squared_length_in_both_axes() -> None:
    np.testing.assert_allclose(course_covariance(0.8, 10.0), np.diag([0.32, 0.32, 0.0]))
