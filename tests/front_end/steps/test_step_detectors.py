"""Step detection on simulated walks: every step once, none while standing, in time, at any rate."""

from dataclasses import replace

import numpy as np
import pytest
from signals import RATE_HZ, corner_walk, joined, levels_of, run

from pdr_est.frames import Array
from pdr_est.front_end.signal.blocks import part
from pdr_est.front_end.steps.bandpass_peaks import AutoStepParams, BandpassPeakDetector
from pdr_est.front_end.steps.mmpdr_peaks import MmpdrStepParams, MmpdrSteps
from pdr_est.front_end.steps.segmentation import SegmentationParams, StepSegmentation
from pdr_est.simulate import HeldPhone, SensorErrors, SensorParams, SimulatedWalk, WalkerGaitParams
from pdr_est.stage import Stage
from pdr_est.types.sensors import LevelBlock
from pdr_est.types.steps import StepEvent

NOISY = SensorParams(accelerometer=SensorErrors(noise_std=0.15, bias_std=0.1, scale_std=0.01))


def auto_steps(rate_hz: float = RATE_HZ) -> Stage:
    return BandpassPeakDetector(rate_hz, AutoStepParams())


def mmpdr(rate_hz: float = RATE_HZ) -> Stage:
    return MmpdrSteps(rate_hz, MmpdrStepParams())


DETECTORS = {"auto": auto_steps, "mmpdr": mmpdr}


def event_times(detector: Stage, levels: list[LevelBlock]) -> Array:
    return np.array([event.time_s for event in run(detector, levels)])


def assert_one_event_a_step(found_s: Array, walk: SimulatedWalk, extra_a_bout: int) -> None:
    """Every heel strike is met within 0.1 s by one event, and few events are left over."""
    nearest = np.abs(found_s[:, None] - walk.steps.time_s).argmin(axis=1)
    close = np.abs(found_s - walk.steps.time_s[nearest]) < 0.1
    assert sorted(nearest[close]) == list(range(len(walk.steps)))
    assert np.count_nonzero(~close) <= extra_a_bout * len(walk.steps.bouts)


def assert_one_event_between_heel_strikes(found_s: Array, walk: SimulatedWalk, extra_a_bout: int) -> None:
    """The trunk is highest once between two heel strikes, and may seem so before the first and after the last."""
    between = 0
    for bout in walk.steps.bouts:
        counts = np.histogram(found_s, walk.steps.time_s[bout])[0]
        np.testing.assert_array_equal(counts, 1)
        between += len(counts)
    assert len(found_s) - between <= extra_a_bout * len(walk.steps.bouts)


@pytest.mark.parametrize("cadence_hz", [1.4, 1.6, 1.8, 1.9])
@pytest.mark.parametrize("height_m", [1.55, 1.73, 1.95])
@pytest.mark.parametrize("seed", [0, 1])
def test_auto_steps_meets_every_heel_strike_and_nothing_else(cadence_hz: float, height_m: float, seed: int) -> None:
    walk = corner_walk(WalkerGaitParams(cadence_hz=cadence_hz, height_m=height_m), seed=seed)
    assert_one_event_a_step(event_times(auto_steps(), levels_of(walk)), walk, extra_a_bout=0)


@pytest.mark.parametrize("cadence_hz", [2.0, 2.15, 2.3])
@pytest.mark.parametrize("height_m", [1.55, 1.73, 1.95])
def test_auto_steps_on_a_hurried_walk_may_count_the_push_off(cadence_hz: float, height_m: float) -> None:
    """A vigorous start begins with a hump of its own, which nothing is there yet to be compared with."""
    walk = corner_walk(WalkerGaitParams(cadence_hz=cadence_hz, height_m=height_m), seed=1)
    assert_one_event_a_step(event_times(auto_steps(), levels_of(walk)), walk, extra_a_bout=1)


@pytest.mark.parametrize("tilt_deg", [0.0, 20.0, 40.0, 60.0, 80.0])
@pytest.mark.parametrize("sensors", [SensorParams(), NOISY], ids=["ordinary", "noisy"])
def test_tilt_and_noise_change_no_count(tilt_deg: float, sensors: SensorParams) -> None:
    walk = corner_walk(carry=HeldPhone(tilt_rad=float(np.deg2rad(tilt_deg))), sensors=sensors, seed=2)
    levels = levels_of(walk)
    assert_one_event_a_step(event_times(auto_steps(), levels), walk, extra_a_bout=0)
    assert_one_event_between_heel_strikes(event_times(mmpdr(), levels), walk, extra_a_bout=2)


@pytest.mark.parametrize("cadence_hz", [1.6, 1.8, 2.0, 2.2, 2.3])
@pytest.mark.parametrize("height_m", [1.55, 1.73, 1.95])
def test_mmpdr_finds_one_crest_a_step(cadence_hz: float, height_m: float) -> None:
    walk = corner_walk(WalkerGaitParams(cadence_hz=cadence_hz, height_m=height_m), seed=1)
    assert_one_event_between_heel_strikes(event_times(mmpdr(), levels_of(walk)), walk, extra_a_bout=2)


def test_mmpdr_needs_a_low_threshold_for_a_slow_walk() -> None:
    """The trunk of a short walker at 1.4 steps a second falls with little more than 1 m/s^2."""
    walk = corner_walk(WalkerGaitParams(cadence_hz=1.4, height_m=1.6), seed=1)
    levels = levels_of(walk)
    higher = MmpdrSteps(RATE_HZ, replace(MmpdrStepParams(), holding_threshold_mps2=1.0))
    assert len(event_times(higher, levels)) < 0.95 * len(walk.steps)
    assert_one_event_between_heel_strikes(event_times(mmpdr(), levels), walk, extra_a_bout=2)


@pytest.mark.parametrize("detector", DETECTORS)
@pytest.mark.parametrize("sensors", [SensorParams(), NOISY], ids=["ordinary", "noisy"])
def test_nobody_steps_in_two_minutes_of_standing(detector: str, sensors: SensorParams) -> None:
    walk = corner_walk(WalkerGaitParams(lead_in_s=120.0), sensors=sensors)
    found_s = event_times(DETECTORS[detector](), levels_of(walk))
    assert found_s.min() > walk.steps.start_s[0] - 0.1
    pause_s = walk.steps.time_s[walk.steps.bouts[0]][-1], walk.steps.start_s[walk.steps.bouts[1]][0]
    assert not ((found_s > pause_s[0] + 0.7) & (found_s < pause_s[1] - 0.1)).any()
    assert found_s.max() < walk.steps.time_s[-1] + 0.7


@pytest.mark.parametrize("detector", DETECTORS)
@pytest.mark.parametrize("segmented", [False, True])
def test_events_come_out_within_the_latency(detector: str, segmented: bool) -> None:
    stage = DETECTORS[detector]()
    if segmented:
        stage = StepSegmentation(stage, SegmentationParams())
    late_s = [
        block.time_s[-1] - (output.time_s if isinstance(output, StepEvent) else output.event.time_s)
        for block in one_sample_each(levels_of(corner_walk()))
        for output in stage.push(block)
    ]
    assert len(late_s) > 30
    assert max(late_s) <= stage.latency_s + 1e-9
    assert stage.flush() == []


def one_sample_each(blocks: list[LevelBlock]) -> list[LevelBlock]:
    return [part(block, i, i + 1) for block in blocks for i in range(len(block))]


@pytest.mark.parametrize("detector", DETECTORS)
def test_the_rate_of_input_does_not_matter(detector: str) -> None:
    found = [
        event_times(DETECTORS[detector](), levels_of(corner_walk(sensors=SensorParams(rate_hz=rate_hz))))
        for rate_hz in (25.0, 50.0, 100.0, 400.0)
    ]
    for times_s in found[1:]:
        np.testing.assert_allclose(times_s, found[0], atol=0.05)
        assert abs(np.median(times_s - found[0])) < 0.015


@pytest.mark.parametrize("detector", DETECTORS)
@pytest.mark.parametrize("working_hz", [25.0, 100.0, 200.0])
def test_the_working_rate_does_not_matter(detector: str, working_hz: float) -> None:
    walk = corner_walk()
    usual_s = event_times(DETECTORS[detector](), levels_of(walk))
    other_s = event_times(DETECTORS[detector](working_hz), levels_of(walk, rate_hz=working_hz))
    np.testing.assert_allclose(other_s, usual_s, atol=0.06)


@pytest.mark.parametrize("detector", DETECTORS)
def test_times_and_indices_of_events_belong_together(detector: str) -> None:
    levels = levels_of(corner_walk())
    events = run(DETECTORS[detector](), levels)
    time_s, first = joined(levels, "time_s"), levels[0].first_index
    at_index_s = np.array([time_s[event.index - first] for event in events])
    np.testing.assert_allclose(at_index_s, [event.time_s for event in events], atol=0.5 / RATE_HZ + 1e-9)
    assert {event.mode.name for event in events} == {"HOLDING"}
    assert (np.diff([event.time_s for event in events]) > 0.0).all()


@pytest.mark.parametrize("detector", DETECTORS)
def test_a_gap_hides_the_steps_within_and_no_other(detector: str) -> None:
    walk = corner_walk(sensors=SensorParams(gaps_s=((6.0, 9.0),)))
    whole_s = event_times(DETECTORS[detector](), levels_of(corner_walk(sensors=SensorParams())))
    found = run(DETECTORS[detector](), levels_of(walk))
    found_s = np.array([event.time_s for event in found])
    assert {event.segment for event in found} == {0, 1}
    for edge_a, edge_b in ((0.0, 5.5), (10.5, walk.steps.end_s)):
        expected = whole_s[(whole_s > edge_a) & (whole_s < edge_b)]
        np.testing.assert_allclose(found_s[(found_s > edge_a) & (found_s < edge_b)], expected, atol=0.03)
    assert not ((found_s > 6.0) & (found_s < 9.0)).any()
