"""Ways of cutting a recording, and the exact content of what stages emit, for the partition test."""

import pickle
from collections.abc import Iterable, Sequence
from dataclasses import fields, is_dataclass, replace
from typing import Any

import numpy as np

from pdr_est.simulate import (
    PHONE_MAGNETOMETER,
    DeviceParams,
    PathParams,
    Pause,
    Scenario,
    SensorParams,
    WalkerGaitParams,
    simulate_walk,
)
from pdr_est.types.recording import DeviceRecording, Signal
from pdr_est.types.sensors import ImuBlock, LevelBlock, SensorBlock

Block = SensorBlock | ImuBlock | LevelBlock
_RESET_AT_S, _RESET_BY_S = 9.0, 8.5


def messy_device(rate_hz: float, seed: int) -> DeviceRecording:
    """A short walk with a pause and all that recorders do to one: jitter, lost samples, two gaps, duplicates,
    stamps that step back, a restarted clock, NaN, and quaternions of either sign."""
    sensors = SensorParams(
        rate_hz=rate_hz,
        time_jitter_s=0.1 / rate_hz,
        lost_fraction=0.02,
        gaps_s=((3.2, 4.1), (6.5, 7.2)),
        record_attitude=True,
        magnetometer=PHONE_MAGNETOMETER,
    )
    scenario = Scenario(
        path=PathParams(vertices_m=((0.0, 0.0), (5.0, 0.0), (5.0, 4.0))),
        gait=WalkerGaitParams(lead_in_s=1.0, lead_out_s=1.0, pauses=(Pause(at_m=5.5, duration_s=2.3),)),
        devices=(DeviceParams(sensors=sensors),),
        seed=seed,
    )
    rng = np.random.default_rng(seed)
    device = simulate_walk(scenario).recording.devices[0]
    channels = ("specific_force", "rotation_rate", "attitude", "magnetic_field")
    return replace(device, **{name: _spoil(getattr(device, name), rng) for name in channels})


def _spoil(signal: Signal, rng: np.random.Generator) -> Signal:
    count = len(signal)
    order = np.sort(np.concatenate([np.arange(count), rng.choice(count, count // 100 + 1)]))
    time, values = signal.time_s[order], signal.values[order]
    time = np.where(time > _RESET_AT_S, time - _RESET_BY_S, time)
    back = rng.choice(np.arange(1, len(time)), count // 100 + 1)
    time[back] -= 0.03
    values[rng.choice(len(time), count // 100 + 1), 1] = np.nan
    if values.shape[1] == 4:
        values *= rng.choice([-1.0, 1.0], len(time))[:, None]
    return Signal(time, values)


def part(block: Block, start: int, stop: int) -> Block:
    """Samples start to stop of a block, possibly none."""
    own = {
        field.name: getattr(block, field.name)[start:stop].copy()
        for field in fields(block)
        if isinstance(getattr(block, field.name), np.ndarray)
    }
    if isinstance(block, SensorBlock):
        return replace(block, **own)
    return replace(block, first_index=block.first_index + start, **own)


def cut(block: Block, rng: np.random.Generator, pieces: int) -> list[Block]:
    """A block in pieces, some of them empty."""
    borders = np.sort(rng.integers(0, len(block.time_s) + 1, pieces - 1))
    return [part(block, int(a), int(b)) for a, b in zip([0, *borders], [*borders, len(block.time_s)], strict=True)]


def one_by_one(blocks: Iterable[Block]) -> list[Block]:
    """Blocks of one sample each."""
    return [part(block, i, i + 1) for block in blocks for i in range(len(block.time_s))]


def interleave(streams: Sequence[Sequence[Any]], rng: np.random.Generator) -> list[Any]:
    """The items of several streams in a random order that keeps the order within each stream."""
    turns = rng.permutation(np.repeat(np.arange(len(streams)), [len(stream) for stream in streams]))
    iterators = [iter(stream) for stream in streams]
    return [next(iterators[turn]) for turn in turns]


def in_bursts(streams: Sequence[Sequence[SensorBlock]], lag_s: float, rng: np.random.Generator) -> list[SensorBlock]:
    """The blocks of several streams as a recorder sends them: the first stream every lag_s, the others ten times as
    often. Clocks must not run back."""
    arrivals = []
    for number, stream in enumerate(streams):
        every_s, known_s = lag_s / (10.0 if number else 1.0), -np.inf
        begin_s = rng.uniform(0.0, every_s)
        for block in stream:
            if len(block.time_s):
                known_s = begin_s + every_s * np.ceil((float(block.time_s[-1]) - begin_s) / every_s)
            arrivals.append((known_s, number, block))
    return [block for _, _, block in sorted(arrivals, key=lambda arrival: arrival[:2])]


def in_time_order(blocks: Sequence[SensorBlock]) -> list[Block]:
    """One sample at a time, the channels in step with each other as a live recorder delivers them."""
    counts = [len(block.time_s) for block in blocks]
    order = sorted((i / count, n, i) for n, count in enumerate(counts) for i in range(count))
    return [part(blocks[n], i, i + 1) for _, n, i in order]


def run(stage: Any, items: Iterable[Any], restore_at: Sequence[int] = ()) -> tuple[list[Any], Any]:
    """Outputs of a stage and the stage at the end; it is pickled and restored before the items of these numbers."""
    outputs: list[Any] = []
    for number, item in enumerate(items):
        if number in restore_at:
            stage = pickle.loads(pickle.dumps(stage))
        outputs += stage.push(item)
    return outputs + stage.flush(), stage


def content(outputs: Sequence[Any]) -> list[Any]:
    """What stages emitted, to the last bit and however the blocks were cut: blocks sample by sample."""
    exact: list[Any] = []
    for output in outputs:
        if isinstance(output, ImuBlock | LevelBlock):
            exact += [_exact(part(output, i, i + 1)) for i in range(len(output.time_s))]
        else:
            exact.append(_exact(output))
    return exact


def _exact(value: Any) -> Any:
    if is_dataclass(value):
        return (type(value).__name__, *(_exact(getattr(value, field.name)) for field in fields(value)))
    if isinstance(value, np.ndarray):
        return (value.dtype.str, value.shape, value.tobytes())
    if isinstance(value, float):
        return float(value).hex()
    if type(value) is tuple:  # a NaN inside is not itself any more when it comes back from a pickle
        return tuple(_exact(item) for item in value)
    return value
