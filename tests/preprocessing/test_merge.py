"""Recordings of several devices as one."""

from dataclasses import replace

import numpy as np
import pytest

from pdr_est.errors import RecordingError
from pdr_est.preprocessing.merge import merge_recordings
from pdr_est.types.recording import DeviceRecording, Recording, Signal


def recording(name: str, value: float = 1.0, epoch_s: float | None = None, devices: int = 1) -> Recording:
    signal = Signal(np.arange(5.0), np.full((5, 3), value))
    own = tuple(DeviceRecording(name=f"phone{k}" if k else "device", specific_force=signal) for k in range(devices))
    return Recording(name=name, format="test", devices=own, epoch_s=epoch_s)


def test_devices_of_one_name_get_that_of_their_recording() -> None:
    both = merge_recordings([recording("a"), recording("b", 2.0)])
    assert [device.name for device in both.devices] == ["a", "b"]
    assert both.name == "a + b"


def test_dates_put_the_second_recording_where_it_began() -> None:
    both = merge_recordings([recording("a", epoch_s=1000.0), recording("b", 2.0, epoch_s=1030.0)])
    moved = both.devices[1].specific_force
    assert moved is not None
    np.testing.assert_allclose(moved.time_s, 30.0 + np.arange(5.0))


def local(name: str, value: float, local_epoch_s: float) -> Recording:
    return replace(recording(name, value), local_epoch_s=local_epoch_s)


@pytest.mark.parametrize(
    ("first_s", "second_s", "later_s"),
    [(1.9e9, 1.9e9 + 30.0, 30.0), (86_390.0, 20.0, 30.0), (1.9e9, 1.9e9 % 86_400.0 - 7.0, -7.0)],
    ids=["dates", "times of day over midnight", "a date and a time of day"],
)
def test_dates_without_a_time_zone_are_those_of_one(first_s: float, second_s: float, later_s: float) -> None:
    both = merge_recordings([local("a", 1.0, first_s), local("b", 2.0, second_s)])
    moved = both.devices[1].specific_force
    assert moved is not None
    np.testing.assert_allclose(moved.time_s, later_s + np.arange(5.0))
    assert any("are taken to be of the same" in note for note in both.notes)


def test_a_date_without_a_time_zone_is_not_compared_with_unix_time() -> None:
    both = merge_recordings([recording("a", epoch_s=1.9e9), local("b", 2.0, 1.9e9 + 30.0)])
    kept = both.devices[1].specific_force
    assert kept is not None
    np.testing.assert_allclose(kept.time_s, np.arange(5.0))
    assert any("not compared with that of b" in note for note in both.notes)


def test_without_dates_times_stay_as_they_are() -> None:
    both = merge_recordings([recording("a", epoch_s=1000.0), recording("b", 2.0)])
    kept = both.devices[1].specific_force
    assert kept is not None
    np.testing.assert_allclose(kept.time_s, np.arange(5.0))


def test_so_does_one_without_gravity() -> None:
    one = recording("walk")
    linear = replace(one.devices[0], specific_force=None, linear_acceleration=one.devices[0].specific_force)
    one = replace(one, devices=(linear,))
    assert merge_recordings([one, replace(one)]).devices is one.devices


def test_a_recording_that_is_given_twice_counts_once() -> None:
    one = recording("walk", devices=2)
    once = merge_recordings([one, replace(one)])
    assert once.devices is one.devices
    assert once.notes == ("walk: given more than once with the same samples, and used once",)


def test_recordings_that_cannot_be_told_apart_are_refused() -> None:
    with pytest.raises(RecordingError, match="share the name of recording and device"):
        merge_recordings([recording("a"), recording("a", 2.0)])
