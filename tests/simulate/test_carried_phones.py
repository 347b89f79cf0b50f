"""Phones in a swinging hand and in a pocket: where gravity points, and how they move with arm and leg."""

from dataclasses import replace

import numpy as np
import pytest
from carried import (
    CADENCE_HZ,
    TURNS,
    finely_walked,
    orientation_error_rad,
    strongest_hz,
    twice_integrated,
    up_in,
    walk_with,
    walking_part,
)

from pdr_est.frames import Array, twist_about_vertical
from pdr_est.simulate import DeviceParams, HeldPhone, PathParams, PocketPhone, SwingingPhone
from pdr_est.simulate.walker.walking_body import Side

PHONES = [
    SwingingPhone(),
    SwingingPhone(hand="left", grip_rad=0.9),
    PocketPhone(),
    PocketPhone(side="left", spin_rad=0.4),
]


@pytest.mark.parametrize("phone", PHONES)
def test_sensors_agree_with_the_motion(phone: SwingingPhone | PocketPhone) -> None:
    motion = finely_walked(DeviceParams(carry=phone))
    assert orientation_error_rad(motion).max() < 3e-5  # trapezium error of a shock at 500 Hz
    np.testing.assert_allclose(twice_integrated(motion), motion.position_m, atol=6e-3)


@pytest.mark.parametrize("phone", PHONES)
def test_specific_force_and_rotation_have_no_jumps(phone: SwingingPhone | PocketPhone) -> None:
    motion = finely_walked(DeviceParams(carry=phone))
    assert np.abs(np.diff(motion.specific_force_mps2, axis=0)).max() < 5.0  # within 2 ms; a shock swings at 10 Hz
    assert np.abs(np.diff(motion.rotation_rate_radps, axis=0)).max() < 1.0


@pytest.mark.parametrize(("hand", "sign"), [("right", 1.0), ("left", -1.0)])
def test_gravity_is_on_the_x_axis_of_a_swinging_phone(hand: Side, sign: float) -> None:
    walk = walk_with(DeviceParams(carry=SwingingPhone(hand=hand)))
    up = up_in(walk.devices[0].motion)
    assert (sign * up[:, 0]).min() > 0.7
    assert np.abs(up.mean(axis=0)[1:]).max() < 0.3  # the elbow is bent
    assert (sign * up[:, 0]).max() > 0.9  # MMPDR's threshold GS_x


def test_the_grip_turns_gravity_towards_the_y_axis() -> None:
    walk = walk_with(DeviceParams(carry=SwingingPhone(grip_rad=1.1)))
    standing = up_in(walk.devices[0].motion)[:200].mean(axis=0)
    assert standing[0] == pytest.approx(np.cos(1.1), abs=0.05)
    assert standing[1] == pytest.approx(-np.sin(1.1), abs=0.05)  # the upper edge points down


def test_gravity_is_split_between_y_and_z_of_a_held_phone() -> None:
    up = up_in(walk_with(DeviceParams(carry=HeldPhone(tilt_rad=0.8))).devices[0].motion)
    np.testing.assert_allclose(up.mean(axis=0), [0.0, np.sin(0.8), np.cos(0.8)], atol=0.03)


@pytest.mark.parametrize(
    ("facing_rad", "spin_rad", "tip_rad", "expected"),
    [
        (0.0, 0.0, 0.0, (0.0, 1.0, 0.0)),
        (np.pi, np.pi, 0.0, (0.0, -1.0, 0.0)),
        (0.5, np.pi / 2.0, 0.0, (1.0, 0.0, 0.0)),
        (0.5, 0.0, 0.6, (0.0, np.cos(0.6), np.sin(0.6))),
    ],
)
def test_a_pocket_takes_a_phone_in_any_attitude(
    facing_rad: float, spin_rad: float, tip_rad: float, expected: tuple[float, ...]
) -> None:
    pocket = PocketPhone(facing_rad=facing_rad, spin_rad=spin_rad, tip_rad=tip_rad)
    walk = walk_with(DeviceParams(carry=pocket))
    standing = up_in(walk.devices[0].motion)[:200].mean(axis=0)
    np.testing.assert_allclose(standing, expected, atol=0.05)


def test_the_screen_in_the_pocket_faces_where_it_was_told() -> None:
    motion = walk_with(DeviceParams(carry=PocketPhone(facing_rad=0.7, spin_rad=1.0))).devices[0].motion
    screen = np.stack([motion.in_device(np.array(axis)) for axis in ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0])])[:, 0, 2]
    assert np.arctan2(screen[1], screen[0]) == pytest.approx(0.7, abs=0.08)  # the walker faces east


def flexion_of(walk_motion_up: Array) -> Array:
    """Angle of the device's up direction about its mean, in the plane in which it moves most, rad."""
    centred = walk_motion_up - walk_motion_up.mean(axis=0)
    axis = np.linalg.svd(centred, full_matrices=False)[2][0]
    angle: Array = np.arcsin(centred @ axis)
    return angle


def test_the_arm_swings_once_a_stride_as_far_as_told() -> None:
    phone = SwingingPhone(amplitude_rad=0.3, elbow_rad=0.2, second=0.0, uneven=0.0)
    walk = walk_with(DeviceParams(carry=phone))
    swing = flexion_of(up_in(walk.devices[0].motion)[walking_part(walk)])
    assert strongest_hz(swing) == pytest.approx(CADENCE_HZ / 2.0, abs=0.05)
    assert np.percentile(np.abs(swing), 99) == pytest.approx(0.5, abs=0.08)


@pytest.mark.parametrize("hand", ["left", "right"])
def test_the_arm_is_foremost_when_the_other_foot_strikes(hand: Side) -> None:
    phone = SwingingPhone(hand=hand, lag=0.0, second=0.0)
    walk = walk_with(DeviceParams(carry=phone))
    motion, steps = walk.devices[0].motion, walk.steps
    ahead_m = motion.east.value - walk.position_at(motion.time_s)[:, 0]
    at_strike = np.interp(steps.time_s[3:-3], motion.time_s, ahead_m)
    other = steps.foot[3:-3] == ("R" if hand == "left" else "L")
    assert at_strike[other].min() > at_strike[~other].max() + 0.2


def test_the_thigh_swings_once_a_stride_and_is_flexed_when_its_foot_strikes() -> None:
    phone = PocketPhone(facing_rad=0.0, spin_rad=0.0, amplitude_rad=0.35, twist_rad=0.0, spread_rad=0.0)
    still = replace(phone, give_rad=0.0, shock_rad=0.0, uneven=0.0, wander_rad=0.0, unrest_radps=0.0)
    walk = walk_with(DeviceParams(carry=still))
    motion, steps = walk.devices[0].motion, walk.steps
    up = up_in(motion)
    flexion = np.arctan2(up[:, 2], up[:, 1])  # the screen leans back as the thigh comes forward
    part = walking_part(walk)
    assert strongest_hz(flexion[part]) == pytest.approx(CADENCE_HZ / 2.0, abs=0.05)
    assert np.ptp(flexion[part]) == pytest.approx(0.72, abs=0.08)
    at_strike = np.interp(steps.time_s[3:-3], motion.time_s, flexion)
    own = steps.foot[3:-3] == "R"
    assert at_strike[own].min() > 0.25
    assert at_strike[~own].max() < -0.1


def test_stance_lasts_longer_than_swing() -> None:
    walk = walk_with(DeviceParams(carry=PocketPhone(give_rad=0.0, shock_rad=0.0, facing_rad=0.0, spin_rad=0.0)))
    rate = walk.devices[0].motion.rotation_rate_radps[walking_part(walk), 0]
    backwards = np.mean(rate > 0.0)  # the device's x axis points left: about it a hanging leg turns backwards
    assert 0.52 < backwards < 0.7


def test_the_shock_follows_the_heel_strike_of_the_own_leg() -> None:
    walk = walk_with(DeviceParams(carry=PocketPhone(uneven=0.0)))
    calm = walk_with(
        DeviceParams(carry=PocketPhone(uneven=0.0, give_m=0.0, give_rad=0.0, shock_m=0.0, shock_rad=0.0))
    )
    jolt = np.abs(walk.devices[0].motion.up.acceleration - calm.devices[0].motion.up.acceleration)
    time_s, steps = walk.devices[0].motion.time_s, walk.steps
    height = {
        foot: np.mean(
            [jolt[(time_s >= t) & (time_s < t + 0.2)].max() for t in steps.time_s[steps.foot == foot][2:-2]]
        )
        for foot in ("L", "R")
    }
    assert height["R"] > 2.0 * height["L"] > 1.0
    np.testing.assert_allclose(jolt[time_s < steps.start_s[0]], 0.0, atol=1e-9)


def test_the_yaw_in_the_pocket_swings_with_the_leg_and_follows_the_turns() -> None:
    walk = walk_with(DeviceParams(carry=PocketPhone(twist_rad=0.25, facing_rad=0.0, spin_rad=0.0)), TURNS)
    motion = walk.devices[0].motion
    yaw = np.unwrap(twist_about_vertical(motion.quaternion))
    turned = yaw[-1] - yaw[0]
    assert turned == pytest.approx(np.ptp(walk.truth_heading_rad[[0, -1]]), abs=0.1)
    oscillation = np.gradient(yaw, motion.time_s) - np.gradient(walk.heading_at(motion.time_s), motion.time_s)
    assert strongest_hz(oscillation[walking_part(walk)]) == pytest.approx(CADENCE_HZ / 2.0, abs=0.06)


def test_a_tilted_gyroscope_axis_sees_less_of_a_turn() -> None:
    """The turn-insufficient effect of PSP: the y axis of a swinging phone integrates to less than the turn."""
    in_one_plane = PocketPhone(facing_rad=0.0, spin_rad=0.0, amplitude_rad=0.5, twist_rad=0.0, spread_rad=0.0)
    calm = replace(in_one_plane, give_rad=0.0, shock_rad=0.0, wander_rad=0.0, unrest_radps=0.0)
    corner = PathParams(vertices_m=((0.0, 0.0), (8.0, 0.0), (8.0, 6.0)))
    motion = walk_with(DeviceParams(carry=calm), corner).devices[0].motion
    seen = np.trapezoid(motion.rotation_rate_radps[:, 1], motion.time_s)
    assert 0.8 < seen / (np.pi / 2.0) < 0.97
