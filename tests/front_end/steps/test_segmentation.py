"""From events to steps: frequency, beginning, and which samples belong to a step."""

import pickle
from dataclasses import dataclass, replace

import numpy as np
import pytest
from signals import RATE_HZ, corner_walk, joined, level, levels_of, run

from pdr_est.front_end.signal.blocks import part
from pdr_est.front_end.steps.bandpass_peaks import AutoStepParams, BandpassPeakDetector
from pdr_est.front_end.steps.mmpdr_peaks import MmpdrStepParams, MmpdrSteps
from pdr_est.front_end.steps.segmentation import SegmentationParams, StepSegmentation
from pdr_est.types.sensors import Hole, LevelBlock
from pdr_est.types.steps import CarryingMode, Step, StepEvent

DELAY_S = 0.1
MOST_BYTES = 100_000  # of the saved state, which holds less than 500 samples; ten times as many are pushed


@dataclass
class Script:
    """A detector that announces given times, `DELAY_S` after they were; (time, segment)."""

    plan: list[tuple[float, int]]
    latency_s: float = DELAY_S
    transitions_s: tuple[float, ...] = ()  # the times at which the mode is TRANS
    compensates: bool = True  # whether steps in TRANS are made up

    def push(self, item: LevelBlock, /) -> list[StepEvent]:
        due = [entry for entry in self.plan if item.time_s[-1] >= entry[0] + DELAY_S]
        self.plan = self.plan[len(due) :]
        return [self._event(time_s, segment) for time_s, segment in due]

    def _event(self, time_s: float, segment: int) -> StepEvent:
        moving = time_s in self.transitions_s
        mode = CarryingMode.TRANS if moving else CarryingMode.HOLDING
        return StepEvent(round(time_s * RATE_HZ), time_s, segment, mode, compensated=moving and self.compensates)

    def flush(self) -> list[StepEvent]:
        return []


def steps_at(*times_s: float, duration_s: float = 12.0) -> list[Step]:
    count = round(duration_s * RATE_HZ)
    stage = StepSegmentation(Script([(time_s, 0) for time_s in times_s]), SegmentationParams())
    return run(stage, [level(np.arange(count, dtype=np.float64))])


def test_the_frequency_is_the_reciprocal_of_the_interval() -> None:
    steps = steps_at(1.0, 1.5, 2.0, 4.0, 6.0625)
    assert [step.frequency_hz for step in steps] == [0.0, 2.0, 2.0, 0.5, 0.0]  # at most two seconds


def test_a_step_begins_where_the_one_before_ended() -> None:
    steps = steps_at(1.0, 1.5, 2.1)
    assert [step.start_s for step in steps] == pytest.approx([0.4, 1.0, 1.5])
    assert [step.event.time_s for step in steps] == [1.0, 1.5, 2.1]


def test_the_first_step_after_a_standstill_has_no_frequency_and_its_own_duration() -> None:
    steps = steps_at(1.0, 1.5, 3.6, 9.0, 9.5)
    assert [step.frequency_hz for step in steps] == pytest.approx([0.0, 2.0, 0.0, 0.0, 2.0])
    assert [step.start_s for step in steps] == pytest.approx([0.4, 1.0, 3.0, 8.4, 9.0])


def test_exactly_the_standstill_later_a_step_still_follows_the_one_before() -> None:
    assert [step.start_s for step in steps_at(1.0, 3.0)] == pytest.approx([0.4, 1.0])
    assert [step.start_s for step in steps_at(1.0, 3.0625)] == pytest.approx([0.4, 2.4625])


def test_a_first_step_begins_no_earlier_than_the_last_one_ended() -> None:
    stage = StepSegmentation(Script([(1.0, 0), (1.5, 0)]), SegmentationParams(standstill_s=0.4, initial_step_s=0.6))
    steps = run(stage, [level(np.zeros(200))])
    assert [step.frequency_hz for step in steps] == [0.0, 0.0]
    assert [step.start_s for step in steps] == pytest.approx([0.4, 1.0])


def test_the_steps_of_a_transition_keep_the_frequency_before_it() -> None:
    """So does the first step after it, whose distance from them says nothing."""
    times_s = (1.0, 1.5, 1.8, 2.4, 2.5, 3.0, 3.625)
    detector = Script([(time_s, 0) for time_s in times_s], transitions_s=(1.8, 2.4))
    steps = run(StepSegmentation(detector, SegmentationParams()), [level(np.zeros(300))])
    assert [step.frequency_hz for step in steps] == pytest.approx([0.0, 2.0, 2.0, 2.0, 2.0, 2.0, 1.6])
    assert [step.start_s for step in steps][2:5] == pytest.approx([1.5, 1.8, 2.4])


def test_steps_that_were_seen_in_a_transition_have_their_own_frequency() -> None:
    detector = Script([(1.0, 0), (1.5, 0), (1.75, 0), (2.15, 0)], transitions_s=(1.75, 2.15), compensates=False)
    steps = run(StepSegmentation(detector, SegmentationParams()), [level(np.zeros(200))])
    assert [step.frequency_hz for step in steps] == pytest.approx([0.0, 2.0, 4.0, 2.5])


def test_without_a_frequency_before_it_a_transition_has_its_own() -> None:
    detector = Script([(1.0, 0), (1.5, 0), (2.0, 0)], transitions_s=(1.5, 2.0))
    steps = run(StepSegmentation(detector, SegmentationParams()), [level(np.zeros(200))])
    assert [step.frequency_hz for step in steps] == pytest.approx([0.0, 2.0, 2.0])


def test_the_first_step_begins_no_earlier_than_the_recording() -> None:
    (step,) = steps_at(0.25)
    assert step.start_s == 0.0
    assert step.samples.time_s[0] == 0.0
    assert step.recorded_share == pytest.approx(0.25 / 0.6)


def test_only_a_step_that_had_begun_before_its_segment_is_a_part() -> None:
    assert [step.recorded_share for step in steps_at(1.0, 1.5, 9.0)] == [1.0, 1.0, 1.0]
    stage = StepSegmentation(Script([(1.0, 0), (1.95, 0), (2.8, 1), (3.1, 1)]), SegmentationParams())
    old, new = level(np.zeros(100)), level(np.ones(100), segment=1, first_index=125)
    steps = [step for block in (old, new) for step in stage.push(block)]
    assert [step.recorded_share for step in steps] == pytest.approx([1.0, 1.0, 0.5, 1.0])


@pytest.mark.parametrize("times_s", [(1.0, 1.5, 2.1, 7.0), (1.003, 1.517, 2.111, 7.008), (0.997, 1.485, 2.095, 6.99)])
def test_the_samples_are_those_after_the_start_up_to_the_event(times_s: tuple[float, ...]) -> None:
    for step in steps_at(*times_s):
        every = np.arange(600) / RATE_HZ
        expected = every[(every > step.start_s) & (every <= step.event.time_s)]
        np.testing.assert_array_equal(step.samples.time_s, expected)
        assert step.samples.first_index == round(expected[0] * RATE_HZ)
        np.testing.assert_array_equal(step.samples.vertical_mps2, np.round(expected * RATE_HZ))


@pytest.mark.parametrize("first_s", [0.98, 1.0])
def test_a_step_that_ended_before_the_first_sample_is_none_of_the_recording(first_s: float) -> None:
    stage = StepSegmentation(Script([(first_s, 0), (1.5, 0), (2.0, 0)]), SegmentationParams())
    steps = run(stage, [level(np.zeros(100), first_index=round(RATE_HZ))])
    assert [step.time_s for step in steps] == [1.5, 2.0]
    assert [step.start_s for step in steps] == [1.0, 1.5]
    assert steps[0].frequency_hz == pytest.approx(1.0 / (1.5 - first_s))
    assert steps[0].recorded_share == pytest.approx(0.5 / (1.5 - first_s))


def test_a_step_that_ended_in_the_gap_before_its_segment_is_none() -> None:
    stage = StepSegmentation(Script([(1.0, 0), (2.4, 1), (3.0, 1)]), SegmentationParams())
    old, new = level(np.zeros(100)), level(np.ones(100), segment=1, first_index=125)
    assert [step.time_s for block in (old, new) for step in stage.push(block)] == [1.0, 3.0]


def test_a_new_segment_begins_from_nothing() -> None:
    """The old segment's last step comes out when the new one has begun, and takes its own samples."""
    stage = StepSegmentation(Script([(1.0, 0), (1.5, 0), (1.95, 0), (2.6, 1), (3.1, 1)]), SegmentationParams())
    old, new = level(np.zeros(100)), level(np.ones(100), segment=1, first_index=125)
    steps = [step for block in (old, new) for step in stage.push(block)]
    assert [step.event.segment for step in steps] == [0, 0, 0, 1, 1]
    assert [step.frequency_hz for step in steps] == pytest.approx([0.0, 2.0, 1.0 / 0.45, 0.0, 2.0])
    assert [step.start_s for step in steps] == pytest.approx([0.4, 1.0, 1.5, 2.5, 2.6])
    assert [set(step.samples.vertical_mps2) for step in steps] == [{0.0}, {0.0}, {0.0}, {1.0}, {1.0}]


def test_empty_blocks_are_harmless() -> None:
    stage = StepSegmentation(BandpassPeakDetector(RATE_HZ, AutoStepParams()), SegmentationParams())
    assert stage.push(level(np.zeros(0))) == []
    assert stage.push(level(np.zeros(10))) == []
    assert stage.push(level(np.zeros(0), segment=1, first_index=90)) == []
    assert stage.push(level(np.zeros(10), first_index=10)) == []


@pytest.mark.parametrize("name", ["auto", "mmpdr"])
def test_steps_of_a_walk_share_no_sample_and_leave_none_out(name: str) -> None:
    detector = (
        BandpassPeakDetector(RATE_HZ, AutoStepParams()) if name == "auto" else MmpdrSteps(RATE_HZ, MmpdrStepParams())
    )
    levels = levels_of(corner_walk())
    steps = run(StepSegmentation(detector, SegmentationParams()), levels)
    indices = np.concatenate([step.samples.first_index + np.arange(len(step.samples)) for step in steps])
    breaks = np.diff(indices)
    assert (breaks >= 1).all()
    assert np.count_nonzero(breaks > 1) == 1  # the pause
    vertical, first = joined(levels, "vertical_mps2"), levels[0].first_index
    np.testing.assert_array_equal(
        joined([step.samples for step in steps], "vertical_mps2"), vertical[indices - first]
    )


def test_memory_stays_bounded_while_the_walker_stands() -> None:
    stage = StepSegmentation(Script([]), SegmentationParams())
    for i in range(200):
        stage.push(level(np.zeros(50), first_index=50 * i))
    assert len(pickle.dumps(stage)) < MOST_BYTES


def test_memory_stays_bounded_while_the_walker_walks_on() -> None:
    stage = StepSegmentation(Script([(0.5 + 0.5 * k, 0) for k in range(400)]), SegmentationParams())
    for i in range(200):
        stage.push(level(np.zeros(50), first_index=50 * i))
    assert len(pickle.dumps(stage)) < MOST_BYTES


def test_a_crest_held_back_at_a_gap_does_not_reach_the_next_segment() -> None:
    """One crest, a gap of 0.6 s, then a walk: the first step of the second segment has only its samples."""
    wave = np.maximum(2.0 * np.sin(2.0 * np.pi * 1.8 * np.arange(400) / RATE_HZ), -1.0)
    lonely = np.concatenate([np.zeros(100), wave[:28], np.zeros(20)])
    blocks = [level(lonely), level(wave, segment=1, first_index=len(lonely) + 30)]
    whole = run(StepSegmentation(BandpassPeakDetector(RATE_HZ, AutoStepParams()), SegmentationParams()), blocks)
    assert whole
    for step_found in whole:
        assert step_found.event.segment == step_found.samples.segment
    pieces = [part(block, i, i + 1) for block in blocks for i in range(len(block))]
    singly = run(StepSegmentation(BandpassPeakDetector(RATE_HZ, AutoStepParams()), SegmentationParams()), pieces)
    assert [found.event for found in singly] == [found.event for found in whole]
    assert [found.frequency_hz for found in singly] == [found.frequency_hz for found in whole]


def over_a_gap(hole: Hole, *events: tuple[float, int]) -> list[Step]:
    """Steps of events (time, segment) around a gap."""
    first = level(np.zeros(round(hole.start_s * RATE_HZ)))
    second = replace(level(np.zeros(300)), segment=1, time_s=hole.end_s + np.arange(300) / RATE_HZ, hole=hole)
    return run(StepSegmentation(Script(list(events)), SegmentationParams()), [first, second])


@pytest.mark.parametrize(
    ("hole", "sigma_rad"),
    [
        (Hole(4.0, 5.0), 0.36),
        (Hole(8.0, 9.0), 0.1),
        (Hole(8.0, 8.7), 0.07),
        (Hole(8.0, 108.0), np.pi / np.sqrt(3.0)),
        (Hole(8.0, 9.0, duration_known=False), np.pi / np.sqrt(3.0)),
    ],
    ids=["walking", "standing", "short", "long", "unknown"],
)
def test_the_first_step_after_a_gap_knows_it_and_its_doubt(hole: Hole, sigma_rad: float) -> None:
    """The walker makes the last step before it at 3.5 s."""
    after_s = 0.5 if hole.start_s == 4.0 else 3.0
    events = [(3.0, 0), (3.5, 0), (hole.end_s + after_s, 1), (hole.end_s + after_s + 0.5, 1)]
    steps = over_a_gap(hole, *events)
    assert [step.holes for step in steps] == [(), (), (hole,), ()]
    assert [step.sigma_turn_rad for step in steps] == pytest.approx([0.0, 0.0, sigma_rad, 0.0])
