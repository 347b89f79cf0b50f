"""Attitude: the vertical of a phone at rest, turns about it, and agreement of the two sources."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from signals import RATE_HZ, corner_walk, imu, joined, levels_of, run, still_force

from pdr_est.config import Config
from pdr_est.errors import RecordingError
from pdr_est.frames import STANDARD_GRAVITY_MPS2, Array, wrap_angle
from pdr_est.front_end.attitude import AccelerometerTilt, AttitudeParams, DeviceAttitude, VqfAttitude
from pdr_est.simulate import NO_SENSOR_ERRORS, SensorParams, SimulatedWalk
from pdr_est.types.sensors import Hole, LevelBlock
from pdr_est.types.steps import CarryingMode

ALONG_THE_AXES = [sign * axis for axis in np.eye(3) for sign in (1.0, -1.0)]
ANYHOW = list(Rotation.random(8, random_state=4).apply([0.0, 0.0, 1.0]))
TILTED = [np.array([0.0, np.sin(tilt), np.cos(tilt)]) for tilt in (0.0, 0.6, 1.2, np.pi / 2)]


def vqf() -> VqfAttitude:
    return VqfAttitude(RATE_HZ, AttitudeParams())


def angle_between(a: Array, b: Array) -> Array:
    """Angles between unit vectors (n, 3), also where they are tiny."""
    return 2.0 * np.arcsin(np.clip(0.5 * np.linalg.norm(a - b, axis=-1), 0.0, 1.0))


@pytest.mark.parametrize("up", ALONG_THE_AXES + ANYHOW)
def test_a_phone_at_rest_shows_the_vertical_from_the_first_sample(up: Array) -> None:
    (block,) = run(vqf(), [imu(still_force(up, 200), np.zeros((200, 3)))])
    np.testing.assert_allclose(block.up[0], up, atol=1e-9)
    np.testing.assert_allclose(block.up, np.tile(up, (200, 1)), atol=2e-4)
    np.testing.assert_allclose(block.vertical_mps2, 0.0, atol=1e-6)
    np.testing.assert_allclose(block.acceleration_mps2, 0.0, atol=2e-3)
    np.testing.assert_allclose(block.turn_rate_radps, 0.0, atol=1e-12)
    assert (block.mode == CarryingMode.UNKNOWN).all()


@pytest.mark.parametrize("turn_deg", [90.0, -90.0, 170.0])
@pytest.mark.parametrize("up", TILTED)
def test_a_turn_to_the_left_raises_the_yaw_however_the_phone_is_tilted(up: Array, turn_deg: float) -> None:
    turning = np.zeros(300)
    turning[100:200] = np.deg2rad(turn_deg) / 2.0  # rad/s for two seconds
    (block,) = run(vqf(), [imu(still_force(up, 300), turning[:, None] * up)])
    turned = wrap_angle(block.yaw_rad[-1] - block.yaw_rad[0])
    assert np.rad2deg(turned) == pytest.approx(turn_deg, abs=0.5)
    np.testing.assert_allclose(block.turn_rate_radps, turning, atol=0.01)
    np.testing.assert_allclose(block.up, np.tile(up, (300, 1)), atol=1e-3)


def test_rocking_about_a_level_axis_leaves_the_yaw_alone() -> None:
    angle = 0.3 * np.sin(2.0 * np.pi * np.arange(500) / RATE_HZ)
    rate = np.gradient(angle, 1.0 / RATE_HZ)[:, None] * np.array([1.0, 0.0, 0.0])
    up = np.stack([0.0 * angle, np.sin(angle), np.cos(angle)], axis=1)
    (block,) = run(vqf(), [imu(STANDARD_GRAVITY_MPS2 * up, rate)])
    assert np.abs(wrap_angle(block.yaw_rad - block.yaw_rad[0])).max() < np.deg2rad(0.1)
    assert angle_between(block.up, up).max() < np.deg2rad(2.0)


def test_the_acceleration_upwards_is_what_exceeds_gravity() -> None:
    quaternion = np.tile([np.cos(0.3), np.sin(0.3), 0.0, 0.0], (4, 1))  # pitched up by 0.6 rad
    up = np.array([0.0, np.sin(0.6), np.cos(0.6)])
    bounce = np.array([0.0, 1.5, -2.0, 0.25])
    force = (STANDARD_GRAVITY_MPS2 + bounce)[:, None] * up
    (block,) = DeviceAttitude().push(imu(force, np.tile(0.5 * up, (4, 1)), attitude=quaternion))
    np.testing.assert_allclose(block.vertical_mps2, bounce, atol=1e-12)
    np.testing.assert_allclose(block.acceleration_mps2, bounce[:, None] * up, atol=1e-12)
    np.testing.assert_allclose(block.turn_rate_radps, 0.5, atol=1e-12)


def test_the_devices_attitude_is_taken_as_it_is() -> None:
    rotation = Rotation.from_euler("ZX", np.stack([np.linspace(-3.0, 3.0, 50), np.full(50, 0.7)], axis=1))
    quaternion = rotation.as_quat(scalar_first=True)
    (block,) = DeviceAttitude().push(imu(np.zeros((50, 3)), np.zeros((50, 3)), attitude=quaternion))
    np.testing.assert_allclose(block.yaw_rad, np.linspace(-3.0, 3.0, 50), atol=1e-12)
    np.testing.assert_allclose(block.up, rotation.inv().apply([0.0, 0.0, 1.0]), atol=1e-12)


def test_the_turn_rate_is_without_the_bias_that_standing_still_shows() -> None:
    up = np.array([0.0, 0.6, 0.8])
    bias = np.tile([0.004, -0.006, 0.008], (1000, 1))
    (block,) = run(vqf(), [imu(still_force(up, 1000), bias)])
    assert block.turn_rate_radps[0] == pytest.approx(0.0028, abs=1e-4)
    assert np.abs(block.turn_rate_radps[-250:]).max() < 2e-4


def test_a_missing_attitude_of_the_device_names_the_remedy() -> None:
    with pytest.raises(RecordingError, match="no attitude of the device: use attitude source vqf"):
        DeviceAttitude().push(imu(np.zeros((1, 3)), np.zeros((1, 3))))


def test_a_segment_starts_the_filter_anew() -> None:
    rng = np.random.default_rng(5)
    rate = rng.standard_normal((100, 3))
    before = imu(still_force(np.array([1.0, 0.0, 0.0]), 100), rate)
    after = imu(still_force(np.array([0.0, 0.6, 0.8]), 100), rate, segment=1, first_index=250)
    stage = vqf()
    stage.push(before)
    (continued,), (fresh,) = stage.push(after), vqf().push(after)
    for name in ("up", "yaw_rad", "vertical_mps2", "turn_rate_radps"):
        np.testing.assert_array_equal(getattr(continued, name), getattr(fresh, name))
    assert (continued.segment, continued.first_index) == (1, 250)


def tilt() -> AccelerometerTilt:
    return AccelerometerTilt(RATE_HZ, AttitudeParams())


@pytest.mark.parametrize("up", ALONG_THE_AXES + ANYHOW)
def test_an_accelerometer_at_rest_shows_the_vertical_and_nothing_of_turns(up: Array) -> None:
    (block,) = run(tilt(), [imu(still_force(up, 50), None)])
    np.testing.assert_allclose(block.up, np.tile(up, (50, 1)), atol=1e-9)
    np.testing.assert_allclose(block.acceleration_mps2, 0.0, atol=1e-7)
    np.testing.assert_allclose(block.vertical_mps2, 0.0, atol=1e-7)
    for name in ("yaw_rad", "rotation_rate_radps", "turn_rate_radps"):
        assert np.isnan(getattr(block, name)).all(), name
    assert block.rotation_rate_radps.shape == (50, 3)
    assert (block.mode == CarryingMode.UNKNOWN).all()
    assert (block.mode_probability == 0.0).all()


def test_bounces_leave_the_vertical_of_an_accelerometer_alone_and_are_seen_in_full() -> None:
    up = np.array([0.6, 0.0, 0.8])
    bounce = 3.0 * np.sin(2.0 * np.pi * 1.8 * np.arange(500) / RATE_HZ)
    (block,) = run(tilt(), [imu((STANDARD_GRAVITY_MPS2 + bounce)[:, None] * up, None)])
    np.testing.assert_allclose(block.up, np.tile(up, (500, 1)), atol=1e-9)
    np.testing.assert_allclose(block.vertical_mps2, bounce, atol=1e-9)


def test_a_phone_that_turns_over_feels_no_vertical_acceleration() -> None:
    """The low-passed vertical needs seconds to follow; the length of the specific force does not care."""
    angle = np.clip(np.arange(400) / RATE_HZ - 2.0, 0.0, 1.0) * np.pi / 2.0
    true_up = np.stack([np.sin(angle), 0.0 * angle, np.cos(angle)], axis=1)
    (block,) = run(tilt(), [imu(STANDARD_GRAVITY_MPS2 * true_up, None)])
    off_rad = angle_between(block.up, true_up)
    assert np.rad2deg(off_rad.max()) > 30.0
    assert np.rad2deg(off_rad[-1]) < 1.0
    np.testing.assert_allclose(block.vertical_mps2, 0.0, atol=1e-9)


def test_free_fall_has_no_vertical_and_a_segment_starts_the_tilt_anew() -> None:
    stage = tilt()
    (falling,) = stage.push(imu(np.zeros((20, 3)), None))
    np.testing.assert_array_equal(falling.up, 0.0)
    np.testing.assert_allclose(falling.vertical_mps2, -STANDARD_GRAVITY_MPS2)
    after = imu(still_force(np.array([0.0, 0.6, 0.8]), 10), None, segment=1, first_index=100)
    (block,) = stage.push(after)
    np.testing.assert_allclose(block.up, np.tile([0.0, 0.6, 0.8], (10, 1)), atol=1e-9)
    assert (block.segment, block.first_index) == (1, 100)


@pytest.mark.parametrize("stage", [vqf(), DeviceAttitude()], ids=["vqf", "device"])
def test_other_sources_name_the_missing_gyroscope(stage: VqfAttitude | DeviceAttitude) -> None:
    flat = np.tile([1.0, 0.0, 0.0, 0.0], (5, 1))
    with pytest.raises(RecordingError, match="no gyroscope: only AccelerometerTilt does without it"):
        stage.push(imu(np.ones((5, 3)), None, attitude=flat))


STEADY_CLOCK = SensorParams(time_jitter_s=0.0, record_attitude=True)  # one grid, whichever channels are used


def both_ways(walk: SimulatedWalk) -> tuple[list[LevelBlock], list[LevelBlock]]:
    by_vqf = levels_of(walk)
    by_device = levels_of(walk, Config(attitude=AttitudeParams(source="device")))
    np.testing.assert_array_equal(joined(by_vqf, "time_s"), joined(by_device, "time_s"))
    return by_vqf, by_device


@pytest.mark.parametrize("rate_hz", [25.0, 50.0, 100.0, 500.0])
def test_both_sources_agree_on_a_walk_at_any_rate_of_input(rate_hz: float) -> None:
    """The simulated attitude of the device is exact, so this bounds the error of VQF: 2.5 deg of tilt, 1.5 of yaw."""
    sensors = replace(STEADY_CLOCK, rate_hz=rate_hz, accelerometer=NO_SENSOR_ERRORS, gyroscope=NO_SENSOR_ERRORS)
    by_vqf, by_device = both_ways(corner_walk(sensors=sensors))
    tilt = angle_between(joined(by_vqf, "up"), joined(by_device, "up"))
    assert np.rad2deg(tilt.max()) < 2.5
    yaw = wrap_angle(joined(by_vqf, "yaw_rad") - joined(by_device, "yaw_rad"))
    assert np.rad2deg(np.abs(wrap_angle(yaw - yaw[0])).max()) < 1.5
    difference = joined(by_vqf, "vertical_mps2") - joined(by_device, "vertical_mps2")
    assert np.sqrt(np.mean(difference**2)) < 0.05


@pytest.mark.parametrize("seed", range(3))
def test_noise_and_bias_of_an_ordinary_phone_cost_few_degrees(seed: int) -> None:
    """The bias of 0.3 deg/s alone would turn the yaw by 9 deg in this walk; standing still takes most of it away."""
    by_vqf, by_device = both_ways(corner_walk(sensors=STEADY_CLOCK, seed=seed))
    yaw = wrap_angle(joined(by_vqf, "yaw_rad") - joined(by_device, "yaw_rad"))
    assert np.rad2deg(np.abs(wrap_angle(yaw - yaw[0])).max()) < 4.0
    tilt = angle_between(joined(by_vqf, "up"), joined(by_device, "up"))
    assert np.rad2deg(tilt.max()) < 3.0


def test_the_yaw_follows_the_walker_around_the_corner() -> None:
    walk = corner_walk(sensors=STEADY_CLOCK)
    for blocks in both_ways(walk):
        yaw, time_s = joined(blocks, "yaw_rad"), joined(blocks, "time_s")
        first, last = (float(np.mean(yaw[(time_s > a) & (time_s < a + 1.0)])) for a in (1.0, walk.steps.end_s - 1.5))
        assert np.rad2deg(wrap_angle(last - first)) == pytest.approx(90.0, abs=6.0)


@pytest.mark.parametrize(
    ("gap_s", "most_deg"),
    [((3.0, 3.8), 15.0), ((9.5, 11.0), 6.0), ((8.6, 11.6), 6.0)],
    ids=["walks", "short", "long"],
)
def test_the_yaw_goes_on_over_a_gap(gap_s: tuple[float, float], most_deg: float) -> None:
    """Walking, and standing; the yaw by the device knows what happened in the gap."""
    by_vqf, by_device = both_ways(corner_walk(sensors=replace(STEADY_CLOCK, gaps_s=(gap_s,))))
    (resumed,) = (block for block in by_vqf if block.hole is not None)
    assert (resumed.hole.start_s, resumed.hole.end_s) == pytest.approx(gap_s, abs=0.05)
    yaw = np.unwrap(wrap_angle(joined(by_vqf, "yaw_rad") - joined(by_device, "yaw_rad")))
    after = joined(by_vqf, "time_s") > gap_s[1]
    change = np.mean(yaw[after][:50]) - np.mean(yaw[~after][-50:])
    assert np.rad2deg(np.abs(change)) < most_deg


def test_the_bias_of_the_gyroscope_is_kept_over_a_gap() -> None:
    bias = np.array([0.004, -0.003, 0.005])
    stage = vqf()
    still = imu(still_force(np.array([0.0, 0.0, 1.0]), 1500), np.tile(bias, (1500, 1)))
    later = imu(still_force(np.array([0.0, 0.6, 0.8]), 200), np.tile(bias, (200, 1)), segment=1, first_index=5000)
    stage.push(still)
    (block,) = stage.push(replace(later, hole=Hole(30.0, 100.0)))
    np.testing.assert_allclose(block.rotation_rate_radps[0], 0.0, atol=1e-4)
