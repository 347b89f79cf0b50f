"""Straight stretches of made-up headings, and the pieces that they are cut into."""

from dataclasses import replace

import numpy as np
import pytest
from heading_walks import STEP_S, of_legs, with_headings

from pdr_est.front_end.heading.whole_walk.straight_legs import LegSections, StraightLegParams, straight_leg_sections

PARAMETERS = StraightLegParams()


def pieces_of(heading_rad: np.ndarray) -> LegSections:
    return straight_leg_sections(with_headings(heading_rad), PARAMETERS)


def test_one_leg_is_one_stretch_in_equal_pieces() -> None:
    pieces = pieces_of(of_legs([(170.0, 20)]))
    assert pieces.leg.tolist() == [0] * 5
    assert pieces.first.tolist() == [0, 4, 8, 12, 16]
    assert pieces.last.tolist() == [4, 8, 12, 16, 20]
    np.testing.assert_allclose(pieces.heading_rad, np.deg2rad(170.0))
    np.testing.assert_allclose(np.diff(pieces.time_s), 4 * STEP_S)
    assert not pieces.sigma_change_rad.any()


def test_a_corner_parts_two_stretches_and_headings_go_on_across_the_wrap() -> None:
    pieces = pieces_of(of_legs([(150.0, 12), (240.0, 12)]))
    assert set(pieces.leg) == {0, 1}
    ends = [pieces.last[pieces.leg == number].max() for number in (0, 1)]
    begins = [pieces.first[pieces.leg == number].min() for number in (0, 1)]
    assert begins[0] == 0
    assert 9 <= ends[0] <= 12 <= begins[1] <= 15
    assert ends[1] == 24
    # the pieces at the corner hold averages over the stride with a step behind it
    assert np.rad2deg(pieces.heading_rad[[0, -1]]) == pytest.approx([150.0, 240.0])


def test_what_bends_or_is_short_is_no_stretch() -> None:
    assert len(pieces_of(np.arange(40) * 0.15)) == 0
    assert len(pieces_of(of_legs([(0.0, 5), (90.0, 5), (180.0, 5), (270.0, 5)])[:4])) == 0
    assert len(pieces_of(np.zeros(1))) == 0
    assert len(straight_leg_sections([], PARAMETERS)) == 0


def test_to_and_fro_with_the_legs_is_straight() -> None:
    pieces = pieces_of(1.0 + 0.4 * (-1.0) ** np.arange(21))
    assert (pieces.first[0], pieces.last[-1]) == (0, 21)
    np.testing.assert_allclose(pieces.heading_rad[1:-1], 1.0, atol=1e-9)


def test_a_phone_put_elsewhere_may_displace_its_own_piece_and_the_next() -> None:
    steps = with_headings(of_legs([(0.0, 20)]))
    steps[9] = replace(steps[9], sigma_turn_rad=0.3)
    changed = straight_leg_sections(steps, PARAMETERS).sigma_change_rad
    np.testing.assert_allclose(changed, [0.0, 0.0, 0.3, 0.3, 0.0])


def test_one_put_elsewhere_at_the_first_step_of_a_piece_displaces_that_one_only() -> None:
    steps = with_headings(of_legs([(0.0, 20)]))
    steps[8] = replace(steps[8], sigma_turn_rad=0.3)
    np.testing.assert_allclose(straight_leg_sections(steps, PARAMETERS).sigma_change_rad, [0.0, 0.0, 0.3, 0.0, 0.0])


def test_one_put_elsewhere_between_stretches_displaces_the_next() -> None:
    steps = with_headings(of_legs([(0.0, 12), (90.0, 12)]))
    steps[12] = replace(steps[12], sigma_turn_rad=0.3)
    pieces = straight_leg_sections(steps, PARAMETERS)
    assert pieces.sigma_change_rad[pieces.leg == 1].tolist() == pytest.approx([0.3] + [0.0] * (sum(pieces.leg) - 1))


@pytest.mark.parametrize(("count", "legs"), [(4, 0), (5, 1)])
def test_a_leg_has_five_steps_at_least(count: int, legs: int) -> None:
    assert len(set(pieces_of(np.zeros(count)).leg)) == legs


@pytest.mark.parametrize(("turn_rad", "steps"), [(0.5, 20), (0.499, 0)])
def test_a_change_over_four_steps_of_exactly_the_threshold_is_straight(turn_rad: float, steps: int) -> None:
    """An eighth of a radian a step is half a radian over four."""
    found = straight_leg_sections(with_headings(np.arange(20) / 8.0 - 1.25), StraightLegParams(turn_rad=turn_rad))
    assert sum(found.last - found.first) == steps
