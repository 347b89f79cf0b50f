"""Angles, quaternions and rotations against values known otherwise."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from pdr_est.frames import (
    quaternion_from_core_motion,
    rotation_matrix,
    twist_about_vertical,
    up_in_device,
    wrap_angle,
)

ANGLES = st.floats(-50.0, 50.0)
RANDOM = Rotation.random(40, random_state=0)


@pytest.mark.parametrize(
    ("angle", "wrapped"),
    [(0.0, 0.0), (np.pi, -np.pi), (-np.pi, -np.pi), (1.5 * np.pi, -0.5 * np.pi), (-7.0, -7.0 + 2.0 * np.pi)],
)
def test_angles_are_wrapped_to_the_half_open_turn(angle: float, wrapped: float) -> None:
    assert float(wrap_angle(angle)) == pytest.approx(wrapped, abs=1e-12)


@given(ANGLES)
def test_wrapping_keeps_the_direction(angle: float) -> None:
    wrapped = float(wrap_angle(angle))
    assert -np.pi <= wrapped < np.pi
    assert np.cos(wrapped) == pytest.approx(np.cos(angle), abs=1e-12)
    assert np.sin(wrapped) == pytest.approx(np.sin(angle), abs=1e-12)


def test_a_heading_turns_forward_into_the_map() -> None:
    np.testing.assert_allclose(rotation_matrix(np.pi / 2) @ [1.0, 0.0], [0.0, 1.0], atol=1e-15)  # facing north
    np.testing.assert_allclose(rotation_matrix(np.pi / 2) @ [0.0, 1.0], [-1.0, 0.0], atol=1e-15)  # its left is west
    np.testing.assert_allclose(rotation_matrix(0.3) @ rotation_matrix(-0.3), np.eye(2), atol=1e-15)


def test_the_vertical_in_device_axes() -> None:
    up = up_in_device(RANDOM.as_quat(scalar_first=True))
    np.testing.assert_allclose(up, RANDOM.inv().apply([0.0, 0.0, 1.0]), atol=1e-12)


@given(st.floats(-3.1, 3.1), st.floats(-2.9, 2.9), st.floats(0.0, 2.0 * np.pi))
def test_the_twist_is_the_turn_about_the_vertical(turn: float, tilt: float, axis: float) -> None:
    """Leaning about any level axis first and turning then shows the turn, also beyond upright."""
    leaning = Rotation.from_rotvec([tilt * np.cos(axis), tilt * np.sin(axis), 0.0])
    whole = (Rotation.from_rotvec([0.0, 0.0, turn]) * leaning).as_quat(scalar_first=True)
    for quaternion in (whole, -whole):
        found = float(twist_about_vertical(quaternion[None, :])[0])
        assert float(wrap_angle(found - turn)) == pytest.approx(0.0, abs=1e-9)


def test_core_motion_angles_turn_roll_then_pitch_then_yaw() -> None:
    roll, pitch, yaw = np.random.default_rng(1).uniform(-1.5, 1.5, (3, 20))
    found = Rotation.from_quat(quaternion_from_core_motion(roll, pitch, yaw), scalar_first=True)
    expected = Rotation.from_euler("ZXY", np.stack([yaw, pitch, roll], axis=1))
    assert (found * expected.inv()).magnitude().max() < 1e-12
