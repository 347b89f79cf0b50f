"""What steps need of a device and what a track needs: which channels are taken, and the words of a refusal."""

import re
from dataclasses import replace

import numpy as np
import pytest

from pdr_est.errors import RecordingError
from pdr_est.preprocessing.quality.clock_requirements import explain_empty_grid
from pdr_est.preprocessing.quality.requirements import (
    has_gyroscope,
    prefers_recorded_attitude,
    require_track_sensors,
    required_channels,
)
from pdr_est.types.recording import DeviceRecording, Signal
from pdr_est.types.sensors import Channel

TIME_S = np.arange(100) / 50.0
FORCE = Signal(TIME_S, np.tile([0.0, 0.0, 9.8], (100, 1)))
RATE = Signal(TIME_S, np.full((100, 3), 0.1))
ATTITUDE = Signal(TIME_S, np.tile([1.0, 0.0, 0.0, 0.0], (100, 1)))
NOTHING = Signal(np.empty(0), np.empty((0, 3)))

FULL = DeviceRecording(specific_force=FORCE, rotation_rate=RATE, attitude=ATTITUDE)
BARE = DeviceRecording(specific_force=FORCE, warnings=("the gyroscope is broken",))


def test_the_channels_that_are_taken() -> None:
    force, rate, attitude = Channel.SPECIFIC_FORCE, Channel.ROTATION_RATE, Channel.ATTITUDE
    assert required_channels(FULL, "walk", with_attitude=False) == (force, rate)
    assert required_channels(FULL, "walk", with_attitude=True) == (force, rate, attitude)
    assert required_channels(BARE, "walk", with_attitude=False) == (force,)
    assert required_channels(replace(BARE, rotation_rate=NOTHING), "walk", with_attitude=False) == (force,)


def test_a_gyroscope_of_zeros_is_one() -> None:
    fake = replace(FULL, rotation_rate=Signal(TIME_S, np.zeros((100, 3))))
    assert has_gyroscope(fake)
    require_track_sensors(fake, "walk")


def test_a_track_needs_both_and_says_what_remains() -> None:
    require_track_sensors(FULL, "walk")
    with pytest.raises(RecordingError, match=r"^walk: no gyroscope \(the gyroscope is broken\), .*`pdr-est steps` "):
        require_track_sensors(BARE, "walk")
    with pytest.raises(RecordingError, match=r"^walk: no accelerometer, without which nothing can be estimated"):
        require_track_sensors(replace(FULL, specific_force=None), "walk")


def test_steps_need_an_accelerometer_that_runs() -> None:
    with pytest.raises(RecordingError, match=r"^walk: no accelerometer"):
        required_channels(DeviceRecording(rotation_rate=RATE), "walk", with_attitude=False)
    stuck = DeviceRecording(specific_force=Signal(np.zeros(100), FORCE.values))
    with pytest.raises(RecordingError, match=r"^walk: all 100 time stamps of the accelerometer are 0\.00 s"):
        required_channels(stuck, "walk", with_attitude=False)


def test_a_gyroscope_that_cannot_be_used_is_not_passed_over() -> None:
    """One that is there and damaged is for its owner to repair or to remove, not for the reader to ignore."""
    late = replace(FULL, rotation_rate=Signal(TIME_S + 100.0, RATE.values))
    with pytest.raises(RecordingError, match=r"^walk: the channels do not overlap in time \(accelerometer 0\.00"):
        required_channels(late, "walk", with_attitude=False)


@pytest.mark.parametrize("attitude", [ATTITUDE, None])
def test_the_devices_attitude_is_used_with_a_gyroscope_only(attitude: Signal | None) -> None:
    with pytest.raises(
        RecordingError, match=r"^walk: no gyroscope .*set attitude.source: vqf in the configuration to find steps"
    ):
        required_channels(replace(BARE, attitude=attitude), "walk", with_attitude=True)


def test_why_nothing_came_out_of_whole_seconds_or_another_unit() -> None:
    rounded = DeviceRecording(specific_force=Signal(np.floor(TIME_S), FORCE.values))
    assert re.search(
        r"^walk: the time stamps of the accelerometer are whole seconds, 100 samples on 2 of them: give the frac",
        str(explain_empty_grid(rounded, "walk", 0.5)),
    )
    milli_g = DeviceRecording(specific_force=Signal(TIME_S, 1e3 * FORCE.values))
    assert "accelerometer reach 9.8e+03 m/s^2, more than 1000" in str(explain_empty_grid(milli_g, "walk", 0.5))
    short = DeviceRecording(specific_force=Signal(TIME_S[:2], FORCE.values[:2]))
    told = str(explain_empty_grid(short, "walk", 0.5))
    assert re.search(r"the accelerometer spans 0\.\d+ s with 2 samples\): record for longer", told)
    rushed = DeviceRecording(specific_force=Signal(TIME_S / 1e6, FORCE.values))
    assert "more a second than any phone has: give the time in seconds, or state" in str(
        explain_empty_grid(rushed, "walk", 0.5)
    )
    hourly = DeviceRecording(specific_force=Signal(3600.0 * TIME_S, FORCE.values))
    assert "and span" in (told := str(explain_empty_grid(hourly, "walk", 0.5)))
    assert "state the unit of time with --map" in told


def test_a_clock_in_nanoseconds_is_shown_with_its_values() -> None:
    ticks = Signal(1_927_000_000e9 + 1e9 * TIME_S, FORCE.values)
    with pytest.raises(RecordingError, match=r"begin with 1927000000000000000, .*more than a year.*unit: ns"):
        required_channels(replace(BARE, specific_force=ticks), "walk", with_attitude=False)


def sampled(rate_hz: float, attitude_hz: float, attitude_s: tuple[float, float] = (0.0, 20.0)) -> DeviceRecording:
    """20 s of gyroscope and, between two times, of the device's own attitude."""
    time_s, own_s = np.arange(0.0, 20.0, 1.0 / rate_hz), np.arange(*attitude_s, 1.0 / attitude_hz)
    return DeviceRecording(
        specific_force=Signal(time_s, np.zeros((len(time_s), 3))),
        rotation_rate=Signal(time_s, np.zeros((len(time_s), 3))),
        attitude=Signal(own_s, np.tile([1.0, 0.0, 0.0, 0.0], (len(own_s), 1))),
    )


@pytest.mark.parametrize(
    ("device", "better"),
    [
        (sampled(25.0, 25.0), True),
        (sampled(25.0, 50.0), True),
        (sampled(50.0, 50.0), False),  # the samples are close enough
        (sampled(100.0, 100.0), False),
        (sampled(25.0, 20.0), False),  # rarer than the samples
        (sampled(25.0, 50.0, (2.0, 20.0)), False),  # begins late
        (sampled(25.0, 50.0, (0.0, 18.0)), False),  # ends early
        (sampled(25.0, 25.0, (0.5, 19.5)), True),
        (replace(sampled(25.0, 25.0), attitude=None), False),
        (replace(sampled(25.0, 25.0), rotation_rate=None), False),
        (replace(sampled(25.0, 25.0), attitude=NOTHING), False),
        (DeviceRecording(rotation_rate=Signal(TIME_S[:1], RATE.values[:1]), attitude=ATTITUDE), False),
    ],
)
def test_the_devices_attitude_is_better_where_samples_are_coarse(device: DeviceRecording, better: bool) -> None:
    assert prefers_recorded_attitude(device) is better


def test_columns_that_may_be_the_missing_gyroscope_are_named() -> None:
    unread = replace(BARE, decisions=("specific force is acc_x, acc_y, acc_z", "not used: rx, ry, rz, temperature"))
    with pytest.raises(RecordingError, match=r"rx, ry, rz, temperature.*--map"):
        require_track_sensors(unread, "walk")
    with pytest.raises(RecordingError) as every_column_used:
        require_track_sensors(BARE, "walk")
    assert "--map" not in str(every_column_used.value)
