"""Resampling onto the working grid: exact means, and what becomes of everything that recorders do to their clocks."""

from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pdr_est.frames import Array
from pdr_est.preprocessing.resampling import ResampleParams, Resampler
from pdr_est.types.sensors import Channel, Hole, ImuBlock, SensorBlock

FORCE, RATE, ATTITUDE = Channel.SPECIFIC_FORCE, Channel.ROTATION_RATE, Channel.ATTITUDE
PERIOD_S = 0.02


def resample(*blocks: SensorBlock, rate_hz: float = 50.0) -> tuple[list[ImuBlock], Resampler]:
    """All blocks through one resampler; a channel of zeros stands in where force or rate is not given."""
    given_channels = {block.channel for block in blocks}
    spare = [
        SensorBlock(channel, blocks[0].time_s, np.zeros((len(blocks[0].time_s), 3)))
        for channel in (FORCE, RATE)
        if channel not in given_channels
    ]
    channels = tuple(dict.fromkeys([FORCE, RATE, *given_channels]))
    resampler = Resampler(channels, ResampleParams(rate_hz=rate_hz))
    outputs = [output for block in [*blocks, *spare] for output in resampler.push(block)]
    return outputs + resampler.flush(), resampler


def force(time_s: Array, of_time: Callable[[Array], Array]) -> SensorBlock:
    """A specific force with the same function of time on every axis."""
    return SensorBlock(FORCE, time_s, np.repeat(of_time(time_s)[:, None], 3, axis=1))


def joined(blocks: Sequence[ImuBlock], name: str) -> Array:
    return np.concatenate([getattr(block, name) for block in blocks])


def indices(blocks: Sequence[ImuBlock]) -> Array:
    return np.concatenate([block.first_index + np.arange(len(block.time_s)) for block in blocks])


def with_pause(before_s: float, pause_s: float, after_s: float = 2.0, rate_hz: float = 100.0) -> Array:
    """Time stamps from zero with one pause, which begins after a sample at `before_s`."""
    first = np.arange(round(before_s * rate_hz) + 1) / rate_hz
    second = before_s + pause_s + np.arange(round(after_s * rate_hz) + 1) / rate_hz
    return np.concatenate([first, second])


def test_the_specific_force_alone_has_its_own_gaps_and_the_same_means() -> None:
    """What one channel becomes does not depend on whether another one is there."""
    block = force(with_pause(1.0, 2.0), np.sin)
    both, _ = resample(block)
    alone = Resampler((FORCE,), ResampleParams())
    blocks = [*alone.push(block), *alone.push(SensorBlock(RATE, block.time_s, block.values)), *alone.flush()]
    assert [(part.segment, part.rotation_rate_radps) for part in blocks] == [(0, None), (1, None)]
    assert [part.first_index for part in blocks] == [part.first_index for part in both]
    for name in ("time_s", "specific_force_mps2"):
        np.testing.assert_array_equal(joined(blocks, name), joined(both, name))
    assert [(gap.channel, gap.start_s, gap.end_s) for gap in alone.gaps] == [("specific_force", 1.0, 3.0)]


@pytest.mark.parametrize("rate_hz", [25.0, 50.0, 100.0, 333.0, 500.0])
def test_a_straight_line_is_kept_at_the_midpoints_whatever_rate_and_jitter(rate_hz: float) -> None:
    count = round(4.0 * rate_hz)
    time_s = 7.3 + (np.arange(count) + 0.4 * np.random.default_rng(0).uniform(-1.0, 1.0, count)) / rate_hz
    blocks, _ = resample(force(time_s, lambda t: 3.0 - 2.0 * t))
    assert len(blocks) == 1
    grid_s = time_s[0] + PERIOD_S * (np.arange(len(blocks[0].time_s)) + 0.5)
    np.testing.assert_allclose(blocks[0].time_s, grid_s, rtol=0.0, atol=1e-12)
    np.testing.assert_allclose(blocks[0].specific_force_mps2[:, 1], 3.0 - 2.0 * grid_s, rtol=0.0, atol=1e-10)
    assert time_s[-1] - 3.0 * PERIOD_S < blocks[0].time_s[-1] < time_s[-1]


def test_a_grid_value_is_the_mean_of_the_line_through_the_samples() -> None:
    time_s = np.arange(20) / 100.0
    values = np.zeros((20, 3))
    values[1] = [1.0, -2.0, 4.0]  # a hat between 0 and 0.02 s, whose mean is half its height
    values[4] = [1.0, -2.0, 4.0]  # a hat between 0.03 and 0.05 s, cut in two by the edge at 0.04 s
    (block,), _ = resample(SensorBlock(FORCE, time_s, values))
    hat = np.array([1.0, -2.0, 4.0])
    np.testing.assert_allclose(block.specific_force_mps2[:4], [hat / 2, hat / 4, hat / 4, 0 * hat], atol=1e-12)


@pytest.mark.parametrize("rate_hz", [25.0, 50.0, 100.0, 500.0])
def test_the_integral_of_the_rotation_rate_is_kept(rate_hz: float) -> None:
    time_s = np.arange(round(3.0 * rate_hz) + 1) / rate_hz
    rate = np.random.default_rng(1).standard_normal((len(time_s), 3))
    (block,), _ = resample(SensorBlock(RATE, time_s, rate))
    end_s = block.time_s[-1] + PERIOD_S / 2.0
    inside = np.append(time_s[time_s < end_s - 1e-9], end_s)
    turned = [np.trapezoid(np.interp(inside, time_s, rate[:, axis]), inside) for axis in range(3)]
    np.testing.assert_allclose(block.rotation_rate_radps.sum(axis=0) * PERIOD_S, turned, atol=1e-12)


def test_slow_input_is_interpolated_and_fast_input_averaged() -> None:
    slow_s, fast_s = np.arange(51) / 25.0, np.arange(10_001) / 500.0
    (slow,), _ = resample(force(slow_s, np.sin))
    np.testing.assert_allclose(slow.specific_force_mps2[:, 0], np.sin(slow.time_s), atol=3e-4)
    assert np.diff(slow.time_s) == pytest.approx(PERIOD_S)
    noise = np.random.default_rng(2).standard_normal(len(fast_s))
    (fast,), _ = resample(force(fast_s, lambda t: noise))
    assert np.std(fast.specific_force_mps2[:, 0]) == pytest.approx(1.0 / np.sqrt(10.0), rel=0.1)


@pytest.mark.parametrize("rate_hz", [25.0, 100.0])
def test_another_working_rate(rate_hz: float) -> None:
    (block,), _ = resample(force(np.arange(301) / 100.0, lambda t: 2.0 * t), rate_hz=rate_hz)
    assert np.diff(block.time_s) == pytest.approx(1.0 / rate_hz)
    np.testing.assert_allclose(block.specific_force_mps2[:, 0], 2.0 * block.time_s, atol=1e-10)


def test_a_longer_pause_begins_a_segment_and_is_listed() -> None:
    blocks, resampler = resample(force(with_pause(2.0, 0.51), lambda t: t))
    assert [block.segment for block in blocks] == [0, 1]
    assert {(gap.start_s, gap.end_s, gap.reason) for gap in resampler.gaps} == {(2.0, 2.51, "gap")}
    assert [gap.channel for gap in resampler.gaps] == ["specific_force", "rotation_rate"]
    assert blocks[0].time_s[-1] + PERIOD_S / 2 <= 2.0
    assert blocks[1].time_s[0] - PERIOD_S / 2 >= 2.51
    assert blocks[1].time_s[0] - 2.51 < 1.5 * PERIOD_S
    assert [block.hole for block in blocks] == [None, Hole(blocks[0].time_s[-1], blocks[1].time_s[0])]
    for block in blocks:  # nothing of the pause is mixed in
        np.testing.assert_allclose(block.specific_force_mps2[:, 0], block.time_s, atol=1e-10)


def test_exactly_the_longest_pause_is_no_gap_whatever_the_rounding() -> None:
    starts_s = np.arange(3000) / 10.0
    before_s, after_s = starts_s + 0.1, starts_s + 0.6
    rounded_up = starts_s[after_s - before_s > 0.5]
    assert len(rounded_up) > 5
    for start_s in rounded_up:
        blocks, resampler = resample(force(start_s + np.array([0.0, 0.1, 0.6, 0.7]), np.sin))
        assert [block.segment for block in blocks] == [0]
        assert resampler.gaps == ()


def test_points_of_the_grid_are_counted_through_a_gap() -> None:
    blocks, _ = resample(force(with_pause(2.0, 3.3), np.cos))
    counted = (indices(blocks) + 0.5) * PERIOD_S
    np.testing.assert_allclose(joined(blocks, "time_s"), counted, atol=1e-12)
    assert blocks[1].first_index > blocks[0].first_index + len(blocks[0].time_s) + 160


def test_a_gap_of_one_channel_ends_the_segment_of_all() -> None:
    whole_s = np.arange(401) / 100.0
    rate = SensorBlock(RATE, whole_s, np.ones((len(whole_s), 3)))
    blocks, resampler = resample(force(with_pause(2.0, 0.7), np.sin), rate)
    assert [block.segment for block in blocks] == [0, 1]
    assert [(gap.channel, gap.start_s, gap.end_s) for gap in resampler.gaps[:1]] == [("specific_force", 2.0, 2.7)]


def test_a_clock_that_jumps_ahead_by_years_costs_neither_memory_nor_time() -> None:
    blocks, resampler = resample(force(with_pause(2.0, 1.6e9), np.sin))
    assert [block.segment for block in blocks] == [0, 1]
    assert len(blocks[1].time_s) == pytest.approx(100, abs=3)
    assert resampler.gaps[0].end_s == pytest.approx(1.6e9 + 2.0)


def test_a_long_recording_comes_in_parts_without_a_seam() -> None:
    time_s = np.arange(200_000) / 50.0
    blocks, _ = resample(force(time_s, lambda t: t))
    assert {block.segment for block in blocks} == {0}
    assert (np.diff(indices(blocks)) == 1).all()
    np.testing.assert_allclose(joined(blocks, "specific_force_mps2")[:, 0], joined(blocks, "time_s"), atol=1e-7)


def test_duplicate_and_backward_stamps_are_dropped_and_counted() -> None:
    time_s = np.arange(200) / 100.0
    values = np.repeat(time_s[:, None], 3, axis=1)
    wrong_s, wrong = np.array([0.5, 0.5, 0.45]), np.full((3, 3), 99.0)
    spoiled = SensorBlock(
        FORCE,
        np.concatenate([time_s[:51], wrong_s, time_s[51:]]),
        np.concatenate([values[:51], wrong, values[51:]]),
    )
    clean, _ = resample(SensorBlock(FORCE, time_s, values), SensorBlock(RATE, time_s, values))
    blocks, resampler = resample(spoiled, SensorBlock(RATE, time_s, values))
    np.testing.assert_array_equal(blocks[0].specific_force_mps2, clean[0].specific_force_mps2)
    assert resampler.dropped == {"specific_force: duplicate time": 2, "specific_force: backward time": 1}
    assert resampler.gaps == ()


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_what_is_not_finite_is_dropped_and_counted(bad: float) -> None:
    time_s = np.arange(200) / 100.0
    stamps, values = time_s.copy(), np.repeat(2.0 * time_s[:, None], 3, axis=1)
    values[[0, 40, 41], [0, 1, 2]] = bad
    stamps[77] = bad
    (block,), resampler = resample(SensorBlock(FORCE, stamps, values), SensorBlock(RATE, time_s, np.zeros((200, 3))))
    np.testing.assert_allclose(block.specific_force_mps2[:, 1], 2.0 * block.time_s, atol=1e-10)
    assert resampler.dropped["specific_force: not finite"] == 4


def test_a_restarted_clock_begins_a_segment_one_second_later() -> None:
    first_s, second_s = 5.0 + np.arange(201) / 100.0, np.arange(301) / 100.0
    time_s = np.concatenate([first_s, second_s])
    blocks, resampler = resample(force(time_s, lambda t: t))
    assert [block.segment for block in blocks] == [0, 1]
    assert [(gap.start_s, gap.end_s) for gap in resampler.gaps] == [(7.0, 8.0)] * 2
    assert resampler.gaps[0].reason == "clock reset by -7.000 s"
    assert blocks[1].hole is not None
    assert not blocks[1].hole.duration_known
    assert resampler.dropped == {}
    # what was recorded at second 1 of the new clock stands at second 9 of the continued one
    np.testing.assert_allclose(blocks[1].specific_force_mps2[:, 0], blocks[1].time_s - 8.0, atol=1e-10)
    assert sum(len(block.time_s) for block in blocks) == pytest.approx(250, abs=5)


def test_a_clock_may_restart_more_than_once() -> None:
    time_s = np.concatenate([np.arange(201) / 100.0] * 3)
    blocks, resampler = resample(force(time_s, np.sin))
    assert [block.segment for block in blocks] == [0, 1, 2]
    assert (np.diff(joined(blocks, "time_s")) > 0.0).all()
    assert [gap.start_s for gap in resampler.gaps if gap.channel == "specific_force"] == [2.0, 5.0]


def test_quaternions_of_either_sign_give_the_same_attitude() -> None:
    time_s = np.arange(300) / 100.0
    half = 0.5 * time_s
    steady = np.stack([np.cos(half), 0.0 * half, 0.0 * half, np.sin(half)], axis=1)
    signs = np.random.default_rng(3).choice([-1.0, 1.0], 300)
    signs[0] = 1.0
    (expected,), _ = resample(SensorBlock(ATTITUDE, time_s, steady))
    (block,), _ = resample(SensorBlock(ATTITUDE, time_s, steady * signs[:, None]))
    assert block.attitude is not None
    np.testing.assert_array_equal(block.attitude, expected.attitude)
    np.testing.assert_allclose(np.linalg.norm(block.attitude, axis=1), 1.0, atol=1e-12)
    np.testing.assert_allclose(2.0 * np.arctan2(block.attitude[:, 3], block.attitude[:, 0]), block.time_s, atol=1e-6)


def test_only_the_channels_asked_for_matter() -> None:
    resampler = Resampler((FORCE, RATE), ResampleParams())
    time_s, values = np.arange(100) / 50.0, np.ones((100, 3))
    assert resampler.push(SensorBlock(Channel.MAGNETIC_FIELD, time_s + 50.0, values)) == []
    assert resampler.push(SensorBlock(FORCE, time_s, values)) == []
    (block,) = resampler.push(SensorBlock(RATE, time_s, values))
    assert block.magnetic_field_ut is None
    assert block.attitude is None
    with_field, _ = resample(SensorBlock(Channel.MAGNETIC_FIELD, time_s, 40.0 * values))
    np.testing.assert_allclose(with_field[0].magnetic_field_ut, 40.0)


@pytest.mark.parametrize("count", [0, 1, 2])
def test_too_few_samples_give_nothing(count: int) -> None:
    blocks, resampler = resample(force(np.arange(count) / 50.0, np.sin))
    assert blocks == []
    assert resampler.gaps == ()


def test_channels_without_overlap_give_nothing_and_say_what_each_missed() -> None:
    early_s = np.arange(100) / 100.0
    blocks, resampler = resample(
        SensorBlock(FORCE, early_s, np.zeros((100, 3))), SensorBlock(RATE, early_s + 5.0, np.zeros((100, 3)))
    )
    assert blocks == []
    assert [(gap.channel, gap.start_s, gap.end_s) for gap in resampler.gaps] == [
        ("rotation_rate", 0.0, 5.0),
        ("specific_force", 0.99, 5.99),
    ]


def test_what_a_channel_missed_at_the_ends_is_listed() -> None:
    whole_s = np.arange(1001) / 100.0
    part_s = whole_s[(whole_s >= 1.0) & (whole_s <= 6.0)]
    blocks, resampler = resample(force(whole_s, np.sin), SensorBlock(RATE, part_s, np.zeros((len(part_s), 3))))
    assert blocks[0].time_s[0] == pytest.approx(1.0 + PERIOD_S / 2)
    assert [(gap.channel, gap.start_s, gap.end_s, gap.reason) for gap in resampler.gaps] == [
        ("rotation_rate", 0.0, 1.0, "began later than another channel"),
        ("rotation_rate", 6.0, 10.0, "ended earlier than another channel"),
    ]


@pytest.mark.parametrize("interval_s", [0.002, 0.01, 0.02, 0.04, 0.5])
def test_a_value_comes_out_within_the_latency(interval_s: float) -> None:
    resampler = Resampler((FORCE, RATE), ResampleParams())
    zero = np.zeros((1, 3))
    emitted = 0
    for now_s in interval_s * np.arange(round(3.0 / interval_s)):
        stamp = np.array([now_s])
        for block in resampler.push(SensorBlock(FORCE, stamp, zero)) + resampler.push(SensorBlock(RATE, stamp, zero)):
            assert now_s - block.time_s.min() <= resampler.latency_s + 1e-9
            emitted += len(block.time_s)
    assert emitted >= 120


@given(st.lists(st.floats(0.001, 0.8), min_size=20, max_size=120), st.integers(0, 2**32 - 1))
@settings(max_examples=60, deadline=None)
def test_segments_and_times_stay_in_order_for_any_clock(pauses_s: list[float], seed: int) -> None:
    """Whatever the clock does, times rise, segments count up, values stay within those of the samples."""
    rng = np.random.default_rng(seed)
    time_s = np.cumsum(pauses_s)
    back = rng.random(len(time_s)) < 0.05
    time_s = np.where(back, time_s - rng.uniform(0.0, 3.0, len(time_s)), time_s)
    values = rng.uniform(-1.0, 1.0, (len(time_s), 3))
    blocks, _ = resample(SensorBlock(FORCE, time_s, values), SensorBlock(RATE, time_s, values))
    for block in blocks:
        assert np.abs(block.specific_force_mps2).max() <= 1.0 + 1e-9
        np.testing.assert_array_equal(block.specific_force_mps2, block.rotation_rate_radps)
    for before, after in pairwise(blocks):
        assert after.segment >= before.segment
        assert after.first_index >= before.first_index + len(before.time_s)
        assert after.time_s[0] > before.time_s[-1]
