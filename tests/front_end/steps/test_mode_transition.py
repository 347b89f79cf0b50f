"""Compensation of the steps of a transition (MMPDR eq. 8) on a made-up gait whose steps can be counted by hand."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from signals import level, run

from pdr_est.front_end.signal.blocks import part
from pdr_est.front_end.steps.mmpdr_peaks import MmpdrStepParams, MmpdrSteps
from pdr_est.front_end.steps.mode_transition import StepFrequency
from pdr_est.testing import one_by_one
from pdr_est.types.sensors import LevelBlock
from pdr_est.types.steps import CarryingMode, StepEvent

RATE_HZ = 200.0
GAIT_HZ = 1.6
SHARP = {"cutoff_hz": 95.0, "holding_threshold_mps2": 1.0, "peak_sign": 1}  # a low-pass that leaves the gait alone
HOLDING, POCKET, TRANS = CarryingMode.HOLDING, CarryingMode.POCKET, CarryingMode.TRANS


def gait(duration_s: float, *labels: tuple[float, CarryingMode], until_s: float = 99.0) -> LevelBlock:
    """A held phone with a crest every 0.625 s until the walker stands. labels: from when which mode."""
    time_s = np.arange(round(duration_s * RATE_HZ)) / RATE_HZ
    wave = np.where(time_s < until_s, 3.0 * np.maximum(-np.cos(2.0 * np.pi * GAIT_HZ * time_s), -0.2), -0.6)
    block = level(wave, rate_hz=RATE_HZ)
    mode = block.mode.copy()
    for start_s, label in labels:
        mode[round(start_s * RATE_HZ) :] = label
    return replace(block, mode=mode)


def walked(*blocks: LevelBlock, **changes: float) -> list[StepEvent]:
    return run(MmpdrSteps(RATE_HZ, MmpdrStepParams(**{**SHARP, **changes})), blocks)  # type: ignore[arg-type]


def compensated(events: list[StepEvent]) -> list[float]:
    return [event.time_s for event in events if event.mode is TRANS]


@pytest.mark.parametrize(
    ("lasts_s", "middles"), [(2.0, 3), (1.5, 2), (0.94, 2), (0.93, 1), (0.32, 1), (0.31, 0)]
)  # 3.2, 2.4, 1.504, 1.488, 0.512, 0.496
def test_the_steps_of_a_transition_are_its_duration_times_the_frequency_rounded(lasts_s: float, middles: int) -> None:
    events = walked(gait(10.0, (4.0, TRANS), (4.0 + lasts_s, HOLDING)))
    share_s = lasts_s / max(middles, 1)
    expected = 4.0 + share_s * (np.arange(middles) + 0.5)
    np.testing.assert_allclose(compensated(events), expected, atol=0.01)
    assert all(before.time_s < after.time_s for before, after in pairwise(events))
    assert [event.index for event in events] == [round(event.time_s * RATE_HZ) for event in events]


def test_nothing_is_detected_in_a_transition() -> None:
    """A crest in it is none, and a walker who stood before it has made no step in it."""
    assert walked(gait(10.0, (0.0, HOLDING), (2.9, TRANS), (4.9, HOLDING)), holding_threshold_mps2=9.0) == []
    standing = gait(9.0, (6.0, TRANS), (8.0, POCKET), until_s=3.0)
    assert len(walked(standing)) == 5
    assert max(event.time_s for event in walked(standing)) < 3.0


def test_a_walker_stands_after_two_seconds() -> None:
    """The last crest is at 2.8125 s."""
    for start_s, count in ((4.8, 3), (4.83, 0)):
        assert len(compensated(walked(gait(9.0, (start_s, TRANS), (start_s + 2.0, HOLDING), until_s=3.0)))) == count


def test_one_step_alone_has_no_frequency() -> None:
    assert compensated(walked(gait(6.0, (0.6, TRANS), (2.6, HOLDING)))) == []


def test_a_transition_at_the_start_has_no_step() -> None:
    events = walked(gait(6.0, (0.0, TRANS), (2.0, HOLDING)))
    assert compensated(events) == []
    assert events[0].time_s == pytest.approx(2.1875, abs=0.006)


def test_a_transition_that_the_recording_or_a_gap_cuts_off_is_compensated_up_to_there() -> None:
    cut_off = gait(5.0, (4.0, TRANS))
    after = replace(gait(3.0), segment=1, first_index=4000)
    expected = [4.25, 4.75]  # 1.6 steps
    assert compensated(walked(cut_off)) == pytest.approx(expected, abs=0.006)
    events = walked(cut_off, after)
    assert compensated(events) == pytest.approx(expected, abs=0.006)
    assert [event for event in events if event.segment == 1] == walked(after)


def test_a_second_transition_soon_after_the_first_keeps_its_rhythm() -> None:
    """Between them lies no step that could tell another one."""
    events = walked(gait(12.0, (4.0, TRANS), (6.0, HOLDING), (6.1, TRANS), (8.1, HOLDING)))
    assert len(compensated(events)) == 6
    late = walked(gait(12.0, (4.0, TRANS), (6.0, HOLDING), (6.7, TRANS), (8.7, HOLDING)))
    assert len(compensated(late)) == 6  # one step between them, too near to the compensated one for a frequency


def test_two_steps_after_a_transition_tell_a_new_frequency() -> None:
    slow = gait(8.0, (4.0, TRANS), (6.0, HOLDING))
    wave = slow.vertical_mps2.copy()
    hurried_s = np.arange(round(2.0 * RATE_HZ)) / RATE_HZ  # a crest every 0.4 s from 6.2 s on
    wave[round(6.0 * RATE_HZ) :] = -3.0 * np.cos(2.0 * np.pi * 2.5 * hurried_s)
    hurried = replace(slow, acceleration_mps2=slow.up * wave[:, None], vertical_mps2=wave)
    mode = hurried.mode.copy()
    mode[round(7.2 * RATE_HZ) :] = TRANS
    events = walked(replace(hurried, mode=mode))
    assert len([time_s for time_s in compensated(events) if time_s > 7.0]) == 2  # 0.8 s at 2.5 Hz


def test_a_long_transition_is_compensated_in_parts() -> None:
    block = gait(13.0, (4.0, TRANS), (9.0, HOLDING))
    assert len(compensated(walked(block))) == 3 + 3 + 2  # 3.2, 3.2, 1.6
    assert len(compensated(walked(block, transition_s=10.0))) == 8
    detector = MmpdrSteps(RATE_HZ, MmpdrStepParams(**SHARP))  # type: ignore[arg-type]
    early = [event for piece in one_by_one([part(block, 0, round(8.2 * RATE_HZ))]) for event in detector.push(piece)]
    assert len(compensated(early)) == 6


def test_the_latency_is_that_of_a_transition() -> None:
    detector = MmpdrSteps(RATE_HZ, MmpdrStepParams(**SHARP, transition_s=3.0))  # type: ignore[arg-type]
    block = gait(10.0, (4.0, TRANS), (7.0, HOLDING))
    late_s = [piece.time_s[-1] - event.time_s for piece in one_by_one([block]) for event in detector.push(piece)]
    assert detector.latency_s - 0.5 / GAIT_HZ - 0.03 < max(late_s) <= detector.latency_s


# --- the step frequency by itself


def test_the_frequency_lasts_exactly_two_seconds() -> None:
    frequency = StepFrequency(standstill_s=2.0)
    frequency.step(1.0)
    assert frequency.at(1.0) == 0.0
    frequency.step(1.5)
    assert [frequency.at(time_s) for time_s in (1.5, 3.5, 3.5625)] == [2.0, 2.0, 0.0]
    frequency.step(3.5)
    assert frequency.at(3.5) == 0.5


def test_a_step_after_a_compensated_one_keeps_the_frequency_but_not_over_a_standstill() -> None:
    soon, late = StepFrequency(standstill_s=2.0), StepFrequency(standstill_s=2.0)
    for frequency in (soon, late):
        frequency.step(0.0)
        frequency.step(0.5)
        frequency.bridge(1.0)
    soon.step(1.25)
    assert soon.at(1.25) == 2.0
    late.step(4.0)
    assert late.at(4.0) == 0.0
