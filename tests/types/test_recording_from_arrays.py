"""Recordings made from numpy arrays, and what is refused."""

import re

import numpy as np
import pytest

import pdr_est
from pdr_est.errors import RecordingError
from pdr_est.simulate import preset, simulate_walk

N = 200
TIME_S = np.arange(N) / 100.0
FORCE = np.tile([0.0, 0.0, 9.81], (N, 1))
RATE = np.full((N, 3), 0.1)


def test_three_lines_give_a_recording() -> None:
    recording = pdr_est.Recording.from_arrays(TIME_S.tolist(), FORCE, RATE, attitude=np.eye(4)[np.zeros(N, int)])
    (device,) = recording.devices
    assert (recording.name, recording.format, device.name) == ("arrays", "arrays", "phone")
    assert device.specific_force is not None
    assert device.attitude is not None
    np.testing.assert_array_equal(device.specific_force.values, FORCE)
    assert device.span_s == (0.0, 1.99)
    assert device.magnetic_field is None


def test_the_recording_does_not_change_with_the_arrays() -> None:
    force, times = FORCE.copy(), TIME_S.copy()
    (device,) = pdr_est.Recording.from_arrays(times, force).devices
    force[0], times[0] = 7.0, -1.0
    assert device.specific_force is not None
    assert device.specific_force.values[0, 2] == 9.81
    assert device.specific_force.time_s[0] == 0.0


def test_the_track_is_that_of_the_recording_that_the_arrays_come_from() -> None:
    simulated = simulate_walk(preset("l_shape")).recording
    phone = simulated.devices[0]
    assert phone.specific_force is not None
    assert phone.rotation_rate is not None
    time_s, force = phone.specific_force.time_s, phone.specific_force.values
    rate = np.column_stack(
        [np.interp(time_s, phone.rotation_rate.time_s, column) for column in phone.rotation_rate.values.T]
    )
    device = pdr_est.DeviceRecording(
        specific_force=pdr_est.Signal(time_s, force), rotation_rate=pdr_est.Signal(time_s, rate)
    )
    track = pdr_est.smooth(pdr_est.Recording.from_arrays(time_s, force, rate))
    expected = pdr_est.smooth(pdr_est.Recording("same", "", (device,)))
    np.testing.assert_array_equal(track.position_m, expected.position_m)
    assert len(track) > 50


def test_a_recording_says_shortly_what_it_is() -> None:
    assert repr(pdr_est.Recording.from_arrays(TIME_S, FORCE)) == "Recording('arrays': arrays, devices 'phone', 2.0 s)"
    assert repr(pdr_est.Recording("empty", "none", ())) == "Recording('empty': none, devices , 0.0 s)"


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((TIME_S[:, None], FORCE), r"time_s has shape \(200, 1\): give at least two times"),
        ((TIME_S[:1], FORCE[:1]), r"time_s has shape \(1,\)"),
        ((["now", "then"], FORCE[:2]), "time_s is no array of numbers .* give a numpy array"),
        ((TIME_S * 1e3, FORCE), "time_s increases by 10 from sample to sample .* convert milliseconds"),
        ((TIME_S * 1e-6, FORCE), "no sampling interval in seconds"),
        ((TIME_S[::-1], FORCE), r"time_s\[1\] = 1.980000 s does not come after time_s\[0\] = 1.990000 s: sort"),
        ((np.repeat(TIME_S[: N // 2], 2), FORCE), r"time_s\[1\] = 0.000000 s does not come after"),
        ((np.where(TIME_S == 0.5, np.nan, TIME_S), FORCE), r"time_s\[50\] is nan"),
        ((TIME_S, FORCE[1:]), r"specific_force_mps2 has shape \(199, 3\): with 200 times .* \(200, 3\)$"),
        ((TIME_S, FORCE.T), "transpose it"),
        ((TIME_S, FORCE / 9.81), r"median norm of 1, .* multiply values in g by 9.80665"),
        ((TIME_S, 0.2 * RATE), "median norm of 0.0346.* without gravity cannot be used"),
        ((TIME_S, np.where(FORCE > 0.0, np.inf, FORCE)), r"specific_force_mps2\[0, 2\] is inf: remove"),
        ((TIME_S, FORCE, RATE[:, :2]), r"rotation_rate_radps has shape \(200, 2\)"),
        ((TIME_S, FORCE, np.rad2deg(RATE * 20.0)), "numpy.deg2rad"),
        ((TIME_S, FORCE, np.where(np.arange(N)[:, None] % 50 == 0, 60.0, RATE)), "reaches 60"),
    ],
)
def test_what_cannot_be_is_refused(arguments: tuple[np.ndarray, ...], words: str) -> None:
    with pytest.raises(RecordingError, match=words):
        pdr_est.Recording.from_arrays(*arguments)


def test_attitudes_are_unit_quaternions() -> None:
    attitude = np.tile([1.0, 0.0, 0.0, 0.0], (N, 1))
    attitude[7] *= 2.0
    with pytest.raises(RecordingError, match=re.escape("attitude[7] has norm 2: give unit quaternions, w first")):
        pdr_est.Recording.from_arrays(TIME_S, FORCE, attitude=attitude)
    with pytest.raises(RecordingError, match=re.escape("must have shape (200, 4)")):
        pdr_est.Recording.from_arrays(TIME_S, FORCE, attitude=attitude[:, :3])


def test_one_damaged_sample_does_not_make_degrees() -> None:
    rate = np.full((2000, 3), 0.1)
    rate[3] = 500.0
    times = np.arange(2000) / 100.0
    assert len(pdr_est.Recording.from_arrays(times, np.tile(FORCE[0], (2000, 1)), rate).devices) == 1
