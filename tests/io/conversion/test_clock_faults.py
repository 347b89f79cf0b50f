"""Stray time stamps cost their own samples only, a restarted clock moves all sensors alike, and time is no memory."""

import numpy as np
import pytest

from pdr_est.clock_sync.common_signals import RATE_HZ, extract_common_signals
from pdr_est.config import Config
from pdr_est.frames import Array
from pdr_est.io.conversion.clock_faults import mend_clocks, stray_stamps
from pdr_est.pipeline import analyse_recording
from pdr_est.types.recording import DeviceRecording, Recording, Signal

SPAN_S = 40.0


def walked(*parts: tuple[float, float], late_s: float = 0.0) -> DeviceRecording:
    """Make a device whose clock runs through some spans, begin and end in s, one after the other."""

    def signal(rate_hz: float, phase_s: float, width: int) -> Signal:
        times = [np.arange(begin + phase_s, end, 1.0 / rate_hz) + late_s for begin, end in parts]
        time_s = np.concatenate(times)
        passed_s = np.arange(len(time_s)) / rate_hz
        shape = 2.0 * np.sin(2.0 * np.pi * 1.9 * passed_s)
        if width == 1:
            return Signal(time_s, np.full((len(time_s), 1), 101325.0))
        return Signal(time_s, np.column_stack([0.1 * shape, 0.05 * shape, 9.8 + shape]))

    return DeviceRecording(
        specific_force=signal(100.0, 0.0, 3),
        rotation_rate=signal(50.0, 0.013, 3),
        magnetic_field=signal(10.0, 0.07, 3),
        pressure=signal(1.0, 0.4, 1),
    )


def recorded(*devices: DeviceRecording) -> Recording:
    return Recording("walk", "test", devices)


@pytest.mark.parametrize("seed", range(30))
def test_stamps_that_contradict_their_neighbours_are_found_and_no_others(seed: int) -> None:
    rng = np.random.default_rng(seed)
    time_s = np.cumsum(rng.uniform(0.005, 0.015, 3000))
    wrong = np.zeros(len(time_s), dtype=np.bool_)
    for at in rng.choice(np.arange(1, 50), 3, replace=False) * 60 - rng.integers(0, 20):
        count = rng.integers(1, 4)
        time_s[at : at + count] += rng.choice([-1.0, 1.0]) * 10.0 ** rng.uniform(0.5, 9.0)
        wrong[at : at + count] = True
    np.testing.assert_array_equal(stray_stamps(time_s), wrong)


@pytest.mark.parametrize("at", [0, -1])
@pytest.mark.parametrize("shift_s", [-1000.0, 1000.0])
def test_a_far_stamp_at_an_end_is_stray(at: int, shift_s: float) -> None:
    time_s = np.arange(500) / 100.0
    time_s[at] += shift_s
    assert np.flatnonzero(stray_stamps(time_s)).tolist() == [np.arange(500)[at]]


@pytest.mark.parametrize(
    "time_s",
    [
        np.arange(1000) / 50.0,
        np.sort(np.random.default_rng(1).uniform(0.0, 100.0, 500)),
        np.repeat(np.arange(100.0), 5),
        np.concatenate([np.arange(k, k + 0.02, 0.01) for k in range(200)]),
        np.concatenate([np.arange(0.0, 30.0, 0.01), np.arange(0.0, 30.0, 0.01)]),
        np.concatenate([np.arange(0.0, 30.0, 0.01), np.arange(5000.0, 5030.0, 0.01)]),
    ],
    ids=["even", "random", "bursts of one stamp", "short bursts", "restart", "pause"],
)
def test_gaps_bursts_and_restarts_are_no_stray_stamps(time_s: Array) -> None:
    assert not stray_stamps(time_s).any()


def test_a_recording_with_nothing_to_mend_is_returned_as_it_is() -> None:
    recording = recorded(walked((0.0, 20.0), (25.0, 40.0)))
    assert mend_clocks(recording) is recording


def test_a_stray_stamp_costs_one_sample_and_is_told() -> None:
    device = walked((0.0, SPAN_S))
    assert device.specific_force is not None
    time_s = device.specific_force.time_s.copy()
    time_s[1500] += 1e6
    damaged = recorded(DeviceRecording(
        specific_force=Signal(time_s, device.specific_force.values), rotation_rate=device.rotation_rate
    ))  # fmt: skip
    (mended,) = mend_clocks(damaged).devices
    assert mended.specific_force is not None
    assert len(mended.specific_force) == len(time_s) - 1
    assert mended.span_s == device.span_s
    assert "1 of 4000 samples are left out" in mended.warnings[0]
    (walk,), (whole,) = (analyse_recording(one, Config()) for one in (damaged, recorded(device)))
    assert len(walk.steps) == len(whole.steps) > 40
    assert walk.gaps == ()


@pytest.mark.parametrize("back_to_s", [0.0, -1e6, 18.0])
def test_a_restart_moves_all_sensors_alike(back_to_s: float) -> None:
    device = walked((0.0, 20.0), (back_to_s, back_to_s + 20.0))
    (mended,) = mend_clocks(recorded(device)).devices
    (restart_s,) = mended.restarts_s
    assert 20.5 < restart_s < 21.5
    moved = {}
    for name, signal in mended.signals().items():
        assert (np.diff(signal.time_s) > 0.0).all(), name
        moved[name] = signal.time_s[-1] - device.signals()[name].time_s[-1]
    assert max(moved.values()) - min(moved.values()) < 1e-6
    assert "the clock restarted once" in mended.warnings[0]
    (walk,) = analyse_recording(recorded(device), Config())
    holes = [level.hole for level in walk.level if level.hole is not None]
    assert [hole.duration_known for hole in holes] == [False]


def test_a_sensor_that_missed_a_restart_is_moved_with_the_others() -> None:
    device = walked((0.0, 20.0), (4.0, 17.0), (1.0, 10.0))
    field = device.magnetic_field
    assert field is not None
    # The magnetometer was off between the two restarts.
    on = np.ones(len(field), dtype=np.bool_)
    on[200:330] = False
    partly = DeviceRecording(
        specific_force=device.specific_force, magnetic_field=Signal(field.time_s[on], field.values[on])
    )
    (whole,), (mended,) = mend_clocks(recorded(device)).devices, mend_clocks(recorded(partly)).devices
    assert mended.magnetic_field is not None
    assert whole.magnetic_field is not None
    assert mended.magnetic_field.time_s[-1] == pytest.approx(whole.magnetic_field.time_s[-1], abs=0.2)


@pytest.mark.parametrize("days", [2.0, 20.0, 10000.0])
def test_the_search_for_a_clock_needs_no_memory_for_time_without_samples(days: float) -> None:
    pause_s = days * 86400.0
    device = walked((0.0, 60.0), (pause_s, pause_s + 30.0))
    assert len(extract_common_signals(device).log_intensity) < 61.0 * RATE_HZ
