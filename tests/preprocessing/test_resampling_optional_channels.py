"""An optional channel on the grid: what is there of it comes along, and nothing that it does harms the others."""

from collections.abc import Sequence

import numpy as np
import pytest

from pdr_est.frames import Array
from pdr_est.preprocessing.resampling import ResampleParams, Resampler
from pdr_est.testing import cut_block, exact_content, in_bursts, messy_device, run_stage
from pdr_est.types.recording import Signal
from pdr_est.types.sensors import Channel, ImuBlock, SensorBlock

FORCE, RATE, FIELD = Channel.SPECIFIC_FORCE, Channel.ROTATION_RATE, Channel.MAGNETIC_FIELD
TIME_S = np.arange(1001) / 100.0
NEEDED = (
    SensorBlock(FORCE, TIME_S, np.repeat(np.sin(TIME_S)[:, None], 3, axis=1)),
    SensorBlock(RATE, TIME_S, np.repeat(np.cos(TIME_S)[:, None], 3, axis=1)),
)


def resampler() -> Resampler:
    return Resampler((FORCE, RATE), ResampleParams(), optional=(FIELD,))


def field(time_s: Array) -> SensorBlock:
    """A field that is its own time, on every axis."""
    return SensorBlock(FIELD, time_s, np.repeat(time_s[:, None], 3, axis=1))


def resampled(*blocks: SensorBlock) -> tuple[list[ImuBlock], Resampler]:
    outputs, stage = run_stage(resampler(), blocks)
    return outputs, stage


def field_of(blocks: Sequence[ImuBlock]) -> Array:
    assert all(block.magnetic_field_ut is not None for block in blocks)
    return np.concatenate([block.magnetic_field_ut for block in blocks])  # type: ignore[misc]


def others(blocks: Sequence[ImuBlock]) -> list[object]:
    """All that is emitted besides the field, sample by sample, to the last bit."""
    return [
        (block.first_index + i, block.segment, block.time_s[i], tuple(force), tuple(rate))
        for block in blocks
        for i, (force, rate) in enumerate(
            zip(block.specific_force_mps2, block.rotation_rate_radps, strict=True)  # type: ignore[arg-type]
        )
    ]


def test_where_it_was_recorded_it_has_the_means_of_any_channel() -> None:
    blocks, _ = resampled(field(TIME_S), *NEEDED)
    np.testing.assert_allclose(field_of(blocks)[:, 1], np.concatenate([block.time_s for block in blocks]), atol=1e-10)


def test_gaps_and_ends_are_unknown_and_no_gaps_of_the_device() -> None:
    recorded = (TIME_S > 1.0) & ~((TIME_S > 4.0) & (TIME_S < 6.0)) & (TIME_S < 9.0)
    blocks, stage = resampled(field(TIME_S[recorded]), *NEEDED)
    assert stage.gaps == ()
    time_s, known = np.concatenate([block.time_s for block in blocks]), np.isfinite(field_of(blocks)).all(axis=1)
    inside = ((time_s > 1.03) & (time_s < 3.97)) | ((time_s > 6.02) & (time_s < 8.96))
    outside = (time_s < 1.0) | ((time_s > 4.01) & (time_s < 5.98)) | (time_s > 9.0)
    assert known[inside].all()
    assert not known[outside].any()
    np.testing.assert_allclose(field_of(blocks)[known][:, 0], time_s[known], atol=1e-10)


@pytest.mark.parametrize(
    "broken",
    [
        field(np.empty(0)),
        field(TIME_S[:1]),
        field(TIME_S[300:302]),
        field(TIME_S + 1e6),
        field(TIME_S - 1e6),
        field(np.concatenate([TIME_S[:200], [1.6e9], TIME_S[200:]])),
        field(np.concatenate([TIME_S[:500], TIME_S])),
        field(TIME_S[::-1]),
        field(np.full(50, 3.0)),
        SensorBlock(FIELD, TIME_S, np.full((len(TIME_S), 3), np.nan)),
        SensorBlock(FIELD, np.full(len(TIME_S), np.nan), np.ones((len(TIME_S), 3))),
        SensorBlock(FIELD, TIME_S, np.full((len(TIME_S), 3), 1e9)),
        field(TIME_S[(TIME_S < 2.0) | (TIME_S > 7.0)]),
    ],
    ids=lambda block: f"{len(block.time_s)} from {block.time_s[:1]}",
)
def test_a_broken_one_changes_nothing_else(broken: SensorBlock) -> None:
    alone, without = run_stage(Resampler((FORCE, RATE), ResampleParams()), NEEDED)
    blocks, stage = resampled(broken, *NEEDED)
    assert others(blocks) == others(alone)
    assert stage.gaps == without.gaps == ()
    field_of(blocks)


@pytest.mark.parametrize("rate_hz", [25.0, 50.0, 400.0])
def test_a_hard_recording_is_the_same_with_it_and_without(rate_hz: float) -> None:
    device = messy_device(rate_hz, seed=2)
    blocks, stage = resampled(*device.blocks())
    alone, without = run_stage(Resampler((FORCE, RATE), ResampleParams()), device.blocks())
    assert len({block.segment for block in blocks}) == 4
    assert others(blocks) == others(alone)
    assert stage.gaps == without.gaps
    assert np.isfinite(field_of(blocks)).mean() > 0.7


@pytest.mark.parametrize("lag_s", [0.05, 1.8])
@pytest.mark.parametrize("stops_s", [3.0, 20.0])
def test_no_cut_matters_while_it_lags_no_more_than_it_may(stops_s: float, lag_s: float) -> None:
    rng = np.random.default_rng(4)
    time_s = TIME_S[(stops_s > TIME_S) & ~((TIME_S > 1.0) & (TIME_S < 1.6))]
    items = [field(time_s), *NEEDED]
    expected = exact_content(resampled(*items)[0])
    for _ in range(2):  # in short pieces, for what comes with its last sample was late with its first
        mixed = in_bursts([cut_block(item, rng, len(TIME_S)) for item in items], lag_s, rng)
        outputs, _ = run_stage(resampler(), mixed, restore_at=[5, 100])
        assert exact_content(outputs) == expected


@pytest.mark.parametrize("chunk", [1, 7, 100])
def test_one_that_stopped_is_waited_for_a_while_and_not_in_pushes(chunk: int) -> None:
    stage = resampler()
    stage.push(field(TIME_S[TIME_S < 1.0]))
    for start in range(0, len(TIME_S), chunk):
        emitted_s = 0.0
        now = slice(start, start + chunk)
        for block in NEEDED:
            for output in stage.push(SensorBlock(block.channel, block.time_s[now], block.values[now])):
                emitted_s = max(emitted_s, float(output.time_s[-1]))
        if emitted_s:
            assert TIME_S[now][-1] - emitted_s <= stage.latency_s + 1e-9
    assert emitted_s > 10.0 - 2.7


def test_what_comes_too_late_stays_unknown() -> None:
    blocks, _ = resampled(*NEEDED, field(TIME_S))
    time_s, known = np.concatenate([block.time_s for block in blocks]), np.isfinite(field_of(blocks)).all(axis=1)
    assert not known[time_s < 7.0].any()
    assert known[time_s > 7.6].any()


def test_signals_of_a_device_come_with_the_optional_one_first() -> None:
    device = messy_device(50.0, seed=1)
    assert isinstance(device.magnetic_field, Signal)
    assert next(device.blocks()).channel is FIELD


def test_the_air_pressure_is_one_column_and_changes_nothing_else() -> None:
    """A barometer that gives a value each second, as many phones do, is interpolated."""
    second_s = np.arange(11.0)
    pressure = SensorBlock(Channel.PRESSURE, second_s, (100_000.0 + second_s)[:, None])
    with_it = Resampler((FORCE, RATE), ResampleParams(), optional=(Channel.PRESSURE,))
    blocks, stage = run_stage(with_it, (pressure, *NEEDED))
    pressure_pa = np.concatenate([block.pressure_pa for block in blocks])
    time_s = np.concatenate([block.time_s for block in blocks])
    np.testing.assert_allclose(pressure_pa[:-2], 100_000.0 + time_s[:-2], atol=1e-6)
    alone, _ = run_stage(Resampler((FORCE, RATE), ResampleParams()), NEEDED)
    assert others(blocks) == others(alone)
    assert all(block.pressure_pa is None for block in alone)
    assert stage.gaps == ()


def test_a_long_pause_of_the_barometer_stays_unknown() -> None:
    recorded_s = np.array([0.0, 1.0, 2.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0])
    pressure = SensorBlock(Channel.PRESSURE, recorded_s, np.full((len(recorded_s), 1), 1e5))
    with_it = Resampler((FORCE, RATE), ResampleParams(), optional=(Channel.PRESSURE,))
    blocks, _ = run_stage(with_it, (pressure, *NEEDED))
    time_s = np.concatenate([block.time_s for block in blocks])
    known = np.isfinite(np.concatenate([block.pressure_pa for block in blocks]))
    assert not known[(time_s > 2.02) & (time_s < 4.98)].any()
    assert known[(time_s < 1.98) | ((time_s > 5.02) & (time_s < 9.9))].all()
