"""Step detection of MMPDR on made-up signals whose events follow from the paper's rules by hand."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from signals import level, run

from pdr_est.frames import STANDARD_GRAVITY_MPS2, Array
from pdr_est.front_end.steps.mmpdr_peaks import MmpdrStepParams, MmpdrSteps, holding_acceleration
from pdr_est.types.sensors import LevelBlock
from pdr_est.types.steps import CarryingMode

RATE_HZ = 200.0
SHARP = {
    "cutoff_hz": 95.0,
    "holding_threshold_mps2": 1.0,
    "peak_sign": 1,
}  # a low-pass that leaves these signals alone
HOLDING, SWING, POCKET = CarryingMode.HOLDING, CarryingMode.SWING, CarryingMode.POCKET
NO_CRITERIA = {"min_interval_s": 0.0, "false_peak_window_s": 0.0}


def zigzag(*corners: tuple[float, float], end_s: float = 3.0) -> Array:
    """Straight lines through (time, value) corners, zero at the beginning and the end."""
    time_s, values = zip((0.0, 0.0), *corners, (end_s, 0.0), strict=True)
    return np.interp(np.arange(round(end_s * RATE_HZ)) / RATE_HZ, time_s, values)


def event_times(signal: Array, **changes: float) -> list[float]:
    detector = MmpdrSteps(RATE_HZ, MmpdrStepParams(**{**SHARP, **changes}))  # type: ignore[arg-type]
    return [event.time_s for event in run(detector, [level(signal, rate_hz=RATE_HZ)])]


def test_crests_above_the_threshold_are_steps() -> None:
    crests = [(0.8, 0.0), (1.0, 3.0), (1.2, 0.0), (1.4, 0.9), (1.6, 0.0), (1.8, 1.1), (2.0, 0.0)]
    assert event_times(zigzag(*crests), **NO_CRITERIA) == pytest.approx([1.0, 1.8], abs=0.006)
    assert event_times(zigzag(*crests), **NO_CRITERIA, holding_threshold_mps2=0.5) == pytest.approx(
        [1.0, 1.4, 1.8], abs=0.006
    )
    assert event_times(zigzag(*crests), **NO_CRITERIA, peak_sign=-1) == []
    assert event_times(-zigzag(*crests), **NO_CRITERIA, peak_sign=-1) == pytest.approx([1.0, 1.8], abs=0.006)


def test_criterion_1_wants_a_fifth_of_a_second_since_the_last_valid_step() -> None:
    crests = [(0.9, 0.0), (1.0, 3.0), (1.07, 1.0), (1.14, 4.0), (1.2, 1.0), (1.27, 3.0), (1.4, 0.0)]
    found = event_times(zigzag(*crests), false_peak_window_s=0.0)
    # 1.14 comes too early although it is the highest; 1.27 is counted from 1.00 and not from the refused 1.14
    assert found == pytest.approx([1.0, 1.27], abs=0.006)


@pytest.mark.parametrize(
    ("trough_s", "found"), [(1.08, [1.3]), (1.115, [1.3]), (1.13, [1.0, 1.3]), (1.16, [1.0, 1.3])]
)
def test_criterion_2_refuses_a_crest_that_a_trough_follows_at_once(trough_s: float, found: list[float]) -> None:
    crests = [(0.9, 0.0), (1.0, 3.0), (trough_s, 1.5), (1.3, 3.5), (1.6, 0.0)]
    assert event_times(zigzag(*crests), min_interval_s=0.0) == pytest.approx(found, abs=0.006)


def test_a_refused_crest_does_not_begin_the_interval_of_criterion_1() -> None:
    crests = [(0.9, 0.0), (1.0, 3.0), (1.05, 1.5), (1.15, 3.5), (1.5, 0.0)]
    assert event_times(zigzag(*crests)) == pytest.approx([1.15], abs=0.006)


def test_the_low_pass_delay_is_taken_off_the_time() -> None:
    time_s = np.arange(round(8.0 * RATE_HZ)) / RATE_HZ
    found = event_times(2.0 * np.sin(2.0 * np.pi * 1.8 * time_s), cutoff_hz=5.0)
    crests_s = (np.arange(15) + 0.25) / 1.8
    settled = [found_s for found_s in found if found_s > 1.0]
    expected = crests_s[(crests_s > 1.0) & (crests_s < 7.95)]
    np.testing.assert_allclose(settled, expected, atol=1.0 / RATE_HZ)


def test_a_segment_is_finished_before_the_next_begins() -> None:
    """A crest whose window the gap cuts off is judged with what there is; the jump to the next is no crest."""
    rising = zigzag((0.8, 0.0), (0.97, 3.0), end_s=1.02)[:202]
    falling = zigzag((0.01, 5.0), (0.2, 0.0), (0.5, 0.0), end_s=1.0)[2:]
    detector = MmpdrSteps(RATE_HZ, MmpdrStepParams(**SHARP))  # type: ignore[arg-type]
    events = run(
        detector,
        [level(rising, rate_hz=RATE_HZ), level(falling, segment=1, first_index=400, rate_hz=RATE_HZ)],
    )
    assert [(event.segment, round(event.time_s, 2)) for event in events] == [(0, 0.97)]


def test_events_carry_index_and_time_of_the_crest() -> None:
    detector = MmpdrSteps(RATE_HZ, MmpdrStepParams(**SHARP))  # type: ignore[arg-type]
    signal = zigzag((0.8, 0.0), (1.0, 3.0), (1.2, 0.0), (1.6, 0.0), (1.8, 3.0), (2.0, 0.0))
    events = run(detector, [level(signal, rate_hz=RATE_HZ, first_index=1000)])
    assert [event.index for event in events] == [1200, 1360]
    assert all(after.time_s - before.time_s == pytest.approx(0.8) for before, after in pairwise(events))


def test_equations_5_and_6_by_hand() -> None:
    up = np.array([[0.0, 0.6, 0.8], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [0.6, 0.0, 0.8], [0.48, 0.6, 0.64]])
    acceleration = np.array([[5.0, 2.0, 3.0]] * 5)
    phi = np.arctan(0.64 / 0.6)
    expected = [3.0 * 0.8 + 2.0 * 0.6, 3.0, 2.0, 3.0, 3.0 * np.sin(phi) + 2.0 * np.cos(phi)]
    np.testing.assert_allclose(holding_acceleration(up, acceleration), expected, atol=1e-12)


def test_equation_5_takes_magnitudes() -> None:
    up, acceleration = np.array([[0.0, -0.6, 0.8], [0.0, 0.6, -0.8]]), np.array([[0.0, 2.0, 3.0]] * 2)
    np.testing.assert_allclose(holding_acceleration(up, acceleration), [3.6, 3.6], atol=1e-12)


@pytest.mark.parametrize("tilt_deg", [0.0, 20.0, 45.0, 70.0, 90.0])
def test_any_tilt_of_a_held_phone_shows_the_same_vertical_acceleration(tilt_deg: float) -> None:
    tilt = np.deg2rad(tilt_deg)
    up = np.array([[0.0, np.sin(tilt), np.cos(tilt)]])
    forward = np.array([[0.0, np.cos(tilt), -np.sin(tilt)]])
    np.testing.assert_allclose(holding_acceleration(up, 1.7 * up + 4.0 * forward), [1.7], atol=1e-12)


# --- the axis of each mode (Table III) -------------------------------------------------------------------------


def carried(mode: CarryingMode, **axes: Array) -> LevelBlock:
    """A flat phone whose x, y, z axes feel these accelerations, or `vertical`, which belongs to none of them."""
    count = len(next(iter(axes.values())))
    felt = np.stack([axes.get(name, np.zeros(count)) for name in "xyz"], axis=1)
    block = level(axes.get("vertical", np.zeros(count)), rate_hz=RATE_HZ)
    return replace(block, acceleration_mps2=felt, mode=np.full(count, mode, dtype=np.int8))


def times_in(mode: CarryingMode, changes: dict[str, float] | None = None, **axes: Array) -> list[float]:
    detector = MmpdrSteps(RATE_HZ, MmpdrStepParams(**{**SHARP, **(changes or {})}))  # type: ignore[arg-type]
    events = run(detector, [carried(mode, **axes)])
    assert all(event.mode is mode for event in events)
    return [event.time_s for event in events]


def crest(time_s: float, height: float = 3.0, half_s: float = 0.2) -> Array:
    return zigzag((time_s - half_s, 0.0), (time_s, height), (time_s + half_s, 0.0))


@pytest.mark.parametrize(
    ("mode", "axis"),
    [
        (HOLDING, "z"),
        (SWING, "y"),
        (POCKET, "z"),
        (CarryingMode.OTHER, "vertical"),
        (CarryingMode.UNKNOWN, "vertical"),
    ],
)
def test_each_mode_looks_at_its_own_acceleration(mode: CarryingMode, axis: str) -> None:
    others = {name: crest(2.0) for name in ("x", "y", "z", "vertical") if name != axis}
    if mode is HOLDING:
        del others["vertical"]  # eq. 6 puts it together from y and z
    assert times_in(mode, **{axis: crest(1.0)}, **others) == pytest.approx([1.0], abs=0.006)


def test_the_threshold_of_a_pocket_is_a_fifth_of_gravity() -> None:
    for share, found in ((0.19, []), (0.21, [1.0])):
        height = share * STANDARD_GRAVITY_MPS2
        assert times_in(POCKET, z=crest(1.0, height)) == pytest.approx(found, abs=0.006)


def test_positive_peaks_count_except_in_swing_where_both_do() -> None:
    wave = crest(1.0) - crest(1.6)
    both = pytest.approx([1.0, 1.6], abs=0.006)
    assert times_in(HOLDING, z=wave) == times_in(POCKET, z=wave) == pytest.approx([1.0], abs=0.006)
    assert times_in(POCKET, {"peak_sign": -1}, z=wave) == pytest.approx([1.6], abs=0.006)
    assert times_in(SWING, y=wave) == both
    assert times_in(SWING, {"peak_sign": -1}, y=wave) == both


@pytest.mark.parametrize(
    ("mode", "axis", "window_s"), [(HOLDING, "z", 0.12), (SWING, "y", 0.12), (POCKET, "z", 0.06)]
)
def test_the_window_of_criterion_2_in_each_mode(mode: CarryingMode, axis: str, window_s: float) -> None:
    """The trough lies 15 ms within the window, at its end, and 10 ms after it."""
    for after_s, valid in ((window_s - 0.015, False), (window_s, False), (window_s + 0.01, True)):
        wave = zigzag((0.8, 0.0), (1.0, 4.0), (1.0 + after_s, 2.5), (1.4, 5.0), (1.8, 0.0))
        expected = [1.0, 1.4] if valid else [1.4]
        assert times_in(mode, **{axis: wave}) == pytest.approx(expected, abs=0.006)


def test_a_negative_peak_of_a_swing_is_refused_by_a_positive_one_at_once() -> None:
    wave = -zigzag((0.8, 0.0), (1.0, 4.0), (1.1, 2.5), (1.4, 5.0), (1.8, 0.0))
    assert times_in(SWING, y=wave) == pytest.approx([1.4], abs=0.006)


@pytest.mark.parametrize(("mode", "axis"), [(HOLDING, "z"), (SWING, "y"), (POCKET, "z")])
def test_criterion_1_in_each_mode(mode: CarryingMode, axis: str) -> None:
    sign = -1.0 if mode is SWING else 1.0
    for apart_s, count in ((0.16, 1), (0.22, 2)):
        wave = crest(1.0, 20.0, 0.1) + sign * np.roll(crest(1.0, 40.0, 0.1), round(apart_s * RATE_HZ))
        assert len(
            times_in(mode, {"false_peak_window_s": 0.0, "pocket_false_peak_window_s": 0.0}, **{axis: wave})
        ) == (count)


def test_a_crest_belongs_to_the_mode_of_its_own_sample() -> None:
    """The mode changes just before or just after the crest; its other side lies in the other mode."""
    for change_s, found in ((0.99, [POCKET]), (1.01, [HOLDING])):
        block = carried(HOLDING, z=crest(1.0))
        detector = MmpdrSteps(RATE_HZ, MmpdrStepParams(**SHARP))  # type: ignore[arg-type]
        mode = block.mode.copy()
        mode[round(change_s * RATE_HZ) :] = POCKET
        assert [event.mode for event in run(detector, [replace(block, mode=mode)])] == found
