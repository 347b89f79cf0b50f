"""Simulated recordings with the faults that recorders have, as inputs of stages."""

from dataclasses import replace
from functools import cache
from typing import Any, Literal

import numpy as np

from pdr_est.config import Config
from pdr_est.pipeline.front_end_chain import levelling, stepping
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
from pdr_est.stage import Chain
from pdr_est.testing.partitions import run_stage
from pdr_est.types.recording import DeviceRecording, Signal

_RESET_AT_S, _RESET_BY_S = 9.0, 8.5

Consumed = Literal["raw", "imu", "level", "steps"]


def messy_device(rate_hz: float, seed: int) -> DeviceRecording:
    """Simulate a short walk with a pause, recorded with every fault of recorders.

    The faults are jitter, lost samples, two gaps, duplicate time stamps, time stamps that step back, a restarted
    clock, NaN, and quaternions of either sign.
    """
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
    spoiled: dict[str, Any] = {name: _spoil(getattr(device, name), rng) for name in channels}
    return replace(device, **spoiled)


@cache
def stage_inputs(consumed: Consumed, rate_hz: float = 100.0, seed: int = 1) -> tuple[Any, ...]:
    """Make inputs of a stage from a messy recording.

    Parameters
    ----------
    consumed
        Kind of the inputs: "raw" `SensorBlock`, "imu" `ImuBlock` on the uniform grid, "level" `LevelBlock` with
        carrying modes, or "steps" `Step` with gait, length and heading, all by the default stages.
    rate_hz
        Sampling rate of the recording, Hz.
    seed
        Seed of the simulation.
    """
    device, config = messy_device(rate_hz, seed), Config()
    resampler, to_level = levelling(device, "messy recording", config)
    chains = {
        "raw": Chain([]),
        "imu": Chain([resampler]),
        "level": to_level,
        "steps": Chain([*to_level.stages, *stepping(config).stages]),
    }
    return tuple(run_stage(chains[consumed], device.blocks())[0])


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
