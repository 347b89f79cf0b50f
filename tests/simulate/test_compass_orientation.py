"""The attitude of a phone without gyroscope, by accelerometer and magnetometer."""

from dataclasses import replace

import numpy as np
import pytest

from pdr_est.errors import RecordingError
from pdr_est.frames import twist_about_vertical, up_in_device, wrap_angle
from pdr_est.simulate import (
    NO_SENSOR_ERRORS,
    DeviceParams,
    EarthField,
    HeldPhone,
    PathParams,
    Scenario,
    SensorParams,
    SimulatedWalk,
    simulate_walk,
    with_compass_orientation,
)
from pdr_est.types.sensors import AttitudeReference

STILL = HeldPhone(rock_pitch_rad=0.0, rock_yaw_rad=0.0, rock_roll_rad=0.0, wander_rad=0.0, tremor_rad=0.0)
SENSORS = SensorParams(accelerometer=NO_SENSOR_ERRORS, magnetometer=NO_SENSOR_ERRORS, time_jitter_s=0.0)
PATH = PathParams(vertices_m=((0.0, 0.0), (15.0, 0.0), (15.0, 15.0)))
NORTH_UP = EarthField(declination_rad=0.0)


def walked() -> SimulatedWalk:
    device = DeviceParams(carry=STILL, sensors=SENSORS)
    return simulate_walk(Scenario(path=PATH, devices=(device,), earth=NORTH_UP, seed=1))


def test_it_is_the_true_attitude_but_for_the_acceleration_and_the_delay() -> None:
    walk = walked()
    (device,) = with_compass_orientation(walk.recording).devices
    assert device.attitude is not None
    assert device.attitude_reference is AttitudeReference.MAGNETIC_NORTH
    true = walk.devices[0].motion.quaternion
    np.testing.assert_allclose(np.linalg.norm(device.attitude.values, axis=1), 1.0)
    tilt = np.arccos(np.clip(np.sum(up_in_device(device.attitude.values) * up_in_device(true), axis=1), -1.0, 1.0))
    assert np.rad2deg(np.median(tilt)) < 2.0
    off = wrap_angle(twist_about_vertical(device.attitude.values) - twist_about_vertical(true))
    assert np.rad2deg(np.median(np.abs(off))) < 3.0
    assert np.rad2deg(np.abs(off)).max() > 10.0  # in the turn: a low-pass at 0.3 Hz comes late


def test_a_device_without_magnetometer_is_refused() -> None:
    recording = walked().recording
    bare = replace(recording, devices=(replace(recording.devices[0], magnetic_field=None),))
    with pytest.raises(RecordingError, match="device: no magnetometer, so there is no compass orientation"):
        with_compass_orientation(bare)
