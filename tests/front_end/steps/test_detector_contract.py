"""What every step detector promises, whatever its method: one test for all of them."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from signals import RATE_HZ, corner_walk, joined, levels_of, run

from pdr_est.config import Config
from pdr_est.front_end.signal.blocks import join
from pdr_est.front_end.steps.bandpass_peaks import AutoStepParams, BandpassPeakDetector
from pdr_est.front_end.steps.local_variance import LocalVariance, LocalVarianceParams
from pdr_est.front_end.steps.magnitude_peaks import MagnitudePeaks, MagnitudePeaksParams
from pdr_est.front_end.steps.mmpdr_peaks import MmpdrStepParams, MmpdrSteps
from pdr_est.front_end.steps.relative_threshold import RelativeThreshold, RelativeThresholdParams
from pdr_est.front_end.steps.uptime_fsm import UptimeFsm, UptimeFsmParams
from pdr_est.front_end.steps.zero_crossing import ZeroCrossing, ZeroCrossingParams
from pdr_est.pipeline.front_end_chain import levelling
from pdr_est.simulate import SensorErrors, SensorParams, SimulatedWalk, WalkerGaitParams
from pdr_est.stage import Stage
from pdr_est.testing import check_partition, messy_device, one_by_one, slice_block
from pdr_est.types.sensors import LevelBlock
from pdr_est.types.steps import CarryingMode, StepEvent

Detector = Callable[[float], Stage]

DETECTORS: dict[str, Detector] = {
    "auto": lambda rate_hz: BandpassPeakDetector(rate_hz, AutoStepParams()),
    "mmpdr": lambda rate_hz: MmpdrSteps(rate_hz, MmpdrStepParams()),
    "uptime-fsm": lambda rate_hz: UptimeFsm(rate_hz, UptimeFsmParams()),
    "relative-threshold": lambda rate_hz: RelativeThreshold(rate_hz, RelativeThresholdParams()),
    "local-variance": lambda rate_hz: LocalVariance(rate_hz, LocalVarianceParams()),
    "zero-crossing": lambda rate_hz: ZeroCrossing(rate_hz, ZeroCrossingParams()),
    "magnitude-peaks": lambda rate_hz: MagnitudePeaks(rate_hz, MagnitudePeaksParams()),
}
NOISY = SensorParams(accelerometer=SensorErrors(noise_std=0.15, bias_std=0.1, scale_std=0.01))
every_detector = pytest.mark.parametrize("detector", DETECTORS.values(), ids=DETECTORS)


@cache
def walked(
    gait: WalkerGaitParams | None = None, sensors: SensorParams | None = None, rate_hz: float = RATE_HZ
) -> tuple[SimulatedWalk, tuple[LevelBlock, ...]]:
    """A simulated walk around a corner with a held phone, and its level samples."""
    walk = corner_walk(gait, sensors=sensors)
    return walk, tuple(levels_of(walk, rate_hz=rate_hz))


@cache
def messy_levels(rate_hz: float) -> tuple[LevelBlock, ...]:
    """A walk with gaps, lost samples and a clock that jumps: several segments."""
    _, to_level = levelling(messy_device(rate_hz, seed=1), "messy", Config())
    return tuple(run(to_level, messy_device(rate_hz, seed=1).blocks()))


def times_of(events: list[StepEvent]) -> np.ndarray:
    return np.array([event.time_s for event in events])


def assert_one_event_a_step(events: list[StepEvent], walk: SimulatedWalk) -> None:
    """As many events as steps in each bout, one more or less at its ends, and evenly spread within."""
    found_s = times_of(events)
    for bout in walk.steps.bouts:
        period_s = float(np.median(np.diff(walk.steps.time_s[bout])))
        first_s, last_s = walk.steps.start_s[bout][0] - 0.1, walk.steps.time_s[bout][-1] + 0.9
        inside = found_s[(found_s > first_s) & (found_s < last_s)]
        assert abs(len(inside) - len(walk.steps.time_s[bout])) <= 1
        spacing = np.diff(inside[1:-1]) / period_s
        assert spacing.min() > 0.6
        assert spacing.max() < 1.5


@every_detector
@pytest.mark.parametrize("rate_hz", [25.0, 50.0, 100.0, 400.0])
@pytest.mark.parametrize("cadence_hz", [1.6, 1.9])
def test_every_step_of_a_held_walk_is_found_once(detector: Detector, rate_hz: float, cadence_hz: float) -> None:
    walk, levels = walked(WalkerGaitParams(cadence_hz=cadence_hz), SensorParams(rate_hz=rate_hz))
    assert_one_event_a_step(run(detector(RATE_HZ), levels), walk)


def while_walking(times_s: np.ndarray, walk: SimulatedWalk) -> np.ndarray:
    """Leave out what a detector makes of a walker who sets off or comes to rest, which no rate decides."""
    inside = np.zeros(len(times_s), dtype=bool)
    for bout in walk.steps.bouts:
        first_s, *_, last_s = walk.steps.time_s[bout]
        inside |= (times_s > first_s + 0.8) & (times_s < last_s - 0.8)
    return times_s[inside]


@every_detector
@pytest.mark.parametrize("working_hz", [25.0, 100.0, 200.0])
def test_the_working_rate_changes_no_step(detector: Detector, working_hz: float) -> None:
    sensors = SensorParams(rate_hz=200.0)
    walk, levels = walked(sensors=sensors)
    usual_s = while_walking(times_of(run(detector(RATE_HZ), levels)), walk)
    other_s = times_of(run(detector(working_hz), walked(sensors=sensors, rate_hz=working_hz)[1]))
    other_s = while_walking(other_s, walk)
    np.testing.assert_allclose(other_s, usual_s, atol=0.12)
    assert abs(np.median(other_s - usual_s)) < 1.0 / 25.0


@every_detector
@pytest.mark.parametrize("sensors", [SensorParams(), NOISY], ids=["ordinary", "noisy"])
def test_nobody_steps_in_two_minutes_of_standing(detector: Detector, sensors: SensorParams) -> None:
    walk, levels = walked(WalkerGaitParams(lead_in_s=120.0), sensors)
    events = run(detector(RATE_HZ), levels)
    assert times_of(events).min() > walk.steps.start_s[0] - 0.1
    assert_one_event_a_step(events, walk)


@every_detector
def test_events_are_in_order_and_tell_where_they_belong(detector: Detector) -> None:
    _, levels = walked()
    events = run(detector(RATE_HZ), levels)
    at_index_s = joined(levels, "time_s")[[event.index - levels[0].first_index for event in events]]
    np.testing.assert_allclose(at_index_s, times_of(events), atol=0.5 / RATE_HZ + 1e-9)
    assert all(before.time_s < after.time_s for before, after in pairwise(events))
    assert {event.mode for event in events} <= {CarryingMode(int(mode)) for mode in joined(levels, "mode")}
    assert all(0.0 <= event.confidence <= 1.0 for event in events)


@every_detector
def test_no_event_is_later_than_the_latency(detector: Detector) -> None:
    stage, late_s = detector(RATE_HZ), []
    for block in one_by_one(walked()[1]):
        late_s += [block.time_s[-1] - event.time_s for event in stage.push(block)]
    assert len(late_s) > 30
    assert max(late_s) <= stage.latency_s + 1e-9


@every_detector
@pytest.mark.parametrize("start_s", [0.0, 17.3], ids=["standing", "walking"])
@pytest.mark.parametrize("stop_s", np.arange(8.0, 9.2, 0.1).tolist())
def test_a_new_segment_starts_from_nothing(detector: Detector, stop_s: float, start_s: float) -> None:
    """Wherever in a step a gap comes, the second segment has the events that it has on its own."""
    level = join(list(walked()[1]))
    before = slice_block(level, 0, round(stop_s * RATE_HZ))
    after = slice_block(level, round(start_s * RATE_HZ), len(level))
    after = replace(after, segment=1, first_index=after.first_index + 10_000, time_s=after.time_s + 200.0)
    events = run(detector(RATE_HZ), [before, after])
    alone = run(detector(RATE_HZ), [after])
    assert [event for event in events if event.segment == 1] == alone
    assert len(events) > len(alone) > 10


@every_detector
def test_empty_blocks_change_nothing(detector: Detector) -> None:
    _, levels = walked()
    empty = slice_block(levels[0], 0, 0)
    other = replace(empty, segment=7, first_index=99)
    assert run(detector(RATE_HZ), [empty, other]) == []
    assert run(detector(RATE_HZ), [empty, *levels, other]) == run(detector(RATE_HZ), levels)


@every_detector
@pytest.mark.parametrize("rate_hz", [25.0, 100.0])
def test_cuts_and_restores_change_no_bit(detector: Detector, rate_hz: float) -> None:
    levels = messy_levels(rate_hz)
    assert len(run(detector(RATE_HZ), levels)) >= 8
    check_partition(lambda: detector(RATE_HZ), levels, seed=int(rate_hz))
