"""PSP's controllers against sequences by hand, and the feedback system on made-up strides."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from heading_steps import SAMPLES, turning_block, walked
from signals import RATE_HZ, run

from pdr_est.frames import wrap_angle
from pdr_est.front_end.heading.hde_controller import HdeController, HdeParams, turn_sign
from pdr_est.front_end.heading.psp import PspHeading
from pdr_est.front_end.heading.tie_controller import TieController, TieParams
from pdr_est.types.steps import CarryingMode, Step

STRIDE_S = 2.0 * SAMPLES / RATE_HZ
PARAMETERS = HdeParams(increment_radps=float(np.deg2rad(0.1)) / STRIDE_S)  # n c is a tenth of a degree


def strides(*turns_deg: float, up: tuple[float, float, float] = (0.0, 1.0, 0.0)) -> list[Step]:
    """Two steps a stride; the leg turns the phone by 20 degrees more in the first and back in the second."""
    halves = [half for turn_deg in turns_deg for half in (0.5 * turn_deg + 20.0, 0.5 * turn_deg - 20.0)]
    blocks = [turning_block(number, float(np.deg2rad(half)), up) for number, half in enumerate(halves)]
    return walked(blocks, CarryingMode.POCKET)


def degrees_of(steps: Sequence[Step], name: str = "heading_rad") -> list[float]:
    """One value a stride; both steps of a stride have the same."""
    values = [round(float(np.rad2deg(getattr(step, name))), 6) for step in steps]
    np.testing.assert_array_equal(values[::2], values[1::2])
    return values[::2]


def stage(hde: HdeParams | None = PARAMETERS, tie: TieParams | None = None, priors: bool = False) -> PspHeading:
    return PspHeading(RATE_HZ, hde, tie, priors)


@pytest.mark.parametrize(
    ("change_deg", "turn"), [(0.0, 0), (9.9, 0), (-9.9, 0), (10.0, 0), (10.1, 1), (-10.1, -1), (350.0, 1)]
)
def test_turns(change_deg: float, turn: int) -> None:
    assert turn_sign(float(np.deg2rad(change_deg)), float(np.deg2rad(10.0))) == turn


def compensations_deg(headings_deg: Sequence[float], parameters: HdeParams = PARAMETERS) -> list[tuple[int, float]]:
    """T and I for headings that are given instead of fed back."""
    controller = HdeController(parameters)
    found = []
    for before, latest in pairwise(headings_deg):
        turn, compensation_rad = controller.update(float(np.deg2rad(latest)), float(np.deg2rad(before)), STRIDE_S)
        found.append((turn, round(float(np.rad2deg(compensation_rad)), 9) + 0.0))
    return found


def test_hde_integrates_against_the_deviation() -> None:
    """Left of a dominant direction the compensation falls, right of it it grows; on it, it begins anew (eq. 4)."""
    assert compensations_deg([1.0, 2.0, 3.0, 2.0]) == [(0, -0.1), (0, -0.2), (0, -0.3)]
    assert compensations_deg([89.0, 88.0, 87.0]) == [(0, 0.1), (0, 0.2)]
    assert compensations_deg([1.0, 2.0, 0.0, 1.0, 2.0]) == [(0, -0.1), (0, 0.0), (0, 0.0), (0, -0.1)]


def test_hde_does_not_swing_over() -> None:
    """Eq. 4: on the other side of the dominant direction the compensation begins at 0."""
    assert compensations_deg([1.0, 1.0, 1.0, -1.0, -1.0]) == [(0, -0.1), (0, -0.2), (0, 0.0), (0, 0.1)]


def test_hde_rests_in_turns_and_goes_on_behind_them() -> None:
    assert compensations_deg([1.0, 1.0, 31.0, 61.0, 91.0, 92.0, 93.0]) == [
        (0, -0.1),
        (1, -0.1),
        (1, -0.1),
        (1, -0.1),
        (0, -0.2),
        (0, -0.3),
    ]
    assert [turn for turn, _ in compensations_deg([1.0, 1.0, -31.0, -61.0])] == [0, -1, -1]


@pytest.mark.parametrize(
    ("spacing_deg", "first_deg", "heading_deg", "dominant_deg"),
    [
        (90.0, 0.0, 44.0, 0.0),
        (90.0, 0.0, 46.0, 90.0),
        (90.0, 0.0, -130.0, -90.0),
        (90.0, 0.0, 725.0, 0.0),
        (90.0, 0.0, 181.0, -180.0),
        (90.0, 10.0, 56.0, 100.0),
        (45.0, 0.0, 46.0, 45.0),
        (60.0, 5.0, 36.0, 65.0),
    ],
)
def test_dominant_directions(spacing_deg: float, first_deg: float, heading_deg: float, dominant_deg: float) -> None:
    parameters = HdeParams(
        dominant_spacing_rad=float(np.deg2rad(spacing_deg)), first_direction_rad=float(np.deg2rad(first_deg))
    )
    found = HdeController(parameters).dominant_rad(float(np.deg2rad(heading_deg)))
    assert float(wrap_angle(found - np.deg2rad(dominant_deg))) == pytest.approx(0.0, abs=1e-9)


def test_tie_adds_the_mean_magnitude_in_the_sense_of_the_turn() -> None:
    controller = TieController(TieParams())
    assert controller.update(1, 0.7) == 0.0  # nothing recorded yet
    assert [controller.update(0, value) for value in (-0.1, 0.3, 0.0, -0.2)] == [-0.1, 0.3, 0.0, -0.2]
    assert controller.update(1, 0.7) == pytest.approx(0.15)
    assert controller.update(-1, 0.7) == pytest.approx(-0.15)


def test_tie_with_the_mean_of_the_corrections_leaves_out_what_eq_4_has_set_to_zero() -> None:
    counting, sparing = (TieController(TieParams(average=average)) for average in ("magnitude", "corrections"))
    for tie in (counting, sparing):
        assert [tie.update(0, value) for value in (0.02, 0.0, -0.04, 0.0)] == [0.02, 0.0, -0.04, 0.0]
    assert counting.update(1, 0.0) == pytest.approx(0.015)
    assert sparing.update(1, 0.0) == pytest.approx(0.03)
    assert TieController(TieParams(average="corrections")).update(-1, 0.1) == 0.0


def test_tie_with_the_signed_mean() -> None:
    controller = TieController(TieParams(average="signed"))
    for value in (-0.1, 0.3, 0.0, -0.6):
        controller.update(0, value)
    assert controller.update(1, 0.0) == pytest.approx(-0.1)
    assert controller.update(-1, 0.0) == pytest.approx(0.1)


def test_the_gyroscope_alone_adds_up() -> None:
    assert degrees_of(run(stage(None), strides(1.0, 2.0, -5.0, 100.0, 100.0))) == [1.0, 3.0, -2.0, 98.0, -162.0]


def test_a_phone_on_its_head_counts_with_the_other_sign() -> None:
    assert degrees_of(run(stage(None), strides(1.0, 2.0, up=(0.0, -0.9, 0.1)))) == [-1.0, -3.0]


def test_the_feedback_by_hand() -> None:
    """I is 0 in the first stride and, because the walk began on the dominant direction (eq. 4), in the second; then
    -0.1 and -0.2, the latter in the stride that turns, whose T is still 0. In the last one T = 1: HDE adds nothing,
    TIE the mean of 0, 0, 0.1 and 0.2."""
    turns = strides(1.0, 0.0, 0.0, 45.0, 45.0)
    assert degrees_of(run(stage(), turns)) == [1.0, 1.0, 0.9, 45.7, 90.7]
    assert degrees_of(run(stage(tie=TieParams()), turns)) == [1.0, 1.0, 0.9, 45.7, 90.775]
    mirrored = strides(-1.0, 0.0, 0.0, -45.0, -45.0)
    assert degrees_of(run(stage(tie=TieParams()), mirrored)) == [-1.0, -1.0, -0.9, -45.7, -90.775]


@pytest.mark.parametrize("first_deg", [0.0, 20.0])
def test_hde_removes_a_constant_drift(first_deg: float) -> None:
    """A hundred strides, each of which drifts by 0.3 degrees: 30 in all without it."""
    parameters = HdeParams(
        increment_radps=PARAMETERS.increment_radps, first_direction_rad=float(np.deg2rad(first_deg))
    )
    drifting = strides(first_deg, *[0.3] * 100)
    assert degrees_of(run(stage(None), drifting))[-1] == pytest.approx(first_deg + 30.0)
    found = np.array(degrees_of(run(stage(parameters), drifting)))
    assert np.abs(found[1:] - first_deg).max() < 1.5


def test_as_priors_the_headings_stay_and_straight_strides_get_their_direction() -> None:
    found = run(stage(priors=True), strides(1.0, 0.0, 0.0, 45.0, 44.0, 0.0, 0.0))
    assert degrees_of(found) == [1.0, 1.0, 1.0, 46.0, 90.0, 90.0, 90.0]
    np.testing.assert_equal(degrees_of(found, "path_heading_rad"), [0.0, 0.0, 0.0, 90.0, np.nan, np.nan, 90.0])
    sigma = [step.sigma_path_heading_rad for step in found[::2]]
    np.testing.assert_equal(sigma, [0.05] * 4 + [np.nan] * 2 + [0.05])


def test_as_increments_there_are_no_priors() -> None:
    assert all(np.isnan(step.path_heading_rad) for step in run(stage(), strides(1.0, 0.0, 0.0)))


def test_over_a_gap_the_heading_is_kept() -> None:
    first = strides(30.0, 0.0)
    later = walked([replace(turning_block(number, 0.1), segment=1) for number in (9, 10)], CarryingMode.POCKET)
    assert degrees_of(run(stage(None), [*first, *later])) == [30.0, 30.0, round(30.0 + float(np.rad2deg(0.2)), 6)]
