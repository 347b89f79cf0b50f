"""What the detector `auto` does beyond counting humps: swinging hands, runners, steps that a change of mode hides."""

from dataclasses import replace

import numpy as np
import pytest
from signals import RATE_HZ, level, levels_of, run

from pdr_est.frames import Array
from pdr_est.front_end.steps.bandpass_peaks import (
    AutoStepParams,
    BandpassPeakDetector,
    StepIntervals,
    horizontal_rotation_rate,
)
from pdr_est.simulate import mmpdr_indoor, simulate_walk
from pdr_est.types.sensors import LevelBlock
from pdr_est.types.steps import CarryingMode, StepEvent

BORDER_S = 10.0


def times(count_s: float) -> Array:
    return np.arange(round(count_s * RATE_HZ)) / RATE_HZ


def events(block: LevelBlock) -> list[StepEvent]:
    return run(BandpassPeakDetector(RATE_HZ, AutoStepParams()), [block])


def humps(at_s: Array, duration_s: float, height_mps2: float) -> Array:
    """Smooth humps of 0.3 s at some times."""
    distance = np.abs(times(duration_s)[:, None] - at_s) / 0.15
    return height_mps2 * np.sum(np.where(distance < 1.0, np.cos(0.5 * np.pi * distance) ** 2, 0.0), axis=1)


def with_modes(block: LevelBlock, before: CarryingMode, after: CarryingMode) -> LevelBlock:
    mode = np.where(block.time_s < BORDER_S, before, after).astype(np.int8)
    return replace(block, mode=mode)


def test_strides_alone_are_felt_by_a_hand_whose_swing_hides_the_trunk() -> None:
    """The acceleration has one hump a stride of 1.1 s; the arm turns round twice in it."""
    t = times(30.0)
    swing = replace(
        level(2.0 * np.sin(2.0 * np.pi * t / 1.1)),
        rotation_rate_radps=np.outer(3.0 * np.cos(2.0 * np.pi * t / 1.1), [0.0, 1.0, 0.0]),
    )
    moded = with_modes(swing, CarryingMode.SWING, CarryingMode.SWING)
    found_s = np.array([event.time_s for event in events(moded)])
    np.testing.assert_allclose(np.diff(found_s[2:]), 0.55, atol=0.03)
    assert len(events(with_modes(swing, CarryingMode.OTHER, CarryingMode.OTHER))) < 0.6 * len(found_s)


@pytest.mark.parametrize("seed", range(4))
def test_every_step_of_a_swinging_phone_is_counted(seed: int) -> None:
    walk = simulate_walk(mmpdr_indoor(CarryingMode.SWING, seed=seed))
    found = run(BandpassPeakDetector(RATE_HZ, AutoStepParams()), levels_of(walk))
    assert abs(len(found) - len(walk.steps)) <= 0.01 * len(walk.steps) + 1


def test_turning_about_the_vertical_is_no_swing() -> None:
    block = level(np.zeros(3))
    rate = np.array([[0.0, 0.0, 2.0], [3.0, 0.0, 0.0], [3.0, 4.0, 1.0]])
    turning = replace(block, rotation_rate_radps=rate, turn_rate_radps=rate[:, 2])
    np.testing.assert_allclose(horizontal_rotation_rate(turning), [0.0, 3.0, 5.0])


def test_the_step_that_a_change_of_mode_hides_is_filled_in() -> None:
    at_s = np.delete(np.arange(2.0, 20.0, 0.6), 13)  # none at 9.8 s
    block = level(humps(at_s, 22.0, 4.0))
    changed = events(with_modes(block, CarryingMode.HOLDING, CarryingMode.POCKET))
    same = events(with_modes(block, CarryingMode.POCKET, CarryingMode.POCKET))
    assert len(changed) == len(same) + 1
    (hidden,) = [event for event in changed if event.confidence == 0.0]
    neighbours = [event for event in changed if abs(event.time_s - hidden.time_s) < 0.8]
    np.testing.assert_allclose(np.diff([event.time_s for event in neighbours]), 0.6, atol=0.03)
    np.testing.assert_allclose(np.diff([event.index for event in neighbours]), 30, atol=2)


def test_who_stands_while_the_mode_changes_takes_no_hidden_step() -> None:
    at_s = np.concatenate([np.arange(2.0, 9.6, 0.6), np.arange(11.3, 20.0, 0.6)])  # a pause of nearly three steps
    block = with_modes(level(humps(at_s, 22.0, 4.0)), CarryingMode.HOLDING, CarryingMode.POCKET)
    assert len(events(block)) == len(at_s)


def rhythm(*steps: tuple[float, CarryingMode]) -> list[StepEvent]:
    """What the rhythm makes of steps at some times in some modes."""
    found = StepIntervals(memory=0.8, standstill_s=2.0)
    return [
        event
        for time_s, mode in steps
        for event in found.fill_hidden_step(StepEvent(round(time_s * RATE_HZ), time_s, 0, mode))
    ]


@pytest.mark.parametrize(
    ("pause_s", "before", "after", "count"),
    [
        (1.9, CarryingMode.HOLDING, CarryingMode.POCKET, 5),
        (1.9, CarryingMode.UNKNOWN, CarryingMode.HOLDING, 4),
        (1.9, CarryingMode.HOLDING, CarryingMode.UNKNOWN, 4),
        (1.9, CarryingMode.HOLDING, CarryingMode.HOLDING, 4),
        (2.1, CarryingMode.HOLDING, CarryingMode.POCKET, 4),
    ],
)
def test_a_step_is_hidden_by_a_change_of_place_but_not_by_a_standstill(
    pause_s: float, before: CarryingMode, after: CarryingMode, count: int
) -> None:
    assert len(rhythm((0.0, before), (1.0, before), (2.0, before), (2.0 + pause_s, after))) == count


def test_a_runner_takes_steps_that_would_be_too_fast_for_a_walker() -> None:
    """From 2.8 to 3.7 steps a second, which is one every 0.27 s."""
    cadence_hz = np.linspace(2.8, 3.7, round(20.0 * RATE_HZ))
    steps_taken = np.cumsum(cadence_hz) / RATE_HZ
    found_s = [event.time_s for event in events(level(20.0 * np.sin(2.0 * np.pi * steps_taken)))]
    assert abs(len(found_s) - steps_taken[-1]) <= 2
    assert np.diff(found_s).max() < 0.4


def test_a_walker_s_double_knock_is_one_step() -> None:
    """Steps 0.7 s apart, each with a knock 0.26 s after it."""
    walking_s = np.arange(2.0, 20.0, 0.7)
    knocks = humps(walking_s, 22.0, 4.0) + humps(walking_s + 0.26, 22.0, 4.0)
    assert len(events(level(knocks))) == len(walking_s)
