"""Gravity is restored by an attitude that fits the gyroscope, and by no other."""

import numpy as np
import pytest
from fabricated import Walk, make_walk

from pdr_est.io.conversion.restored_gravity import restore_gravity
from pdr_est.types.recording import Signal


@pytest.fixture(scope="module")
def walk() -> Walk:
    return make_walk()


def signals(walk: Walk) -> tuple[Signal, Signal, Signal]:
    return tuple(Signal(walk.time_s, values) for values in (walk.user, walk.quaternion, walk.rate))  # type: ignore[return-value]


@pytest.mark.parametrize("inverted", [False, True])
def test_the_sum_is_exact_whichever_way_the_attitude_turns(walk: Walk, inverted: bool) -> None:
    linear, attitude, rate = signals(walk)
    recorded = attitude.values * np.array([1.0, -1.0, -1.0, -1.0]) if inverted else attitude.values
    force, straight, conversion = restore_gravity(linear, Signal(walk.time_s, recorded), rate)
    assert force is not None
    np.testing.assert_allclose(force.values, walk.force, atol=1e-9)
    np.testing.assert_array_equal(straight.values, attitude.values)
    assert ("inverted" in conversion.decision) == inverted
    assert "restored" in conversion.warning


def test_other_clocks_are_interpolated_and_the_rest_is_left_out(walk: Walk) -> None:
    linear, attitude, rate = signals(walk)
    part = Signal(attitude.time_s[100:700:2], attitude.values[100:700:2])
    force, _, _ = restore_gravity(linear, part, rate)
    assert force is not None
    assert (force.time_s[0], force.time_s[-1]) == pytest.approx((1.0, 6.98))
    np.testing.assert_allclose(force.values, walk.force[100:699], atol=0.02)


def test_an_attitude_of_other_axes_restores_nothing(walk: Walk) -> None:
    linear, attitude, rate = signals(walk)
    swapped = Signal(walk.time_s, attitude.values[:, [0, 3, 1, 2]])
    force, _, conversion = restore_gravity(linear, swapped, rate)
    assert force is None
    assert "cannot be restored" in conversion.warning
