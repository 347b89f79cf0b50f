"""Dominant directions of made-up headings whose building, or park, is known."""

import numpy as np
import pytest
from heading_walks import of_legs, park, random_legs, unsteady, with_headings

from pdr_est.frames import Array, wrap_angle
from pdr_est.front_end.heading.whole_walk.dominant_directions import DominantParams, dominant_directions
from pdr_est.front_end.heading.whole_walk.straight_legs import LegSections, StraightLegParams, straight_leg_sections
from pdr_est.types.analysis import DominantDirections

PARAMETERS = DominantParams()
SEEDS = range(6)


def found_in(heading_rad: Array, parameters: DominantParams = PARAMETERS) -> tuple[LegSections, DominantDirections]:
    pieces = straight_leg_sections(with_headings(heading_rad), StraightLegParams())
    found = dominant_directions(pieces, parameters)
    assert found is not None
    return pieces, found


def errors_rad(pieces: LegSections, path_heading_rad: Array, truth_rad: Array) -> Array:
    """Of the directions of the pieces against the true headings in their middle, less that of the first."""
    middle = (pieces.first + pieces.last) // 2
    error = wrap_angle(path_heading_rad - truth_rad[middle])
    return wrap_angle(error - error[0])


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("drift_radps", [0.0, 0.005])
def test_a_building_with_right_angles_is_found_and_the_drift_taken_off(seed: int, drift_radps: float) -> None:
    """Half a degree a second goes on until the walk has turned by a quarter of the spacing and more."""
    rng = np.random.default_rng(seed)
    truth = random_legs(rng, 90.0, 9)
    drift = drift_radps * 0.5 * np.arange(len(truth))
    pieces, found = found_in(unsteady(truth, rng, 0.003) + drift)
    assert (found.number, found.used) == (4, True)
    assert found.spacing_rad == pytest.approx(np.pi / 2.0)
    assert np.abs(errors_rad(pieces, found.path_heading_rad, truth)).max() < 1e-6
    middle = (pieces.first + pieces.last) // 2
    constant = found.rate_radps * 0.5 * middle
    off = found.drift_rad + constant - constant[0] - (drift[middle] - drift[middle[0]])
    assert np.abs(off).max() < 0.25
    assert np.sqrt(np.mean(off**2)) < 0.12


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("rate_deg_per_s", [-0.7, -0.3, 0.2, 0.5])
def test_a_biased_gyroscope_is_found_in_a_building(seed: int, rate_deg_per_s: float) -> None:
    """The walk of 90 s turns by up to a right angle too much; the rate is found within what the random walk hides."""
    rng = np.random.default_rng(seed)
    truth = random_legs(rng, 90.0, 9)
    rate_radps = np.deg2rad(rate_deg_per_s)
    _, found = found_in(unsteady(truth, rng, 0.002) + rate_radps * 0.5 * np.arange(len(truth)))
    assert (found.number, found.used) == (4, True)
    assert found.rate_radps == pytest.approx(rate_radps, abs=np.deg2rad(0.07))


def test_directions_are_not_told_from_headings_that_drift_too_much() -> None:
    """By 8 degrees within a second: any building would fit."""
    walks = [np.random.default_rng(seed) for seed in SEEDS]
    found = [found_in(unsteady(random_legs(rng, 90.0, 9), rng, 0.15))[1] for rng in walks]
    assert all(one.drift_per_sqrt_s < 0.02 for one in found)
    assert sum(one.used for one in found) <= 1


@pytest.mark.parametrize("seed", SEEDS)
def test_a_building_with_six_directions(seed: int) -> None:
    rng = np.random.default_rng(seed)
    truth = random_legs(rng, 60.0, 16)
    _, found = found_in(unsteady(truth, rng, 0.002, 0.02))
    assert found.used
    assert found.number == (3 if set(np.round(np.rad2deg(np.diff(truth))) % 120.0) == {0.0} else 6)


@pytest.mark.parametrize("per_sqrt_s", [0.0, 0.004, 0.02])
@pytest.mark.parametrize("seed", [*range(3), *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(3, 12))])
def test_a_park_has_none(seed: int, per_sqrt_s: float) -> None:
    """Also if the phone's heading drifts: a winding path is not a bad gyroscope in a building."""
    rng = np.random.default_rng(100 + seed)
    heading = unsteady(park(rng, 400), rng, per_sqrt_s)
    pieces = straight_leg_sections(with_headings(heading), StraightLegParams())
    found = dominant_directions(pieces, PARAMETERS)
    assert found is None or not found.used


@pytest.mark.parametrize("seed", SEEDS)
def test_streets_at_any_angle_are_none(seed: int) -> None:
    rng = np.random.default_rng(seed)
    turns = rng.uniform(40.0, 140.0, 14) * rng.choice([-1.0, 1.0], 14)
    legs = [(float(direction), 20) for direction in np.cumsum(turns)]
    _, found = found_in(unsteady(of_legs(legs), rng, 0.003))
    assert not found.used


def test_a_straight_walk_tells_nothing() -> None:
    _, found = found_in(of_legs([(33.0, 80)]))
    assert not found.used
    assert found.log_odds < 2.0


def test_out_and_back_follows_one_line() -> None:
    """One turn round is not enough evidence, many are; the most probable number has half turns."""
    _, once = found_in(of_legs([(10.0, 30), (190.0, 30)]))
    _, often = found_in(of_legs([(10.0 + 180.0 * k, 30) for k in range(8)]))
    assert often.used
    assert often.number % 2 == 0
    assert often.log_odds > once.log_odds + 2.0
    np.testing.assert_allclose(np.cos(2.0 * (often.path_heading_rad - often.path_heading_rad[0])), 1.0, atol=1e-9)


def test_many_halves_of_right_angles_are_eight_directions() -> None:
    rng = np.random.default_rng(1)
    truth = random_legs(rng, 45.0, 20)
    pieces, found = found_in(unsteady(truth, rng, 0.002, 0.02))
    assert (found.number, found.used) == (8, True)
    assert np.abs(errors_rad(pieces, found.path_heading_rad, truth)).max() < 1e-6


@pytest.mark.parametrize("diagonal_deg", [30.0, 45.0, 65.0])
def test_a_diagonal_leg_is_not_bent(diagonal_deg: float) -> None:
    right = [(90.0 * (k % 2), 25) for k in range(5)]
    truth = of_legs([*right, (diagonal_deg, 30), *right])
    pieces, found = found_in(unsteady(truth, np.random.default_rng(3), 0.002))
    assert (found.number, found.used) == (4, True)
    middle = (pieces.first + pieces.last) // 2
    diagonal = np.isclose(truth[middle], np.deg2rad(diagonal_deg))
    inside = diagonal & np.roll(diagonal, 1) & np.roll(diagonal, -1)
    assert inside.sum() >= 4
    assert (found.follows[inside] < 0.5).all()
    assert (found.follows[~diagonal] > 0.5).mean() > 0.9


def test_the_evidence_grows_with_the_turns() -> None:
    odds = [found_in(of_legs([(90.0 * (k % 2), 20) for k in range(legs)]))[1].log_odds for legs in range(1, 9)]
    assert (np.diff(odds) > 0.3).all()


def test_a_given_number_is_used_whatever_the_walk_tells() -> None:
    rng = np.random.default_rng(0)
    _, found = found_in(park(rng, 300), DominantParams(number=5))
    assert (found.number, found.used) == (5, True)
    assert found.spacing_rad == pytest.approx(2.0 * np.pi / 5.0)


def test_a_direction_in_the_map_means_right_angles_unless_a_number_is_given() -> None:
    assert DominantParams().given_number is None
    assert DominantParams(direction_rad=0.3).given_number == 4
    assert DominantParams(direction_rad=0.3, number=6).given_number == 6
    _, found = found_in(of_legs([(33.0, 40)]), DominantParams(direction_rad=0.3))
    assert (found.number, found.used) == (4, True)


def test_without_straight_stretches_there_is_nothing_to_tell() -> None:
    pieces = straight_leg_sections(with_headings(np.arange(40) * 0.2), StraightLegParams())
    assert dominant_directions(pieces, DominantParams(number=4)) is None
