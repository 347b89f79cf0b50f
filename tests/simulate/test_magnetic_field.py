"""The magnetic field: of the Earth, of iron beside the path, and as a phone records it."""

from dataclasses import replace

import numpy as np
import pytest

from pdr_est.simulate import (
    NO_SENSOR_ERRORS,
    PHONE_MAGNETOMETER,
    DeviceParams,
    EarthField,
    MagneticDipole,
    PathParams,
    PocketPhone,
    Scenario,
    SensorErrors,
    SensorParams,
    SimulatedWalk,
    WalkingPath,
    simulate_walk,
)
from pdr_est.simulate.sensors.magnetic_field import magnetic_field_ut

LINE = PathParams(vertices_m=((0.0, 0.0), (20.0, 0.0)))


def walked(magnetometer: SensorErrors, *irons: MagneticDipole) -> SimulatedWalk:
    sensors = SensorParams(magnetometer=magnetometer, time_jitter_s=0.0)
    return simulate_walk(
        Scenario(path=LINE, devices=(DeviceParams(carry=PocketPhone(), sensors=sensors),), irons=irons)
    )


def test_the_field_of_the_earth_has_its_strength_dip_and_declination() -> None:
    east, north, up = EarthField(strength_ut=50.0, inclination_rad=1.1, declination_rad=0.2).vector_ut
    assert np.hypot(np.hypot(east, north), up) == pytest.approx(50.0)
    assert np.arctan2(-up, np.hypot(east, north)) == pytest.approx(1.1)  # dips down in the north
    assert np.arctan2(east, north) == pytest.approx(0.2)  # clockwise from north


def test_a_perfect_magnetometer_sees_the_earth_in_device_axes() -> None:
    walk = walked(NO_SENSOR_ERRORS)
    recorded = walk.recording.devices[0].magnetic_field
    assert recorded is not None
    np.testing.assert_allclose(np.linalg.norm(recorded.values, axis=1), 49.0)
    np.testing.assert_allclose(recorded.values, walk.devices[0].motion.in_device(EarthField().vector_ut), atol=1e-12)


def test_hard_iron_is_the_bias_of_the_magnetometer() -> None:
    walk = walked(replace(PHONE_MAGNETOMETER, noise_std=0.0, scale_std=0.0))
    device, recorded = walk.devices[0], walk.recording.devices[0].magnetic_field
    assert device.magnetometer is not None
    assert recorded is not None
    assert np.linalg.norm(device.magnetometer.bias) > 5.0
    np.testing.assert_allclose(np.linalg.norm(recorded.values - device.magnetometer.bias, axis=1), 49.0)


def test_iron_disturbs_the_field_beside_it_only() -> None:
    walk = walked(NO_SENSOR_ERRORS, MagneticDipole(at_m=10.0, left_m=1.0))
    recorded = walk.recording.devices[0].magnetic_field
    assert recorded is not None
    strength = np.linalg.norm(recorded.values, axis=1)
    along_m = walk.position_at(recorded.time_s)[:, 0]
    assert np.abs(strength - 49.0)[np.abs(along_m - 10.0) < 1.0].max() > 3.0
    assert np.abs(strength - 49.0)[np.abs(along_m - 10.0) > 8.0].max() < 0.1


def test_the_field_of_iron_has_neither_sources_nor_curl() -> None:
    iron, h = MagneticDipole(at_m=3.0, moment_am2=(50.0, -20.0, 100.0)), 1e-4
    point = np.array([4.0, 0.3, 0.2])
    steps = np.concatenate([point + h * np.eye(3), point - h * np.eye(3)])
    field = magnetic_field_ut(steps, EarthField(), (iron,), WalkingPath(LINE))
    slope = (field[:3] - field[3:]) / (2.0 * h)  # [direction, component]
    assert np.trace(slope) == pytest.approx(0.0, abs=1e-5)
    np.testing.assert_allclose(slope, slope.T, atol=1e-5)
    assert np.abs(slope).max() > 0.5


def test_a_phone_without_a_magnetometer_records_no_field_and_the_same_otherwise() -> None:
    plain = simulate_walk(Scenario(path=LINE))
    fitted = simulate_walk(
        Scenario(path=LINE, devices=(DeviceParams(sensors=SensorParams(magnetometer=PHONE_MAGNETOMETER)),))
    )
    assert plain.recording.devices[0].magnetic_field is None
    one, other = plain.recording.devices[0].specific_force, fitted.recording.devices[0].specific_force
    assert one is not None
    assert other is not None
    np.testing.assert_array_equal(one.values, other.values)
