"""Vectors in the level frame, against the whole attitude."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from pdr_est.frames import twist_about_vertical, up_in_device
from pdr_est.front_end.heading.level_frame import to_level


def test_it_is_the_horizontal_part_of_what_the_attitude_makes_of_a_vector() -> None:
    attitude = Rotation.random(500, rng=3)
    vectors = np.random.default_rng(4).standard_normal((500, 3))
    quaternion = attitude.as_quat(scalar_first=True)
    found = to_level(vectors, up_in_device(quaternion), twist_about_vertical(quaternion))
    np.testing.assert_allclose(found, attitude.apply(vectors)[:, :2], atol=1e-11)


def test_a_phone_that_lies_flat_is_turned_by_its_yaw_only() -> None:
    up, ahead = np.array([[0.0, 0.0, 1.0]]), np.array([[0.0, 2.0, 5.0]])
    np.testing.assert_allclose(to_level(ahead, up, np.array([0.0])), [[0.0, 2.0]])
    np.testing.assert_allclose(to_level(ahead, up, np.array([np.pi / 2.0])), [[-2.0, 0.0]], atol=1e-15)


@pytest.mark.parametrize("up_z", [-1.0, -1.0 + 1e-12])
def test_a_phone_upside_down_gives_finite_numbers(up_z: float) -> None:
    up = np.array([[np.sqrt(max(1.0 - up_z**2, 0.0)), 0.0, up_z]])
    assert np.isfinite(to_level(np.array([[1.0, 2.0, 3.0]]), up, np.zeros(1))).all()
