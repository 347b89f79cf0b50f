"""MMPDR section III-E on made-up steps with known yaw: averages, training, what keeps O_b."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from heading_steps import SAMPLES, block, step_of, walked
from signals import run

from pdr_est.frames import wrap_angle
from pdr_est.front_end.heading.mmpdr_aoc import MmpdrHeading, MmpdrHeadingParams
from pdr_est.online.saved_state import pack, unpack
from pdr_est.types.steps import CarryingMode, Step

HOLDING, SWING, POCKET, TRANS = (CarryingMode[name] for name in ("HOLDING", "SWING", "POCKET", "TRANS"))
OTHER, UNKNOWN = CarryingMode.OTHER, CarryingMode.UNKNOWN


def walk(*parts: tuple[CarryingMode, Sequence[float]]) -> list[Step]:
    """Steps of these modes and yaw angles, deg; those in TRANS are compensated."""
    flat = [(mode, yaw_deg) for mode, yaws_deg in parts for yaw_deg in yaws_deg]
    return [
        step_of(block(number, float(np.deg2rad(yaw_deg))), mode, compensated=mode is TRANS)
        for number, (mode, yaw_deg) in enumerate(flat)
    ]


def headings_deg(steps: Sequence[Step], stage: MmpdrHeading | None = None) -> list[float]:
    found = run(stage or MmpdrHeading(MmpdrHeadingParams()), steps)
    assert [step.event for step in found] == [step.event for step in steps]
    return [round(float(np.rad2deg(step.heading_rad)), 6) for step in found]


def test_holding_is_the_yaw_of_each_step() -> None:
    assert headings_deg(walk((HOLDING, [10.0, 20.0, -170.0]))) == [10.0, 20.0, -170.0]


@pytest.mark.parametrize("before_deg", [20.0, 175.0, -175.0])
def test_swing_trains_with_three_steps_and_takes_the_offset_off(before_deg: float) -> None:
    """The training angles scatter about 60 degrees, which are the offset; then the walker turns by 30."""
    stage = MmpdrHeading(MmpdrHeadingParams())
    swing = [before_deg + angle for angle in (57.0, 60.0, 63.0, 60.0, 90.0)]
    found = headings_deg(walk((HOLDING, [before_deg]), (TRANS, [0.0, 77.0]), (SWING, swing)), stage)
    turned_deg = round(float(np.rad2deg(wrap_angle(np.deg2rad(before_deg + 30.0)))), 6)
    assert found == [before_deg] * 7 + [turned_deg]
    ((time_s, mode, offset_rad),) = stage.trained_offsets
    assert (round(time_s * 50.0), mode) == (6 * SAMPLES - 1, SWING)
    assert np.rad2deg(offset_rad) == pytest.approx(60.0)


@pytest.mark.parametrize("mode", [POCKET, OTHER])
def test_a_pocket_omits_two_steps_trains_with_two_pairs_and_averages_pairs(mode: CarryingMode) -> None:
    """The leg turns the phone to and fro by 20 degrees from step to step; the first two steps are far off."""
    stage = MmpdrHeading(MmpdrHeadingParams())
    pocket = [0.0, 0.0, 120.0, 160.0, 120.0, 160.0, 120.0, 160.0, 130.0, 170.0]
    found = headings_deg(walk((HOLDING, [30.0]), (TRANS, [99.0]), (mode, pocket)), stage)
    assert found == [30.0] * 8 + [30.0, 30.0, 40.0, 40.0]
    ((_, trained, offset_rad),) = stage.trained_offsets
    assert trained is mode
    assert np.rad2deg(offset_rad) == pytest.approx(110.0)


def test_a_return_to_holding_takes_the_yaw_as_it_is() -> None:
    steps = walk((HOLDING, [5.0]), (SWING, [65.0] * 4), (HOLDING, [25.0]))
    assert headings_deg(steps) == [5.0] * 5 + [25.0]


def test_a_transition_within_the_training_begins_a_new_one_with_the_same_baseline() -> None:
    stage = MmpdrHeading(MmpdrHeadingParams())
    steps = walk((HOLDING, [5.0]), (SWING, [65.0] * 2), (TRANS, [0.0]), (SWING, [95.0] * 4))
    assert headings_deg(steps, stage) == [5.0] * 8
    assert [round(np.rad2deg(offset.offset_rad)) for offset in stage.trained_offsets] == [90]


def test_a_walk_that_begins_in_the_pocket_has_no_baseline_and_no_training() -> None:
    stage = MmpdrHeading(MmpdrHeadingParams())
    assert headings_deg(walk((POCKET, [10.0, 20.0, 40.0, 50.0])), stage) == [15.0, 15.0, 45.0, 45.0]
    assert stage.trained_offsets == ()


def test_a_transition_at_the_very_beginning_has_nothing_to_keep() -> None:
    assert headings_deg(walk((TRANS, [10.0]), (HOLDING, [20.0]), (TRANS, [70.0]))) == [10.0, 20.0, 20.0]


def test_a_compensated_step_keeps_the_heading_and_trains_nothing() -> None:
    steps = walk((HOLDING, [5.0]), (SWING, [65.0, 200.0, 65.0, 65.0, 75.0]))
    steps[2] = replace(steps[2], event=replace(steps[2].event, compensated=True))
    assert headings_deg(steps) == [5.0] * 5 + [15.0]


def test_unknown_is_no_change() -> None:
    steps = walk((UNKNOWN, [1.0]), (HOLDING, [5.0]), (SWING, [65.0] * 3), (UNKNOWN, [65.0]), (SWING, [75.0]))
    assert headings_deg(steps) == [1.0, 5.0, 5.0, 5.0, 5.0, 5.0, 15.0]


def test_over_a_gap_offset_and_baseline_are_kept() -> None:
    steps = walk((HOLDING, [5.0]), (SWING, [65.0] * 4))
    later = walked([block(number, np.deg2rad(33.0), segment=1) for number in (9, 10)], SWING)
    assert headings_deg([*steps, *later]) == [5.0] * 5 + [-27.0] * 2


def test_a_step_without_a_second_is_averaged_alone() -> None:
    """Before a standstill, a change of mode and the end."""
    steps = walk((POCKET, [10.0, 20.0, 40.0, 50.0, 60.0]), (HOLDING, [70.0]))
    steps[3] = replace(steps[3], frequency_hz=0.0)
    assert headings_deg(steps) == [15.0, 15.0, 40.0, 55.0, 55.0, 70.0]
    assert headings_deg(walk((POCKET, [10.0, 20.0, 40.0]))) == [15.0, 15.0, 40.0]


def test_the_first_of_a_pair_waits_for_the_second() -> None:
    stage = MmpdrHeading(MmpdrHeadingParams())
    assert [len(stage.push(step)) for step in walk((POCKET, [10.0, 20.0, 40.0]), (HOLDING, [0.0]))] == [0, 2, 0, 2]
    assert stage.flush() == []


def test_the_offsets_are_saved() -> None:
    stage = MmpdrHeading(MmpdrHeadingParams())
    run(stage, walk((HOLDING, [5.0]), (SWING, [65.0] * 4)))
    assert unpack(pack(stage), MmpdrHeading).trained_offsets == stage.trained_offsets != ()


def test_everything_omitted_still_trains() -> None:
    stage = MmpdrHeading(MmpdrHeadingParams(pocket_steps=2, omitted_steps=4))
    assert headings_deg(walk((HOLDING, [0.0]), (POCKET, [0.0] * 4 + [40.0] * 4)), stage) == [0.0] * 9
    assert [round(np.rad2deg(offset.offset_rad)) for offset in stage.trained_offsets] == [40]
