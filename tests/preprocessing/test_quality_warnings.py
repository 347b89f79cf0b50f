"""What makes steps and a track doubtful: a gyroscope that is absent for a while, stands still or gives nonsense."""

from dataclasses import replace

import numpy as np
import pytest

from pdr_est.frames import Array
from pdr_est.preprocessing.quality.warnings import quality_warnings
from pdr_est.types.recording import DeviceRecording, Signal

TIME_S = np.arange(3001) / 50.0
NOISE = np.random.default_rng(3).normal(size=(2, 3001, 3))
FORCE = Signal(TIME_S, np.array([0.0, 0.0, 9.8]) + NOISE[0])
RATE = Signal(TIME_S, 0.2 * NOISE[1])
FULL = DeviceRecording(specific_force=FORCE, rotation_rate=RATE)


def with_values(signal: Signal, rows: slice, value: float) -> Signal:
    values: Array = signal.values.copy()
    values[rows] = value
    return Signal(signal.time_s, values)


def first(signal: Signal, seconds: float) -> Signal:
    rows = signal.time_s <= seconds
    return Signal(signal.time_s[rows], signal.values[rows])


def test_nothing_is_doubtful_of_a_sound_recording() -> None:
    assert quality_warnings(FULL) == ()
    assert quality_warnings(replace(FULL, rotation_rate=None)) == ()
    assert quality_warnings(replace(FULL, rotation_rate=Signal(np.empty(0), np.empty((0, 3))))) == ()
    # Sensors start and stop one after the other, and a gap in both costs nothing twice.
    assert quality_warnings(replace(FULL, rotation_rate=first(RATE, 59.5))) == ()
    holed = np.r_[0:1000, 2000:3001]
    force, rate = (Signal(signal.time_s[holed], signal.values[holed]) for signal in (FORCE, RATE))
    assert quality_warnings(DeviceRecording(specific_force=force, rotation_rate=rate)) == ()


def test_a_gyroscope_of_zeros_is_told_once() -> None:
    (words,) = quality_warnings(replace(FULL, rotation_rate=with_values(RATE, slice(None), 0.0)))
    assert words.startswith("all values of the gyroscope are zero")


@pytest.mark.parametrize(("value", "name"), [(0.0, "gyroscope"), (0.3, "gyroscope"), (9.0, "accelerometer")])
def test_a_sensor_that_stands_still_for_half_of_the_walk(value: float, name: str) -> None:
    half = slice(1500, None)
    stuck = {
        "gyroscope": replace(FULL, rotation_rate=with_values(RATE, half, value)),
        "accelerometer": replace(FULL, specific_force=with_values(FORCE, half, value)),
    }[name]
    (words,) = quality_warnings(stuck)
    unseen = {"gyroscope": "turns", "accelerometer": "steps"}[name]
    assert words == f"the {name} is stuck from 30.00 s on, for 30.0 s in all: {unseen} cannot be seen there"


def test_a_gyroscope_that_covers_a_part() -> None:
    (most,) = quality_warnings(replace(FULL, rotation_rate=first(RATE, 45.0)))
    assert most == "the gyroscope covers only 45.0 of 60.0 s of the accelerometer: nothing outside is used"
    (few,) = quality_warnings(replace(FULL, rotation_rate=first(RATE, 0.4)))
    assert few.startswith("the gyroscope covers only 0.4 of 60.0 s of the accelerometer: nothing outside is used; ")
    assert "without the gyroscope" in few
    holed = np.r_[0:1000, 2000:3001]
    (gap,) = quality_warnings(replace(FULL, rotation_rate=Signal(TIME_S[holed], RATE.values[holed])))
    assert gap.startswith("the gyroscope covers only 40.0 of 60.0 s")


def test_what_no_phone_can_measure_is_counted() -> None:
    assert quality_warnings(replace(FULL, specific_force=with_values(FORCE, slice(5, 7), 1e30))) == (
        "2 of 3001 samples of the accelerometer are beyond 1000 m/s^2, which no phone can measure, and are left out",
    )
    (words,) = quality_warnings(replace(FULL, rotation_rate=with_values(RATE, slice(5, 6), -1e6)))
    assert words.startswith("1 of 3001 samples of the gyroscope are beyond 200 rad/s")


def test_samples_too_far_apart_for_steps_are_told() -> None:
    def thinned(period_s: float) -> DeviceRecording:
        time_s = np.arange(0.0, 30.0, period_s)
        noise = np.random.default_rng(1).normal(size=(len(time_s), 3))
        return DeviceRecording(specific_force=Signal(time_s, noise + np.array([0.0, 0.0, 9.8])))

    assert quality_warnings(thinned(0.1)) == ()
    (words,) = quality_warnings(thinned(0.2))
    assert "the accelerometer has only 5.0 samples a second" in words


def test_an_axis_that_never_changes_is_told() -> None:
    for name, signal in (("accelerometer", FORCE), ("gyroscope", RATE)):
        values: Array = signal.values.copy()
        values[:, 1] = 0.0
        field = {"accelerometer": "specific_force", "gyroscope": "rotation_rate"}[name]
        told = quality_warnings(replace(FULL, **{field: Signal(signal.time_s, values)}))
        assert any(f"the y axis of the {name} is always 0 while the others change" in words for words in told)


def test_an_accelerometer_that_hits_the_end_of_its_range_is_told_with_the_axis_and_the_share() -> None:
    motion = 8.0 * np.sin(2.0 * np.pi * 1.8 * TIME_S)[:, None] * np.array([0.2, 0.1, 1.0])
    whole = Signal(TIME_S, FORCE.values + motion)
    clipped = Signal(TIME_S, np.clip(whole.values, -15.0, 15.0))
    assert quality_warnings(replace(FULL, specific_force=whole)) == ()
    (words,) = quality_warnings(replace(FULL, specific_force=clipped))
    assert words.startswith("the z axis of the accelerometer hits the end of its range")
    share = float(np.mean(clipped.values[:, 2] == 15.0))
    assert f"{share:.1%} of its samples" in words
