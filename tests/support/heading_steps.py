"""Made-up steps one after the other, for the stages that find headings."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from signals import RATE_HZ, level

from pdr_est.frames import Array, wrap_angle
from pdr_est.types.sensors import LevelBlock
from pdr_est.types.steps import CarryingMode, Step, StepEvent

SAMPLES = 25  # of a step, which takes half a second


def walked(samples: Sequence[LevelBlock], mode: CarryingMode = CarryingMode.HOLDING) -> list[Step]:
    """Steps with these samples, all in one mode."""
    return [step_of(block, mode) for block in samples]


def step_of(samples: LevelBlock, mode: CarryingMode, compensated: bool = False, begins: bool = False) -> Step:
    """A step that ends at its last sample. begins: the first after a standstill."""
    index = samples.first_index + len(samples) - 1
    event = StepEvent(index, float(samples.time_s[-1]), samples.segment, mode, compensated=compensated)
    start_s = (samples.first_index - 1) / RATE_HZ
    return Step(event, start_s, 0.0 if begins else RATE_HZ / len(samples), samples)


def block(number: int, yaw_rad: float | Array = 0.0, segment: int = 0) -> LevelBlock:
    """Samples of step `number` of a phone that lies flat. yaw_rad: of all, or (25,) of each sample."""
    plain = level(np.zeros(SAMPLES), segment, number * SAMPLES)
    return replace(plain, yaw_rad=wrap_angle(np.zeros(SAMPLES) + yaw_rad))


def turning_block(number: int, turn_rad: float, up: tuple[float, float, float] = (0.0, 1.0, 0.0)) -> LevelBlock:
    """Samples of step `number` over which the gyroscope's y axis turns by so much."""
    rate = np.zeros((SAMPLES, 3))
    rate[:, 1] = turn_rad * RATE_HZ / SAMPLES
    return replace(block(number), rotation_rate_radps=rate, up=np.tile(up, (SAMPLES, 1)))
