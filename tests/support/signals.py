"""Made-up and simulated input of the front end's stages."""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

from pdr_est.config import Config
from pdr_est.frames import STANDARD_GRAVITY_MPS2, Array
from pdr_est.pipeline.front_end_chain import levelling
from pdr_est.preprocessing.resampling import ResampleParams
from pdr_est.simulate import (
    DeviceParams,
    HeldPhone,
    PathParams,
    Pause,
    Scenario,
    SensorParams,
    SimulatedWalk,
    WalkerGaitParams,
    simulate_walk,
)
from pdr_est.types.sensors import ImuBlock, LevelBlock
from pdr_est.types.steps import CarryingMode, Step, StepEvent

RATE_HZ = 50.0
CORNER_M = ((0.0, 0.0), (15.0, 0.0), (15.0, 12.0))
PAUSE = (Pause(at_m=10.0, duration_s=4.0),)


@cache
def corner_walk(
    gait: WalkerGaitParams | None = None,
    carry: HeldPhone | None = None,
    sensors: SensorParams | None = None,
    seed: int = 0,
) -> SimulatedWalk:
    """27 m around one corner to the left, with a pause before it."""
    gait = gait or WalkerGaitParams()
    device = DeviceParams(carry=carry or HeldPhone(), sensors=sensors or SensorParams(record_attitude=True))
    return simulate_walk(
        Scenario(
            path=PathParams(vertices_m=CORNER_M),
            gait=replace(gait, pauses=gait.pauses or PAUSE),
            devices=(device,),
            seed=seed,
        )
    )


def levels_of(walk: SimulatedWalk, config: Config | None = None, rate_hz: float = RATE_HZ) -> list[LevelBlock]:
    """The level samples of a simulated walk's first device."""
    config = replace(config or Config(), resample=ResampleParams(rate_hz=rate_hz))
    device = walk.recording.devices[0]
    _, to_level = levelling(device, "simulated", config)
    return run(to_level, device.blocks())


def run(stage: Any, items: Iterable[Any]) -> list[Any]:
    """Everything that a stage emits."""
    outputs = [output for item in items for output in stage.push(item)]
    return outputs + stage.flush()


def joined(blocks: Sequence[LevelBlock], name: str) -> Array:
    return np.concatenate([getattr(block, name) for block in blocks])


def imu(
    force: Array, rate: Array | None, segment: int = 0, first_index: int = 0, attitude: Array | None = None
) -> ImuBlock:
    """Samples on the 50 Hz grid."""
    time_s = (first_index + np.arange(len(force))) / RATE_HZ
    return ImuBlock(first_index, segment, time_s, force, rate, attitude)


def level(
    vertical_mps2: Array, segment: int = 0, first_index: int = 0, rate_hz: float = RATE_HZ, yaw_rad: float = 0.0
) -> LevelBlock:
    """Samples of a phone that lies flat with its screen up."""
    count = len(vertical_mps2)
    up = np.tile([0.0, 0.0, 1.0], (count, 1))
    return LevelBlock(
        first_index=first_index,
        segment=segment,
        time_s=(first_index + np.arange(count)) / rate_hz,
        up=up,
        acceleration_mps2=up * vertical_mps2[:, None],
        vertical_mps2=vertical_mps2,
        yaw_rad=np.full(count, yaw_rad),
        rotation_rate_radps=np.zeros((count, 3)),
        turn_rate_radps=np.zeros(count),
        mode=np.full(count, CarryingMode.HOLDING, dtype=np.int8),
        mode_probability=np.ones(count),
    )


def step(
    time_s: float,
    start_s: float,
    *,
    length_m: float = 0.7,
    heading_rad: float = 0.0,
    segment: int = 0,
    frequency_hz: float = 0.0,
    vertical_mps2: Array | None = None,
    sigma_length_m: float = 0.0,
) -> Step:
    """A step with made-up samples."""
    event = StepEvent(round(time_s * RATE_HZ), time_s, segment, CarryingMode.HOLDING)
    samples = level(np.zeros(30) if vertical_mps2 is None else vertical_mps2, segment, yaw_rad=heading_rad)
    return Step(
        event,
        start_s,
        frequency_hz,
        samples,
        length_m=length_m,
        heading_rad=heading_rad,
        sigma_length_m=sigma_length_m,
    )


def still_force(up: Array, count: int) -> Array:
    """Specific force of a phone at rest whose axes see the vertical along `up` (3,)."""
    return np.tile(STANDARD_GRAVITY_MPS2 * up, (count, 1))
