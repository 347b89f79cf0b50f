"""Turned device axes: gravity and rotation move together, and the attitude still points where it did."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from pdr_est.errors import ConfigError
from pdr_est.frames import up_in_device
from pdr_est.preprocessing.turned_device import rotation_named, turn_devices
from pdr_est.simulate import preset, simulate_walk
from pdr_est.types.recording import Recording, Signal


@cache
def walked() -> Recording:
    return simulate_walk(preset("l_shape")).recording


def test_a_quarter_turn_about_x_lays_y_along_z() -> None:
    np.testing.assert_allclose(rotation_named("x90").apply([0.0, 1.0, 0.0]), [0.0, 0.0, 1.0], atol=1e-12)
    np.testing.assert_allclose(rotation_named("z90").apply([1.0, 0.0, 0.0]), [0.0, 1.0, 0.0], atol=1e-12)


@pytest.mark.parametrize("name", ["x90", "x180", "z90", "random:3"])
def test_all_signals_turn_together(name: str) -> None:
    device = walked().devices[0]
    recording = replace(walked(), devices=(replace(device, linear_acceleration=device.specific_force),))
    (before,), (after,) = recording.devices, turn_devices(recording, rotation_named(name)).devices
    for signal in ("specific_force", "linear_acceleration", "rotation_rate"):
        old, new = getattr(before, signal), getattr(after, signal)
        np.testing.assert_array_equal(new.time_s, old.time_s)
        np.testing.assert_allclose(np.linalg.norm(new.values, axis=1), np.linalg.norm(old.values, axis=1))
    assert before.specific_force is not None
    assert after.specific_force is not None
    assert not np.allclose(after.specific_force.values, before.specific_force.values)


@pytest.mark.parametrize("name", ["x90", "random:3"])
def test_up_by_the_attitude_turns_with_the_axes(name: str) -> None:
    attitude = Rotation.random(50, random_state=1).as_quat()[:, [3, 0, 1, 2]]
    unusable = attitude.copy()
    unusable[7] = np.nan
    device = replace(walked().devices[0], attitude=Signal(np.arange(50) / 50.0, unusable))
    turned = turn_devices(replace(walked(), devices=(device,)), rotation_named(name)).devices[0].attitude
    assert turned is not None
    kept = np.arange(50) != 7
    expected = rotation_named(name).apply(up_in_device(attitude[kept]))
    np.testing.assert_allclose(up_in_device(turned.values[kept]), expected, atol=1e-9)
    assert np.isnan(turned.values[7]).all()


def test_a_turn_and_its_opposite_leave_the_recording() -> None:
    rotation = rotation_named("random:5")
    back = turn_devices(turn_devices(walked(), rotation), rotation.inv()).devices[0]
    assert back.specific_force is not None
    np.testing.assert_allclose(back.specific_force.values, walked().devices[0].specific_force.values, atol=1e-9)


@pytest.mark.parametrize("name", ["w90", "x", "random", "random:-1", "upside down"])
def test_unknown_turns_are_refused(name: str) -> None:
    with pytest.raises(ConfigError, match="is unknown: give x90, x180, z90"):
        rotation_named(name)


@pytest.mark.parametrize("name", ["x-999", "y361", "z\u0669\u0660", "random:\u0663"])
def test_turns_beyond_a_circle_and_digits_of_other_scripts_are_refused(name: str) -> None:
    with pytest.raises(ConfigError, match="axis and degrees from -360 to 360"):
        rotation_named(name)
