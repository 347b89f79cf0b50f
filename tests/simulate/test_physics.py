"""The trunk and the phone move as real bodies do, and the ideal sensors agree with that motion."""

from dataclasses import replace
from operator import attrgetter

import numpy as np
import pytest
from scipy.integrate import cumulative_simpson
from scipy.signal import find_peaks, welch
from scipy.spatial.transform import Rotation

from pdr_est.frames import STANDARD_GRAVITY_MPS2, twist_about_vertical, up_in_device, wrap_angle
from pdr_est.simulate import (
    DeviceParams,
    HeldPhone,
    PathParams,
    Pause,
    Scenario,
    SensorParams,
    SimulatedWalk,
    WalkerGaitParams,
    preset,
    simulate_walk,
)
from pdr_est.simulate.motion.differentiable_signal import DifferentiableSignal
from pdr_est.simulate.motion.rigid_body import RigidMotion

RATE_HZ = 500.0
TURNS = PathParams(vertices_m=((0.0, 0.0), (8.0, 0.0), (8.0, 6.0), (14.0, 9.0)))


@pytest.fixture(scope="module")
def walk() -> SimulatedWalk:
    return simulate_walk(
        Scenario(
            path=TURNS,
            gait=WalkerGaitParams(pauses=(Pause(at_m=10.0, duration_s=2.0),)),
            devices=(DeviceParams(sensors=SensorParams(rate_hz=RATE_HZ)),),
            seed=5,
        )
    )


@pytest.fixture(scope="module")
def motion(walk: SimulatedWalk) -> RigidMotion:
    return walk.devices[0].motion


def test_integrating_the_gyroscope_gives_the_orientation(motion: RigidMotion) -> None:
    rate = motion.rotation_rate_radps
    turn = Rotation.from_rotvec(0.5 * (rate[1:] + rate[:-1]) / RATE_HZ)
    orientation = Rotation.from_quat(motion.quaternion, scalar_first=True)
    now = orientation[0]
    for step in turn:
        now = now * step
    assert (orientation[-1].inv() * now).magnitude() < 1e-4  # trapezium error at 500 Hz over 20 s
    halfway = orientation[:-1] * turn
    assert (orientation[1:].inv() * halfway).magnitude().max() < 1e-6


def test_integrating_the_specific_force_twice_gives_the_position(motion: RigidMotion) -> None:
    orientation = Rotation.from_quat(motion.quaternion, scalar_first=True)
    acceleration = orientation.apply(motion.specific_force_mps2) - [0.0, 0.0, STANDARD_GRAVITY_MPS2]
    start_velocity = [motion.east.rate[0], motion.north.rate[0], motion.up.rate[0]]
    velocity = start_velocity + cumulative_simpson(acceleration, dx=1.0 / RATE_HZ, axis=0, initial=0.0)
    position = motion.position_m[0] + cumulative_simpson(velocity, dx=1.0 / RATE_HZ, axis=0, initial=0.0)
    np.testing.assert_allclose(position, motion.position_m, atol=2e-4)


@pytest.mark.parametrize("name", ["east", "north", "up", "attitude.w", "attitude.x", "attitude.y", "attitude.z"])
def test_rates_and_accelerations_are_derivatives(motion: RigidMotion, name: str) -> None:
    signal: DifferentiableSignal = attrgetter(name)(motion)
    inner = slice(2, -2)
    rate = np.gradient(signal.value, 1.0 / RATE_HZ)
    acceleration = np.gradient(signal.rate, 1.0 / RATE_HZ)
    np.testing.assert_allclose(rate[inner], signal.rate[inner], atol=1e-3 * np.abs(signal.rate).max() + 1e-9)
    # the jerk jumps where two quintics meet, which spoils a difference over that point
    np.testing.assert_allclose(
        acceleration[inner], signal.acceleration[inner], atol=0.015 * np.abs(signal.acceleration).max()
    )


def test_the_acceleration_never_jumps(motion: RigidMotion) -> None:
    for signal in (motion.east, motion.north, motion.up):
        assert np.abs(np.diff(signal.acceleration)).max() < 0.5  # m/s^2 within 2 ms


def test_standing_the_phone_feels_gravity_only(walk: SimulatedWalk, motion: RigidMotion) -> None:
    standing = motion.time_s < walk.steps.start_s[0]
    force = motion.specific_force_mps2[standing]
    np.testing.assert_allclose(np.linalg.norm(force, axis=1), STANDARD_GRAVITY_MPS2, atol=0.5)
    along_up = (force * up_in_device(motion.quaternion[standing])).sum(axis=1)
    assert along_up.mean() == pytest.approx(STANDARD_GRAVITY_MPS2, abs=0.01)


def test_a_still_hand_points_where_it_was_told() -> None:
    still = HeldPhone(
        forward_m=0.4,
        left_m=0.1,
        tilt_rad=0.5,
        heading_offset_rad=0.2,
        rock_pitch_rad=0.0,
        rock_yaw_rad=0.0,
        rock_roll_rad=0.0,
        wander_rad=0.0,
    )
    still = replace(still, tremor_rad=0.0, tremor_m=0.0)
    walk = simulate_walk(Scenario(path=TURNS, devices=(DeviceParams(carry=still),)))
    motion = walk.devices[0].motion
    y_axis = Rotation.from_quat(motion.quaternion, scalar_first=True).apply([0.0, 1.0, 0.0])
    heading = walk.heading_at(motion.time_s)
    body = walk.body.at(motion.time_s)
    ahead = np.stack([np.cos(heading), np.sin(heading)], axis=1)
    to_left = np.stack([-np.sin(heading), np.cos(heading)], axis=1)
    from_body = motion.position_m[:, :2] - np.stack([body.east.value, body.north.value], axis=1)
    np.testing.assert_allclose((from_body * ahead).sum(axis=1), 0.4, atol=1e-12)
    np.testing.assert_allclose((from_body * to_left).sum(axis=1), 0.1, atol=1e-12)
    np.testing.assert_allclose(y_axis[:, 2], np.sin(0.5), atol=1e-12)
    np.testing.assert_allclose(wrap_angle(np.arctan2(y_axis[:, 1], y_axis[:, 0]) - heading), 0.2, atol=1e-12)


def test_the_yaw_of_the_phone_turns_with_the_path() -> None:
    walk = simulate_walk(preset("l_shape"))
    yaw = twist_about_vertical(walk.devices[0].motion.quaternion)
    assert float(wrap_angle(yaw[-1] - yaw[0])) == pytest.approx(np.pi / 2.0, abs=0.1)


def test_the_trunk_is_at_each_step_end_when_its_foot_strikes(walk: SimulatedWalk) -> None:
    covered = np.cumsum(walk.steps.length_m)
    expected = walk.body.on_path_at(walk.steps.time_s)[0]
    legs = np.linalg.norm(np.diff(expected[:9], axis=0), axis=1)  # the first leg is straight
    np.testing.assert_allclose(legs, np.diff(covered[:9]), rtol=1e-9)
    np.testing.assert_allclose(walk.position_at(walk.steps.time_s[-1:])[0], TURNS.vertices_m[-1], atol=1e-9)


def test_the_walker_never_walks_backwards_and_stands_in_the_pause(walk: SimulatedWalk) -> None:
    time_s = np.linspace(0.0, walk.steps.end_s, 20_000)
    speed = walk.body.at(time_s).on_path.rate
    assert speed.min() > -1e-9
    first, second = walk.steps.bouts
    stop_s, go_s = walk.steps.time_s[first][-1], walk.steps.start_s[second][0]
    assert go_s - stop_s == pytest.approx(2.0)
    np.testing.assert_allclose(speed[(time_s > stop_s) & (time_s < go_s)], 0.0, atol=1e-9)


def test_the_trunk_leans_over_the_foot_that_stands(walk: SimulatedWalk) -> None:
    steps = walk.steps
    inside = np.arange(2, 8)  # on the first straight leg, towards the east: left is north
    middle_s = 0.5 * (steps.time_s[inside] + steps.time_s[inside + 1])
    lean = walk.body.at(middle_s).north.value
    np.testing.assert_array_equal(lean > 0.0, steps.foot[inside] == "L")


@pytest.mark.parametrize("seed", range(4))
def test_every_step_has_one_upward_push_softer_at_starts_and_stops(seed: int) -> None:
    walk = simulate_walk(replace(preset("office_loop"), seed=seed))
    motion, steps = walk.devices[0].motion, walk.steps
    peaks, found = find_peaks(motion.up.acceleration, height=0.8)
    assert len(peaks) == len(steps)
    behind_s = motion.time_s[peaks] - steps.time_s
    assert ((behind_s > 0.02) & (behind_s < 0.1)).all()  # a tenth of a step behind the heel strike
    push = found["peak_heights"]
    for bout in steps.bouts:
        usual = np.median(push[bout])
        assert 0.45 < push[bout][0] / usual < 0.9
        assert 0.45 < push[bout][-1] / usual < 0.9


@pytest.mark.parametrize("cadence_hz", [1.5, 1.8, 2.2])
def test_vertical_acceleration_beats_at_the_cadence_with_the_size_of_real_walking(cadence_hz: float) -> None:
    gait = WalkerGaitParams(cadence_hz=cadence_hz)
    walk = simulate_walk(Scenario(path=PathParams(vertices_m=((0.0, 0.0), (120.0, 0.0))), gait=gait))
    motion, steps = walk.devices[0].motion, walk.steps
    walking = (motion.time_s > steps.time_s[1]) & (motion.time_s < steps.time_s[-2])
    vertical = motion.up.acceleration[walking]
    frequency, power = welch(vertical, fs=100.0, nperseg=2048)
    assert frequency[np.argmax(power)] == pytest.approx(cadence_hz, abs=0.06)
    per_step = [
        np.ptp(motion.up.acceleration[(motion.time_s >= begin) & (motion.time_s < end)])
        for begin, end in zip(steps.time_s[2:-3], steps.time_s[3:-2], strict=True)
    ]
    if cadence_hz == 1.8:
        assert 4.0 < np.median(per_step) < 8.0
    second = power[np.argmin(np.abs(frequency - 2.0 * cadence_hz))] / power.max()
    assert 0.02 < second < 0.3
