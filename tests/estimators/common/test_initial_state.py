"""Starts that are known, known in part, or to be found; and that the map's origin and north do not matter."""

from dataclasses import replace

import numpy as np
import pytest
from estimator_walks import DEVICE, STEP_S, fix, heading_prior, run, simulate, step, straight, turned, winding

from pdr_est.errors import EstimationError
from pdr_est.estimators import ESTIMATORS, SPECS, EstimatorName
from pdr_est.estimators.common.initial_state import late_start_donor
from pdr_est.estimators.common.timeline import build_timeline
from pdr_est.estimators.kalman.offline_filter import run_filter
from pdr_est.frames import Array, rotation_matrix, wrap_angle
from pdr_est.types.measurements import Measurement, PositionFix, StartPose

every_estimator = pytest.mark.parametrize("name", [name for name in ESTIMATORS if not SPECS[name].sampled])
with_fixes = pytest.mark.parametrize("name", ["ekf", "factor-graph"])
UNIFORM_RAD = np.pi / np.sqrt(3.0)


def off_by(heading_rad: Array, expected_rad: float | Array) -> float:
    return float(np.max(np.abs(wrap_angle(heading_rad - expected_rad))))


@every_estimator
def test_a_known_start_enters_with_its_uncertainty(name: EstimatorName) -> None:
    track = run(name, straight(20), StartPose((5.0, 6.0), 1.2, sigma_position_m=0.4, sigma_heading_rad=0.1))
    assert track.position_m[0] == pytest.approx([5.0, 6.0], abs=1e-6)
    assert track.heading_rad[0] == pytest.approx(1.2, abs=1e-6)
    assert track.covariance_m2[0] == pytest.approx(0.16 * np.eye(2), rel=1e-3, abs=1e-6)
    assert track.sigma_heading_rad[0] == pytest.approx(0.1, rel=1e-3)
    across = np.array([-np.sin(1.2), np.cos(1.2)])
    exact = run(name, straight(20), StartPose((5.0, 6.0), 1.2))
    grown = across @ (track.covariance_m2[-1] - exact.covariance_m2[-1]) @ across
    assert grown == pytest.approx(0.16 + (14.0 * 0.1) ** 2, rel=0.01)


@with_fixes
def test_a_vague_start_gives_way_to_a_fix_as_its_sigma_says(name: EstimatorName) -> None:
    track = run(name, [fix(0, 6.5, 6.0, 0.4)], StartPose((5.0, 6.0), 1.2, sigma_position_m=0.8))
    assert track.position_m[0] == pytest.approx([6.2, 6.0], abs=1e-6)
    assert track.covariance_m2[0] == pytest.approx(np.eye(2) / (1 / 0.64 + 1 / 0.16), abs=1e-6)


@every_estimator
def test_without_start_and_fixes_the_frame_is_the_walker_s_own(name: EstimatorName) -> None:
    track = run(name, [step(1), step(2, turn_rad=np.pi / 2)], StartPose())
    assert track.position_m == pytest.approx(np.array([[0, 0], [0.7, 0], [0.7, 0.7]]), abs=1e-6)
    assert track.heading_rad[0] == pytest.approx(0.0, abs=1e-9)
    assert np.sqrt(track.covariance_m2[0]) == pytest.approx(np.zeros((2, 2)), abs=1e-3)
    assert track.sigma_heading_rad[0] == pytest.approx(0.0, abs=1e-3)


@every_estimator
def test_a_start_position_alone_has_its_first_step_to_the_east(name: EstimatorName) -> None:
    track = run(name, straight(2), StartPose(position_m=(3.0, 4.0), sigma_position_m=0.5))
    assert track.position_m[1] == pytest.approx([3.7, 4.0], abs=1e-6)
    assert np.sqrt(np.diag(track.covariance_m2[0])) == pytest.approx([0.5, 0.5], rel=1e-3)


@every_estimator
def test_a_known_position_and_fixes_tell_the_heading(name: EstimatorName) -> None:
    walk = simulate(
        np.random.default_rng(1), winding(60, np.random.default_rng(2)), (4.0, 5.0, 2.5), fix_every=10, first_fix=10
    )
    track = run(name, walk.measurements, StartPose(position_m=(4.0, 5.0), sigma_position_m=0.01))
    assert off_by(track.heading_rad[-20:], walk.truth[-20:, 2]) < 4.0 * np.max(track.sigma_heading_rad[-20:])
    assert np.max(track.sigma_heading_rad[-20:]) < 0.2


@every_estimator
def test_a_known_heading_and_one_fix_on_the_way_tell_the_position(name: EstimatorName) -> None:
    start = StartPose(heading_rad=2.0, sigma_heading_rad=0.02)
    track = run(name, [*straight(30), fix(10, 100.0, 50.0, 0.1)], start)
    direction = np.array([np.cos(2.0), np.sin(2.0)])
    assert track.position_m[10] == pytest.approx([100.0, 50.0], abs=1e-3)
    assert track.position_m[30] == pytest.approx([100.0, 50.0] + 14.0 * direction, abs=1e-3)
    assert off_by(track.heading_rad, 2.0) < 1e-3
    assert track.sigma_heading_rad[0] == pytest.approx(0.02, rel=0.01)
    assert np.sqrt(np.diag(track.covariance_m2[10])) == pytest.approx([0.1, 0.1], rel=0.01)


@pytest.mark.parametrize("name", ["dead-reckoning", "factor-graph"])
def test_a_known_heading_leads_back_from_the_fix_to_the_start(name: EstimatorName) -> None:
    track = run(name, [*straight(30), fix(10, 100.0, 50.0, 0.1)], StartPose(heading_rad=2.0))
    expected = np.array([100.0, 50.0]) - 7.0 * np.array([np.cos(2.0), np.sin(2.0)])
    assert track.position_m[0] == pytest.approx(expected, abs=1e-3)
    assert 0.7 < np.sqrt(np.trace(track.covariance_m2[0])) < 1.3  # 10 % of 7 m, and the noise of ten steps


def test_before_its_first_fix_a_filter_of_unknown_position_says_so() -> None:
    track = run("ekf", [*straight(30), fix(10, 100.0, 50.0, 0.1)], StartPose(heading_rad=2.0))
    assert np.sqrt(np.trace(track.covariance_m2[9])) > 1000.0


@every_estimator
def test_nothing_known_but_fixes_tells_the_whole_pose(name: EstimatorName) -> None:
    walk = simulate(
        np.random.default_rng(3), winding(60, np.random.default_rng(4)), (-30.0, 80.0, -2.0), fix_every=15
    )
    track = run(name, walk.measurements, StartPose())
    error = track.position_m - walk.truth[:, :2]
    distance = np.einsum("ni,nij,nj->n", error, np.linalg.inv(track.covariance_m2), error)
    assert np.max(distance) < 16.0  # four sigmas
    assert np.linalg.norm(error, axis=1)[-1] < 5.0
    assert track.sigma_heading_rad[-1] < 0.2


@every_estimator
def test_one_fix_places_the_walk_and_leaves_its_direction_open(name: EstimatorName) -> None:
    track = run(name, [*straight(10), fix(0, 20.0, 30.0, 0.3)], StartPose())
    assert track.position_m[0] == pytest.approx([20.0, 30.0], abs=1e-3)
    assert np.sqrt(np.diag(track.covariance_m2[0])) == pytest.approx([0.3, 0.3], rel=0.01)
    assert track.sigma_heading_rad == pytest.approx(np.full(11, UNIFORM_RAD), rel=0.02)
    assert np.trace(track.covariance_m2[10]) > 0.9 * 7.0**2


@pytest.mark.parametrize("name", ["dead-reckoning", "factor-graph"])
def test_a_walk_with_one_late_fix_passes_through_it(name: EstimatorName) -> None:
    track = run(name, [*straight(10), fix(6, 20.0, 30.0, 0.3)], StartPose())
    assert track.position_m[6] == pytest.approx([20.0, 30.0], abs=1e-3)
    assert np.linalg.norm(track.position_m[10] - track.position_m[0]) == pytest.approx(7.0, abs=0.01)


@every_estimator
def test_fixes_without_any_walk_between_leave_the_direction_open(name: EstimatorName) -> None:
    there = [fix(k, 5.0, 5.0 + 0.001 * k, 0.5) for k in (-3, -2, -1, 0)]
    track = run(name, [*straight(10), *there], StartPose())
    assert np.sqrt(np.diag(track.covariance_m2[0])) == pytest.approx([0.25, 0.25], rel=0.01)
    assert track.sigma_heading_rad[0] == pytest.approx(UNIFORM_RAD, rel=0.02)


@every_estimator
def test_a_loop_with_fixes_at_one_place_leaves_its_direction_open(name: EstimatorName) -> None:
    loop = [step(k, turn_rad=2.0 * np.pi / 40) for k in range(1, 81)]
    track = run(name, [*loop, *(fix(k, 5.0, 5.0, 0.5) for k in (0, 40, 80))], StartPose())
    assert np.all(np.isfinite(track.position_m))
    assert np.min(track.sigma_heading_rad) > 1.0
    assert track.position_m[[0, 40, 80]] == pytest.approx(np.full((3, 2), 5.0), abs=0.5)


@every_estimator
def test_two_fixes_far_apart_tell_direction_and_length(name: EstimatorName) -> None:
    track = run(name, [*straight(60), fix(0, 0.0, 0.0, 0.05), fix(60, 0.0, 46.2, 0.05)], StartPose())
    assert off_by(track.heading_rad[-1:], np.pi / 2) < 2e-3
    assert track.position_m[-1] == pytest.approx([0.0, 46.2], abs=0.05)
    assert track.length_scale == pytest.approx(1.098, abs=0.5 * track.sigma_length_scale)  # 1 +- 0.1 and 1.1 +- 0.01


@pytest.mark.parametrize("steps", [[60], [30, 60], [7, 15, 30, 60]], ids=str)
def test_a_filter_that_found_its_start_knows_as_much_at_the_end_as_the_smoother(steps: list[int]) -> None:
    """Exact fixes, so that what is left to know is the noise of the steps between them."""
    walk = [*straight(60), *(fix(k, 0.0, 0.7 * k, 0.02) for k in (0, *steps))]
    filtered, smoothed = run("ekf", walk, StartPose()), run("factor-graph", walk, StartPose())
    assert filtered.sigma_heading_rad[-1] == pytest.approx(smoothed.sigma_heading_rad[-1], rel=0.15)
    assert filtered.sigma_length_scale == pytest.approx(smoothed.sigma_length_scale, rel=0.15)


@every_estimator
def test_a_heading_prior_alone_tells_the_direction(name: EstimatorName) -> None:
    track = run(name, [*straight(20), heading_prior(0, 2.5, 0.05)], StartPose())
    assert off_by(track.heading_rad, 2.5) < 1e-3
    assert track.position_m[0] == pytest.approx([0.0, 0.0], abs=1e-6)
    assert track.sigma_heading_rad[0] == pytest.approx(0.05, rel=0.05)
    assert track.length_scale == pytest.approx(1.0, abs=1e-3)
    assert track.sigma_length_scale == pytest.approx(0.1, rel=0.05)


@with_fixes
def test_a_heading_prior_and_a_fix_need_no_second_fix(name: EstimatorName) -> None:
    track = run(name, [*straight(20), fix(0, 7.0, 8.0, 0.1), heading_prior(4, 2.5, 0.05)], StartPose())
    assert off_by(track.heading_rad[-1:], 2.5) < 0.01
    assert track.position_m[-1] == pytest.approx([7.0 + 14.0 * np.cos(2.5), 8.0 + 14.0 * np.sin(2.5)], abs=0.1)


def moved(measurements: list[Measurement], pose: tuple[float, float, float]) -> list[Measurement]:
    """The same measurements in a map that is turned and shifted."""
    turn = rotation_matrix(pose[2])
    return [
        replace(m, position_m=turned(pose, m.position_m[None])[0], covariance_m2=turn @ m.covariance_m2 @ turn.T)
        if isinstance(m, PositionFix)
        else m
        for m in measurements
    ]


@every_estimator
@pytest.mark.parametrize("known", ["position", "heading", "both", "nothing"])
def test_turning_and_shifting_the_map_turns_and_shifts_the_track(name: EstimatorName, known: str) -> None:
    """Up to the spacing of the hypotheses about an unknown heading, which do not turn with the map."""
    walk = simulate(np.random.default_rng(5), winding(60, np.random.default_rng(6)), fix_every=12, first_fix=5)
    skewed = PositionFix(22.2, walk.truth[44, :2], np.array([[0.5, 0.3], [0.3, 0.4]]), robust=True)
    measurements = [*walk.measurements, skewed]
    pose = (40.0, -70.0, 2.0)
    here = run(name, measurements, start_at((0.0, 0.0, 0.0), known))
    there = run(name, moved(measurements, pose), start_at(pose, known))
    turn = rotation_matrix(pose[2])
    searched = known in ("position", "nothing") and name != "factor-graph"
    rel, abs_m = (2e-2, 0.05) if searched else (1e-4, 1e-4)
    assert there.position_m == pytest.approx(turned(pose, here.position_m), abs=abs_m)
    found = here.sigma_heading_rad < 1.0  # before, the heading of a filter is without meaning
    assert off_by(there.heading_rad[found], here.heading_rad[found] + pose[2]) < (5e-3 if searched else 1e-5)
    of_map = turn @ here.covariance_m2 @ turn.T
    assert there.covariance_m2 == pytest.approx(
        of_map, rel=rel, abs=rel * np.max(np.abs(of_map)) if searched else 1e-5
    )
    assert there.sigma_heading_rad == pytest.approx(here.sigma_heading_rad, rel=5.0 * rel if searched else rel)
    assert there.length_scale == pytest.approx(here.length_scale, abs=1e-3 if searched else 1e-6)


def start_at(pose: tuple[float, float, float], known: str) -> StartPose:
    return StartPose(
        position_m=pose[:2] if known in ("position", "both") else None,
        heading_rad=pose[2] if known in ("heading", "both") else None,
        sigma_position_m=0.3,
        sigma_heading_rad=0.1,
    )


def test_the_direction_is_found_before_the_filter_turns_to_poses() -> None:
    walk = simulate(np.random.default_rng(7), winding(60, np.random.default_rng(8)), (0, 0, 3.0), fix_every=20)
    (filtered,) = run_filter(build_timeline(DEVICE, 0.0, walk.measurements), StartPose(), 0.1)
    assert filtered.aligned_from == 20
    assert len(filtered.states) == 41
    assert filtered.covariance[19, 2, 2] > 1.0
    assert filtered.covariance[20, 2, 2] < 0.04


def test_before_the_direction_is_known_the_covariance_is_that_of_all_directions() -> None:
    forward, left, heading, steps = 0.01, 0.03, 0.002, 20
    walk = straight(steps, 0.7, np.diag([forward, left, heading]))
    track = run("ekf", [*walk, fix(0, 5.0, 6.0, 0.3)], StartPose())
    turned_away = 1.0 - np.exp(-heading)  # variance of a unit vector after one step
    of_turns = 0.7**2 * turned_away * sum(m**2 for m in range(steps))
    per_axis = 0.5 * ((0.7 * steps) ** 2 + of_turns + steps * (forward + left))
    # Hypotheses 10 degrees apart bend the arc to tangents, which are longer.
    assert track.covariance_m2[-1] == pytest.approx((0.09 + per_axis) * np.eye(2), rel=0.08, abs=0.2)
    assert track.position_m[-1] == pytest.approx([5.0, 6.0], abs=1e-6)


def test_a_gap_in_which_the_walker_may_have_turned_ends_what_was_known_of_the_direction() -> None:
    """Before the gap two fixes hint at east, after it the walk goes north."""
    east = [*straight(3), fix(0, 0.0, 0.0, 0.2), fix(3, 2.1, 0.0, 0.2)]
    bridge = step(43, 0.0, 0.0, np.diag([400.0, 400.0, 3.3]), observed=False)
    north = [step(k) for k in range(44, 74)]
    fixes = [fix(k, 20.0, 0.7 * (k - 43), 0.2) for k in (43, 50, 57, 64, 73)]
    track = run("ekf", [*east, bridge, *north, *fixes], StartPose())
    settled = np.flatnonzero((track.sigma_heading_rad < 0.2) & (track.time_s > 43 * STEP_S))
    error = wrap_angle(track.heading_rad - np.pi / 2)
    assert len(settled) > 20
    assert np.max(np.abs(error[settled] / track.sigma_heading_rad[settled])) < 1.0
    assert track.length_scale == pytest.approx(1.0, abs=0.03)


def test_position_and_length_scale_outlast_a_gap_in_the_direction() -> None:
    known = [*straight(40), *(fix(k, 0.77 * k, 0.0, 0.1) for k in range(0, 37, 4))]
    bridge = step(41, 0.0, 0.0, np.diag([0.25, 0.25, 3.3]), observed=False)
    before, after = (
        run("ekf", [*known, *more, fix(42, 90.0, 0.0, 1e4)], StartPose((0.0, 0.0), 0.0)) for more in ([], [bridge])
    )
    assert after.position_m[41] == pytest.approx(before.position_m[40], abs=1e-6)
    assert after.covariance_m2[41] == pytest.approx(before.covariance_m2[40] + 0.25 * np.eye(2), rel=1e-4)
    assert after.sigma_heading_rad[41] == pytest.approx(UNIFORM_RAD, rel=0.01)
    assert after.length_scale == pytest.approx(before.length_scale, abs=1e-6)
    assert after.sigma_length_scale == pytest.approx(before.sigma_length_scale, rel=1e-4)


@pytest.mark.parametrize(
    ("number", "time_s", "present", "donor"),
    [
        (0, 5.0, {0, 2}, None),
        (0, 5.1, {0, 2}, 0),
        (0, 9.0, {3, 1, 2}, 1),
        (0, 9.0, set(), None),
        (1, 9.0, {0}, None),
    ],
    ids=["in time", "late", "the first of several", "nobody there", "not its first node"],
)
def test_a_device_that_begins_more_than_five_seconds_late_has_a_donor(
    number: int, time_s: float, present: set[int], donor: int | None
) -> None:
    assert late_start_donor(number, time_s, 0.0, present) == donor


def test_no_fix_may_have_the_source_of_the_start() -> None:
    named = PositionFix(5.0, np.zeros(2), np.eye(2), source="start")
    with pytest.raises(EstimationError, match=r"at 5\.0 s has the source 'start', .* give it another name"):
        run("ekf", [*straight(20), named], StartPose())
