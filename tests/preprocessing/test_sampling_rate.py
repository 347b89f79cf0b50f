"""An accelerometer that is too slow for steps is warned of or refused, whatever its clock looks like."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from pdr_est import pipeline
from pdr_est.config import Config
from pdr_est.errors import RecordingError
from pdr_est.preprocessing.quality.inspection import inspect_recording
from pdr_est.preprocessing.quality.sampling_rate import (
    mean_rate_hz,
    refuse_slow_sampling,
    sampling_rate,
    sampling_rate_warnings,
    slow_gyroscope_warnings,
)
from pdr_est.preprocessing.quality.warnings import quality_warnings
from pdr_est.simulate import preset, simulate_walk
from pdr_est.types.recording import Recording, Signal


def sampled(rate_hz: float, duration_s: float = 20.0) -> Signal:
    time_s = np.arange(0.0, duration_s, 1.0 / rate_hz)
    return Signal(time_s, np.tile([0.0, 0.0, 9.8], (len(time_s), 1)))


def test_gaps_and_shared_stamps_do_not_change_the_rate() -> None:
    time_s = sampled(50.0).time_s
    assert mean_rate_hz(time_s) == pytest.approx(50.0)
    assert mean_rate_hz(np.r_[time_s, time_s + 60.0]) == pytest.approx(50.0, rel=0.01)
    assert mean_rate_hz(np.floor(time_s * 5.0) / 5.0) == pytest.approx(50.0, rel=0.02)
    assert mean_rate_hz(np.zeros(9)) == 0.0


@pytest.mark.parametrize(("rate_hz", "warned", "refused"), [(2.0, 1, True), (5.0, 1, False), (10.0, 0, False)])
def test_what_cannot_show_steps_is_refused_and_what_misses_some_is_warned_of(
    rate_hz: float, warned: int, refused: bool
) -> None:
    warnings = sampling_rate_warnings(sampled(rate_hz))
    assert len(warnings) == warned
    assert all(f"{rate_hz:.1f} samples a second" in words for words in warnings)
    if refused:
        with pytest.raises(RecordingError, match=r"phone: .*only 2\.0 samples a second"):
            refuse_slow_sampling(sampled(rate_hz), "phone")
    else:
        refuse_slow_sampling(sampled(rate_hz), "phone")


def thinned(by: int) -> Recording:
    recording = simulate_walk(preset("l_shape")).recording
    device = recording.devices[0]
    signals = {
        name: Signal(signal.time_s[::by], signal.values[::by])
        for name in ("specific_force", "rotation_rate")
        if (signal := getattr(device, name)) is not None
    }
    return replace(recording, devices=(replace(device, **signals),))


def test_a_thinned_walk_promises_no_track() -> None:
    with pytest.raises(RecordingError, match="samples a second, which cannot show steps"):
        pipeline.analyse_recording(thinned(40), Config())
    (inspected,) = inspect_recording(thinned(40)).devices
    assert all("a track is not to be trusted" in words for words in inspected.capabilities)
    (inspected,) = inspect_recording(thinned(4)).devices
    assert inspected.capabilities == ("steps, headings and a track",)


def moving(rate_hz: float, duration_s: float = 40.0) -> Signal:
    """What a sensor sees of a walk that stands still in the first half, with noise and six digits."""
    time_s = np.arange(0.0, duration_s, 1.0 / rate_hz)
    noise = np.random.default_rng(3).normal(0.0, 0.3, (len(time_s), 3))
    walk = np.sin(2.0 * np.pi * time_s[:, None] * [2.0, 1.0, 0.5]) * 3.0 + noise
    return Signal(time_s, np.round(np.where(time_s[:, None] < 0.5 * duration_s, 0.01 * noise, walk), 6))


def held(signal: Signal, by: int) -> Signal:
    return Signal(signal.time_s, signal.values[np.arange(len(signal)) // by * by])


def joined(signal: Signal, by: int) -> Signal:
    axes = [np.interp(signal.time_s, signal.time_s[::by], axis[::by]) for axis in signal.values.T]
    return Signal(signal.time_s, np.round(np.stack(axes, axis=1), 6))


@pytest.mark.parametrize("fill", [held, joined])
@pytest.mark.parametrize(("by", "warned", "refused"), [(25, 1, True), (13, 1, True), (10, 1, False), (5, 0, False)])
def test_values_that_repeat_or_follow_lines_are_no_new_ones(fill: Any, by: int, warned: int, refused: bool) -> None:
    signal = fill(moving(50.0), by)
    assert sampling_rate(signal).new_hz == pytest.approx(50.0 / by, rel=0.1)
    assert sampling_rate(signal).samples_hz == pytest.approx(50.0)
    words = [*sampling_rate_warnings(signal), *slow_gyroscope_warnings(signal)]
    assert len(words) == 2 * warned
    assert all("new values a second (repeated" in one for one in words)
    if refused:
        with pytest.raises(RecordingError, match="new values a second"):
            refuse_slow_sampling(signal, "phone")
    else:
        refuse_slow_sampling(signal, "phone")


def test_a_few_repeated_values_and_few_digits_are_no_slow_sensor() -> None:
    walk = moving(50.0)
    coarse = Signal(walk.time_s, np.round(walk.values / 0.15) * 0.15)
    assert (coarse.values[:1000] == coarse.values[0]).all()
    assert sampling_rate_warnings(coarse) == ()
    again = np.random.default_rng(5).random(len(walk)) < 0.4
    repeated = Signal(walk.time_s, walk.values[np.arange(len(walk)) - again])
    assert sampling_rate_warnings(repeated) == ()


def test_a_held_accelerometer_is_refused_and_a_held_gyroscope_told() -> None:
    recording = simulate_walk(preset("l_shape")).recording
    (device,) = recording.devices
    assert device.specific_force is not None
    assert device.rotation_rate is not None
    slow = replace(device, rotation_rate=held(device.rotation_rate, 33))
    assert any("the gyroscope has only 3.0 new values" in words for words in quality_warnings(slow))
    (inspected,) = inspect_recording(replace(recording, devices=(slow,))).devices
    assert any("the gyroscope has only" in words for words in inspected.capabilities)
    slow = replace(device, specific_force=held(device.specific_force, 33))
    with pytest.raises(RecordingError, match=r"the accelerometer has only .* new values"):
        pipeline.analyse_recording(replace(recording, devices=(slow,)), Config())
