"""The compass heading of a step: exact against the truth, and what becomes of it where the field is not there."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation
from signals import corner_walk, run, step

from pdr_est.config import Config
from pdr_est.errors import RecordingError
from pdr_est.frames import Array, twist_about_vertical, up_in_device, wrap_angle
from pdr_est.front_end.heading import HeadingParams, heading_stage
from pdr_est.front_end.heading.magnetometer import MagnetometerHeading, magnetic_yaw
from pdr_est.pipeline import analyse_recording
from pdr_est.simulate import NO_SENSOR_ERRORS, PHONE_MAGNETOMETER, EarthField, SensorParams, simulate_walk
from pdr_est.types.steps import Step

CONFIG = Config(heading=HeadingParams(method="magnetometer"))
EARTH = EarthField()


def step_in(quaternion: Array, magnetic_field_ut: Array | None, yaw_rad: float = 0.0, time_s: float = 1.0) -> Step:
    """A step of a device with attitudes (n, 4), w first, in a field (3,) east, north, up; None: not recorded."""
    one = step(time_s, time_s - 0.5, vertical_mps2=np.zeros(len(quaternion)), heading_rad=yaw_rad)
    field = np.full((len(quaternion), 3), np.nan)
    if magnetic_field_ut is not None:
        field = Rotation.from_quat(quaternion, scalar_first=True).inv().apply(magnetic_field_ut)
    samples = replace(one.samples, up=up_in_device(quaternion), magnetic_field_ut=field)
    return replace(one, samples=samples, heading_rad=float("nan"))


def turned(*yaw_deg: float) -> Array:
    """Attitudes of a device that lies flat."""
    half = np.deg2rad(yaw_deg) / 2.0
    return np.stack([np.cos(half), 0.0 * half, 0.0 * half, np.sin(half)], axis=1)


@given(st.lists(st.floats(-1.0, 1.0), min_size=4, max_size=4).filter(lambda q: np.hypot(q[0], q[3]) > 0.1))
def test_it_is_the_yaw_of_the_attitude_against_magnetic_north(raw: list[float]) -> None:
    quaternion = np.array([raw]) / np.linalg.norm(raw)
    found = magnetic_yaw(step_in(quaternion, EARTH.vector_ut).samples)
    expected = twist_about_vertical(quaternion) + EARTH.declination_rad
    np.testing.assert_allclose(wrap_angle(found - expected), 0.0, atol=1e-9)


def test_the_heading_is_the_mean_direction_over_the_step() -> None:
    north_ut = np.array([0.0, 20.0, -40.0])
    (found,) = MagnetometerHeading().push(step_in(turned(170.0, -170.0, 180.0), north_ut))
    assert abs(np.rad2deg(found.heading_rad)) == pytest.approx(180.0)
    assert found.sigma_turn_rad == 0.0


def test_a_vertical_field_tells_nothing() -> None:
    (found,) = MagnetometerHeading().push(step_in(turned(30.0, 30.0), np.array([0.0, 0.0, -45.0]), yaw_rad=0.7))
    assert found.heading_rad == pytest.approx(0.7)


def test_without_field_it_goes_on_by_the_devices_own_yaw() -> None:
    stage = MagnetometerHeading()
    north_ut = np.array([0.0, 20.0, -40.0])
    steps = [
        step_in(turned(30.0), None, yaw_rad=0.1, time_s=1.0),
        step_in(turned(40.0), north_ut, yaw_rad=0.2, time_s=1.5),
        step_in(turned(60.0), None, yaw_rad=0.5, time_s=2.0),
        step_in(turned(70.0), north_ut, yaw_rad=0.6, time_s=2.5),
    ]
    found = run(stage, steps)
    expected = [0.1, np.deg2rad(40.0), np.deg2rad(40.0) + 0.3, np.deg2rad(70.0)]
    np.testing.assert_allclose([one.heading_rad for one in found], expected, atol=1e-12)
    # only the change from an arbitrary zero to the compass may be any
    assert [one.sigma_turn_rad > 1.0 for one in found] == [False, True, False, False]


def test_a_simulated_walk_has_the_true_directions() -> None:
    """A perfect compass: what is left is the rocking of the hand. The offset is that of the axes of the phone."""
    walk = corner_walk(sensors=SensorParams(magnetometer=NO_SENSOR_ERRORS))
    (device,) = analyse_recording(walk.recording, CONFIG)
    heading = np.array([one.heading_rad for one in device.steps])
    time_s = np.array([one.event.time_s for one in device.steps])
    middle_s = 0.5 * (time_s + [one.start_s for one in device.steps])
    error = wrap_angle(heading - walk.heading_at(middle_s))
    error = wrap_angle(error - error[0])
    assert np.rad2deg(np.abs(error)).max() < 8.0


def test_all_but_the_headings_is_the_same_with_a_broken_magnetometer() -> None:
    walk = corner_walk(sensors=SensorParams(magnetometer=PHONE_MAGNETOMETER))
    device = walk.recording.devices[0]
    field = device.magnetic_field
    assert field is not None
    dead = replace(field, values=np.full_like(field.values, np.nan))
    short = replace(field, time_s=field.time_s[900:1000], values=field.values[900:1000])
    plain = analyse_recording(walk.recording, Config(heading=HeadingParams(method="step-yaw")))[0]
    for broken in (dead, short):
        (found,) = analyse_recording(
            replace(walk.recording, devices=(replace(device, magnetic_field=broken),)), CONFIG
        )
        assert [one.event for one in found.steps] == [one.event for one in plain.steps]
        assert [one.length_m for one in found.steps] == [one.length_m for one in plain.steps]
        assert found.gaps == plain.gaps
        np.testing.assert_array_equal(found.level[0].yaw_rad, plain.level[0].yaw_rad[: len(found.level[0])])
        if broken is dead:  # and then the headings are the device's own, too
            np.testing.assert_array_equal(
                [one.heading_rad for one in found.steps], wrap_angle([one.heading_rad for one in plain.steps])
            )


def test_a_device_without_magnetometer_is_refused_in_words() -> None:
    walk = corner_walk()
    with pytest.raises(
        RecordingError, match=r"simulated \(device\): no magnetometer, which heading.method: magnetom"
    ):
        analyse_recording(walk.recording, CONFIG)
    with pytest.raises(RecordingError, match=r"the recording has no magnetic field: choose another heading.method"):
        MagnetometerHeading().push(step(1.0, 0.5))
    assert isinstance(heading_stage(50.0, CONFIG.heading), MagnetometerHeading)


def test_the_field_comes_only_where_it_is_asked_for() -> None:
    walk = simulate_walk(replace(corner_walk(sensors=SensorParams(magnetometer=NO_SENSOR_ERRORS)).scenario, seed=1))
    plain = Config().replace({"heading.north.source": "none"})
    assert all(block.magnetic_field_ut is None for block in analyse_recording(walk.recording, plain)[0].level)
    assert all(block.magnetic_field_ut is not None for block in analyse_recording(walk.recording, CONFIG)[0].level)
