"""The window of a step detector keeps every sample's mode and its probability together, wherever it is cut."""

from dataclasses import replace

import numpy as np
import pytest
from signals import RATE_HZ, level

from pdr_est.front_end.signal.blocks import part
from pdr_est.front_end.steps.sample_buffer import SampleBuffer
from pdr_est.types.sensors import LevelBlock
from pdr_est.types.steps import CarryingMode

COUNT = 60


def changing(segment: int = 0) -> LevelBlock:
    """Samples whose mode changes in the middle and whose probability tells which sample it is."""
    mode = np.where(np.arange(COUNT) < COUNT // 2, CarryingMode.SWING, CarryingMode.POCKET).astype(np.int8)
    return replace(level(np.zeros(COUNT), segment), mode=mode, mode_probability=np.arange(COUNT) / COUNT)


@pytest.mark.parametrize("cut_at", [0, 7, 40, COUNT])
def test_a_step_has_the_mode_and_the_probability_of_its_own_sample(cut_at: int) -> None:
    samples, block = SampleBuffer(RATE_HZ, delay_s=0.0), changing()
    samples.begin(block)
    for piece in (part(block, 0, cut_at), part(block, cut_at, COUNT)):
        samples.append(piece, piece.vertical_mps2)
    samples.drop(5)
    for place in (0, 20, 30, COUNT - 6):
        event = samples.event(place)
        assert event.index == place + 5
        assert event.mode_probability == (place + 5) / COUNT
        assert event.mode is (CarryingMode.SWING if place + 5 < COUNT // 2 else CarryingMode.POCKET)


def test_a_new_segment_begins_without_the_old_probabilities() -> None:
    samples, block = SampleBuffer(RATE_HZ, delay_s=0.0), changing()
    samples.begin(block)
    samples.append(block, block.vertical_mps2)
    fresh = replace(changing(segment=1), mode_probability=np.full(COUNT, 0.25))
    samples.begin(fresh)
    samples.append(fresh, fresh.vertical_mps2)
    assert samples.event(0).mode_probability == 0.25


def test_the_delay_of_the_signal_is_taken_off_time_and_index() -> None:
    """A tenth of a second is five samples."""
    samples, block = SampleBuffer(RATE_HZ, delay_s=0.1), level(np.zeros(COUNT), first_index=100)
    samples.begin(block)
    samples.append(block, block.vertical_mps2)
    samples.drop(10)
    event = samples.event(20)
    assert event.index == 100 + 10 + 20 - 5
    assert event.time_s == samples.time_s(20) == pytest.approx(125 / RATE_HZ)
