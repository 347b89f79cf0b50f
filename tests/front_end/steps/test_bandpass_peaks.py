"""Rules of the default step detector by hand: rhythm, swinging hands, runners, vehicles, and hidden steps."""

from dataclasses import replace

import numpy as np
import pytest
from signals import RATE_HZ, level, levels_of, run

from pdr_est.frames import Array
from pdr_est.front_end.steps.bandpass_peaks import AutoStepParams, BandpassPeakDetector
from pdr_est.front_end.steps.step_evidence.step_intervals import StepIntervals
from pdr_est.front_end.steps.step_evidence.step_signal import horizontal_rotation_rate
from pdr_est.simulate import mmpdr_indoor, simulate_walk
from pdr_est.types.sensors import LevelBlock
from pdr_est.types.steps import CarryingMode, StepEvent

BORDER_S = 10.0


def times(count_s: float) -> Array:
    return np.arange(round(count_s * RATE_HZ)) / RATE_HZ


def events(block: LevelBlock) -> list[StepEvent]:
    return run(BandpassPeakDetector(RATE_HZ, AutoStepParams()), [block])


def bumps(at_s: Array, duration_s: float, height_mps2: float) -> Array:
    """Smooth bumps of 0.3 s at some times."""
    distance = np.abs(times(duration_s)[:, None] - at_s) / 0.15
    return height_mps2 * np.sum(np.where(distance < 1.0, np.cos(0.5 * np.pi * distance) ** 2, 0.0), axis=1)


def with_modes(block: LevelBlock, before: CarryingMode, after: CarryingMode) -> LevelBlock:
    mode = np.where(block.time_s < BORDER_S, before, after).astype(np.int8)
    return replace(block, mode=mode)


def test_strides_alone_are_felt_by_a_hand_whose_swing_hides_the_trunk() -> None:
    """The acceleration has one peak per stride of 1.1 s; the arm turns round twice in it."""
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
    block = level(bumps(at_s, 22.0, 4.0))
    changed = events(with_modes(block, CarryingMode.HOLDING, CarryingMode.POCKET))
    same = events(with_modes(block, CarryingMode.POCKET, CarryingMode.POCKET))
    assert len(changed) == len(same) + 1
    (added_s,) = {event.time_s for event in changed} - {event.time_s for event in same}
    (hidden,) = [event for event in changed if event.time_s == added_s]
    neighbours = [event for event in changed if abs(event.time_s - hidden.time_s) < 0.8]
    np.testing.assert_allclose(np.diff([event.time_s for event in neighbours]), 0.6, atol=0.03)
    np.testing.assert_allclose(np.diff([event.index for event in neighbours]), 30, atol=2)


def test_who_stands_while_the_mode_changes_takes_no_hidden_step() -> None:
    at_s = np.concatenate([np.arange(2.0, 9.6, 0.6), np.arange(11.3, 20.0, 0.6)])  # a pause of nearly three steps
    block = with_modes(level(bumps(at_s, 22.0, 4.0)), CarryingMode.HOLDING, CarryingMode.POCKET)
    assert len(events(block)) == len(at_s)


def with_hidden_steps(*steps: tuple[float, CarryingMode], strength_ratio: float = 0.05) -> list[StepEvent]:
    """Steps at some times in some modes, with those that did not show; by default the phone rests between them."""
    found = StepIntervals(memory=0.8, standstill_s=2.0)
    return [
        event
        for time_s, mode in steps
        for event in found.fill_hidden_step(StepEvent(round(time_s * RATE_HZ), time_s, 0, mode), strength_ratio)
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
    assert len(with_hidden_steps((0.0, before), (1.0, before), (2.0, before), (2.0 + pause_s, after))) == count


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
    knocks = bumps(walking_s, 22.0, 4.0) + bumps(walking_s + 0.26, 22.0, 4.0)
    assert len(events(level(knocks))) == len(walking_s)


# --- the rules by hand, with a band so wide that it leaves made-up peaks alone

OPEN = {"low_hz": 0.005, "high_hz": 24.0, "strike_lead_s": 0.0}
OTHER, HOLDING, POCKET = CarryingMode.OTHER, CarryingMode.HOLDING, CarryingMode.POCKET


def steps_of(
    *peaks: tuple[float, float], mode: CarryingMode = OTHER, end_s: float = 20.0, **changes: float
) -> list[StepEvent]:
    """Steps of a signal with peaks of some heights at some times."""
    signal = np.zeros(round(end_s * RATE_HZ))
    for time_s, height_mps2 in peaks:
        signal += bumps(np.array([time_s]), end_s, height_mps2)
    block = level(signal)
    block = replace(block, mode=np.full(len(block), mode, dtype=np.int8))
    return run(BandpassPeakDetector(RATE_HZ, AutoStepParams(**(OPEN | changes))), [block])  # type: ignore[arg-type]


def step_times(*peaks: tuple[float, float], mode: CarryingMode = OTHER, **changes: float) -> list[float]:
    return [round(event.time_s, 1) for event in steps_of(*peaks, mode=mode, **changes)]


WALK = tuple((round(1.0 + 0.6 * k, 1), 4.0) for k in range(8))  # until 5.2 s
WALK_S = [time_s for time_s, _ in WALK]


@pytest.mark.parametrize(
    ("time_s", "height", "counts"), [(5.8, 1.6, True), (5.41, 1.4, False), (5.53, 4.0, True), (5.8, 0.5, False)]
)
def test_a_weak_peak_is_a_step_when_the_rhythm_lets_one_expect_it(time_s: float, height: float, counts: bool) -> None:
    """The steps before it are 0.6 s apart and 4 m/s^2 high; the walk goes on after it."""
    after = [(6.4, 4.0), (7.0, 4.0)]
    expected = [*WALK_S, *([time_s] if counts else []), 6.4, 7.0]
    assert step_times(*WALK, (time_s, height), *after, mode=HOLDING) == pytest.approx(expected, abs=0.06)


def test_the_strike_comes_before_the_peak() -> None:
    plain, early = steps_of(*WALK), steps_of(*WALK, strike_lead_s=0.08)
    np.testing.assert_allclose([event.time_s for event in plain], WALK_S, atol=0.02)
    np.testing.assert_allclose([event.time_s for event in early], np.array(WALK_S) - 0.08, atol=0.02)


@pytest.mark.parametrize(("after_s", "extra"), [(0.26, 0), (0.32, 1)])
def test_a_walker_s_steps_are_0_3_s_apart(after_s: float, extra: int) -> None:
    assert len(step_times(*WALK, (5.2 + after_s, 4.0))) == len(WALK) + extra


@pytest.mark.parametrize(("after_s", "extra"), [(0.22, 0), (0.26, 1)])
def test_a_runner_s_steps_are_0_24_s_apart(after_s: float, extra: int) -> None:
    running = [(1.0 + 0.32 * k, 9.0) for k in range(20)]
    assert len(steps_of(*running, (running[-1][0] + after_s, 9.0))) == len(running) + extra


def test_a_single_jolt_after_a_standstill_is_no_step() -> None:
    assert step_times(*WALK, (7.7, 4.0), (10.2, 4.0)) == WALK_S
    assert step_times(*WALK, (7.7, 4.0), (8.3, 4.0)) == [*WALK_S, 7.7, 8.3]
    assert step_times(*WALK, (7.1, 4.0)) == [*WALK_S, 7.1]  # a pause within the walk


@pytest.mark.parametrize(("apart_s", "found"), [(1.2, [1.0, 2.2]), (1.4, [2.4])])
def test_a_walk_begins_with_two_peaks_at_most_1_3_s_apart(apart_s: float, found: list[float]) -> None:
    later_s = [round(1.0 + apart_s + 0.6 * k, 1) for k in range(1, 4)]
    peaks = [(time_s, 4.0) for time_s in (1.0, 1.0 + apart_s, *later_s)]
    assert step_times(*peaks) == pytest.approx([*found, *later_s])


@pytest.mark.parametrize(("first", "found"), [(1.8, [1.0, 1.6, 2.2, 2.8]), (1.4, [1.6, 2.2, 2.8])])
def test_the_first_peak_is_a_step_if_it_has_two_fifths_of_the_second(first: float, found: list[float]) -> None:
    assert step_times((1.0, first), (1.6, 4.0), (2.2, 4.0), (2.8, 4.0)) == found


def test_the_confidence_is_the_probability_that_the_peak_is_a_step() -> None:
    *usual, weak, _ = steps_of(*WALK, (5.8, 1.6), (6.4, 4.0))
    assert all(event.confidence > 0.95 for event in usual)
    assert 0.5 < weak.confidence < 0.95


def noise(low_hz: float, high_hz: float, rms_mps2: float, duration_s: float, seed: int) -> Array:
    """Noise in a band."""
    count = round(duration_s * RATE_HZ)
    frequency = np.fft.rfftfreq(count, 1.0 / RATE_HZ)
    rng = np.random.default_rng(seed)
    spectrum = rng.normal(size=len(frequency)) * np.exp(2j * np.pi * rng.uniform(size=len(frequency)))
    signal: Array = np.fft.irfft(np.where((frequency >= low_hz) & (frequency <= high_hz), spectrum, 0.0), count)
    return signal * rms_mps2 / signal.std()


@pytest.mark.parametrize(("low_hz", "high_hz"), [(1.0, 3.0), (1.0, 1.6), (1.2, 2.0), (1.6, 2.4), (2.2, 3.0)])
def test_nobody_steps_in_a_vehicle_that_vibrates(low_hz: float, high_hz: float) -> None:
    """Ten minutes at 0.35 m/s^2, in which any rhythm of steps occurs; once a minute would be too often."""
    vibration = noise(low_hz, high_hz, 0.35, 600.0, seed=1) + noise(8.0, 14.0, 0.3, 600.0, seed=2)
    assert len(events(level(vibration))) <= 3


def test_who_gets_off_and_walks_takes_every_step() -> None:
    riding = noise(1.0, 2.0, 0.35, 60.0, seed=3)
    walking = np.concatenate([riding, bumps(np.arange(1.0, 19.0, 0.6), 20.0, 4.0)])
    found_s = np.array([event.time_s for event in events(level(walking))])
    assert np.count_nonzero(found_s > 60.5) == 30
    assert np.count_nonzero(found_s < 60.0) <= 1


def test_a_phone_that_is_turned_over_and_over_takes_no_steps() -> None:
    """The same peaks count for a phone that keeps its tilt; turned once in 1.6 s, they are a shaken phone's."""
    t = times(30.0)
    still = level(4.0 * np.sin(2.0 * np.pi * t / 0.6))
    angle = 2.0 * np.pi * t / 1.6
    up = np.stack([np.sin(angle), np.zeros(len(t)), np.cos(angle)], axis=1)
    turned = replace(still, up=up, acceleration_mps2=up * still.vertical_mps2[:, None])
    assert len(events(still)) >= 48
    assert len(events(turned)) <= 2


@pytest.mark.parametrize(("weak", "found"), [(2, 8), (9, 10)])
def test_steps_that_waited_for_too_long_are_none(weak: int, found: int) -> None:
    """A walk begins with weak peaks that only the strong ones after them explain; those wait for 3.5 s at most."""
    heights = [0.5] * weak + [5.0] * 5
    assert len(steps_of(*[(1.0 + 0.6 * k, height) for k, height in enumerate(heights)], first_share=0.0)) <= found


SLOW_LEG = tuple(
    (round(1.0 + 1.6 * k + after_s, 2), height)
    for k in range(8)
    for after_s, height in ((0.0, 4.0), (0.36, 2.0), (0.8, 3.0))
)  # strides of 1.6 s, each with a third peak


@pytest.mark.parametrize(("height", "counts"), [(5.0, False), (10.0, True)])
def test_a_third_peak_of_a_stride_in_a_pocket_is_no_step_unless_it_is_high(height: float, counts: bool) -> None:
    """The last stride, at 12.2 s, has its third peak below or above twice the recent height.

    If it counts, the peak at 13.0 s comes too soon after it.
    """
    changed = [(time_s, height if time_s > 12.5 and peak == 2.0 else peak) for time_s, peak in SLOW_LEG]
    late = [time_s for time_s in step_times(*changed, mode=POCKET, end_s=16.0) if time_s > 8.5]
    expected = [9.0, 9.8, 10.6, 11.4, 12.2, 12.6 if counts else 13.0]
    assert late == pytest.approx(expected, abs=0.06)
    assert len(step_times(*changed, mode=OTHER, end_s=16.0)) == len(SLOW_LEG)


def test_steps_of_a_swinging_hand_are_where_it_turns_back() -> None:
    """Its rotation rate is smallest at 0.275 s and every 0.55 s after that."""
    t = times(15.0)
    swing = replace(
        level(np.zeros(len(t))),
        acceleration_mps2=np.outer(3.0 * np.sin(2.0 * np.pi * t / 1.1), [1.0, 0.0, 0.0]),
        rotation_rate_radps=np.outer(3.0 * np.cos(2.0 * np.pi * t / 1.1), [0.0, 1.0, 0.0]),
        mode=np.full(len(t), CarryingMode.SWING, dtype=np.int8),
    )
    swing.acceleration_mps2[:, 2] = 2.0 * np.sin(4.0 * np.pi * t / 1.1)  # of the trunk
    found = run(BandpassPeakDetector(RATE_HZ, AutoStepParams(**OPEN)), [swing])  # type: ignore[arg-type]
    assert len(found) >= 25
    np.testing.assert_allclose([event.time_s % 0.55 for event in found], 0.275, atol=0.03)


@pytest.mark.parametrize(("pause_s", "hidden"), [(0.7, 0), (0.8, 1), (1.2, 1), (1.3, 0)])
def test_a_hidden_step_makes_a_pause_of_about_two_intervals(pause_s: float, hidden: int) -> None:
    """The interval is 0.5 s; 1.5 to 2.5 times as long is a pause with one step in it."""
    found = with_hidden_steps((0.0, HOLDING), (0.5, HOLDING), (1.0, HOLDING), (1.0 + pause_s, POCKET))
    assert len(found) == 4 + hidden
    assert [event.time_s for event in found if 1.0 < event.time_s < 1.0 + pause_s] == [1.0 + 0.5 * pause_s] * hidden
    assert [event.time_s for event in found if event.compensated] == [1.0 + 0.5 * pause_s] * hidden
