"""An accelerometer that is too slow for steps is warned of or refused, whatever its clock looks like."""

from dataclasses import replace

import numpy as np
import pytest

from pdr_est import pipeline
from pdr_est.config import Config
from pdr_est.errors import RecordingError
from pdr_est.preprocessing.quality.inspection import inspect_recording
from pdr_est.preprocessing.quality.sampling_rate import mean_rate_hz, refuse_slow_sampling, slow_sampling_warnings
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
    warnings = slow_sampling_warnings(sampled(rate_hz))
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
