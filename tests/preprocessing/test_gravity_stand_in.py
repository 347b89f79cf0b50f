"""Steps are counted from an acceleration without gravity; a track is refused, with what to do about it."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from pdr_est import pipeline
from pdr_est.config import Config
from pdr_est.errors import RecordingError
from pdr_est.frames import STANDARD_GRAVITY_MPS2, up_in_device
from pdr_est.pipeline.warnings import warnings_of
from pdr_est.preprocessing.gravity_stand_in import needs_stand_in, with_stand_in_gravity
from pdr_est.simulate import SimulatedWalk, preset, simulate_walk
from pdr_est.types.recording import DeviceRecording, Recording, Signal


@cache
def walked(name: str = "l_shape") -> SimulatedWalk:
    return simulate_walk(preset(name))


def without_gravity(name: str = "l_shape", warnings: tuple[str, ...] = ()) -> Recording:
    walk = walked(name)
    device, motion = walk.recording.devices[0], walk.devices[0].motion
    force = device.specific_force
    assert force is not None
    up = up_in_device(motion.quaternion)
    vertical = np.stack([np.interp(force.time_s, motion.time_s, column) for column in up.T], axis=1)
    linear = Signal(force.time_s, force.values - STANDARD_GRAVITY_MPS2 * vertical)
    bare = replace(device, specific_force=None, linear_acceleration=linear, warnings=warnings)
    return replace(walk.recording, devices=(bare,))


@pytest.mark.parametrize("name", ["l_shape", "office_loop", "mmpdr_indoor_holding"])
def test_steps_are_counted_with_a_warning_and_without_heading(name: str) -> None:
    recording = without_gravity(name)
    (walk,) = pipeline.analyse_recording(recording, Config())
    assert len(walk.steps) == pytest.approx(walked(name).step_count, abs=0.06 * walked(name).step_count)
    assert not walk.has_heading
    assert any("without gravity" in warning for warning in warnings_of(recording, [walk]))


def test_a_track_is_refused_with_the_advice_of_the_reader() -> None:
    with pytest.raises(RecordingError, match=r"without gravity, so no track is possible.*gravity besides$"):
        pipeline.smooth_recording(without_gravity(), Config())
    told = without_gravity(warnings=("Accelerometer is without gravity: switch on Gravity", "something else"))
    with pytest.raises(
        RecordingError, match=r"`pdr-est steps`: Accelerometer is without gravity: switch on Gravity$"
    ):
        pipeline.smooth_recording(told, Config())


def test_gravity_stands_along_the_vertical_motion() -> None:
    time_s = np.arange(0.0, 20.0, 0.01)
    axis = np.array([0.6, 0.0, 0.8])
    bounce = 2.0 * np.sin(3.6 * np.pi * time_s) + 0.5 * np.cos(7.2 * np.pi * time_s)
    swing = 2.0 * np.sin(1.8 * np.pi * time_s)
    values = bounce[:, None] * axis + swing[:, None] * np.array([0.0, 1.0, 0.0])
    device = with_stand_in_gravity(DeviceRecording(linear_acceleration=Signal(time_s, values)))
    assert device.specific_force is not None
    gravity = device.specific_force.values - values
    np.testing.assert_allclose(np.linalg.norm(gravity, axis=1), STANDARD_GRAVITY_MPS2)
    assert (np.abs(gravity @ axis) > 0.95 * STANDARD_GRAVITY_MPS2).all()
    assert device.linear_acceleration is None


def test_only_a_device_without_any_gravity_needs_it() -> None:
    device = without_gravity().devices[0]
    full = walked().recording.devices[0]
    assert needs_stand_in(device)
    assert not needs_stand_in(full)
    assert not needs_stand_in(replace(full, linear_acceleration=device.linear_acceleration))
    assert not needs_stand_in(DeviceRecording())
    assert with_stand_in_gravity(full) is full


def test_damaged_samples_and_few_of_them_do_no_harm() -> None:
    linear = without_gravity().devices[0].linear_acceleration
    assert linear is not None
    values = linear.values.copy()
    values[17] = np.nan
    force = with_stand_in_gravity(DeviceRecording(linear_acceleration=Signal(linear.time_s, values))).specific_force
    assert force is not None
    assert np.isfinite(np.delete(force.values, 17, axis=0)).all()
    few = Signal(linear.time_s[:3], linear.values[:3])
    assert len(with_stand_in_gravity(DeviceRecording(linear_acceleration=few)).specific_force or ()) == 3
