"""Gravity and the acceleration without it are put together by their values, whatever units and signs they have."""

import numpy as np
import pytest
from table_walk import table_walk

from pdr_est.frames import STANDARD_GRAVITY_MPS2, Array
from pdr_est.io.conversion.gravity_parts import Total, put_together
from pdr_est.io.conversion.raw_device import RawDevice, RawSensor, RawSignal
from pdr_est.types.recording import Signal

WALK = table_walk()


def raw(values: Array, title: str, factor: float | None = None) -> RawSignal:
    return RawSignal(Signal(WALK.time_s, values), title, factor)


def together(linear: Array, gravity: Array, linear_factor: float | None = None) -> Total:
    return put_together(raw(linear, "linear", linear_factor), raw(gravity, "gravity"), raw(WALK.rate, "gyro", 1.0))


def warnings(total: Total) -> list[str]:
    return [conversion.warning for conversion in total.conversions if conversion.warning]


def drawn_to(force: Array, share: float = 0.01) -> Array:
    """Gravity as phones find it: carried by the (true) rotation, and drawn a little towards the measured force."""
    error = np.zeros(3)
    found = np.empty_like(force)
    for row, (true, measured) in enumerate(zip(WALK.gravity, force, strict=True)):
        error = error + share * (measured - true - error)
        found[row] = true + error
    return STANDARD_GRAVITY_MPS2 * found / np.linalg.norm(found, axis=1, keepdims=True)


@pytest.mark.parametrize("gravity_unit", [1.0, STANDARD_GRAVITY_MPS2, 1e-3 * STANDARD_GRAVITY_MPS2])
@pytest.mark.parametrize("linear_unit", [1.0, STANDARD_GRAVITY_MPS2])
def test_parts_in_any_units(gravity_unit: float, linear_unit: float) -> None:
    total = together(WALK.user / linear_unit, WALK.gravity / gravity_unit)
    assert total.signal is not None
    np.testing.assert_allclose(total.signal.values, WALK.force, atol=1e-4)


@pytest.mark.parametrize("unit", [1.0, STANDARD_GRAVITY_MPS2])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_columns_of_gravity_may_hold_the_total(unit: float, sign: float) -> None:
    total = together(sign * WALK.user, WALK.force / unit)
    assert total.signal is not None
    np.testing.assert_allclose(total.signal.values, WALK.force, atol=1e-4)
    assert "the total acceleration" in total.conversions[-1].decision
    assert warnings(total) == []


def test_opposite_signs_are_seen_by_the_drift_of_gravity() -> None:
    gravity = drawn_to(WALK.force)
    same = together(WALK.force - gravity, gravity)
    opposite = together(gravity - WALK.force, gravity)
    for total in (same, opposite):
        assert total.signal is not None
        np.testing.assert_allclose(total.signal.values, WALK.force, atol=1e-4)
    assert warnings(same) == []
    assert any("opposite" in conversion.decision for conversion in opposite.conversions)


def test_opposite_signs_that_nothing_decides_are_doubted() -> None:
    (words,) = warnings(together(-WALK.user, WALK.gravity))
    assert "have the same sign is not certain" in words
    assert "--map" in words
    assert warnings(together(WALK.user, WALK.gravity)) == []


def test_gravity_at_other_times_is_interpolated_and_rows_without_it_are_left_out() -> None:
    half = Signal(WALK.time_s[100:1500:2], WALK.gravity[100:1500:2])
    total = put_together(raw(WALK.user, "linear"), RawSignal(half, "gravity"), None)
    assert total.signal is not None
    rows = np.searchsorted(WALK.time_s, total.signal.time_s)
    assert len(rows) < len(WALK.time_s)
    np.testing.assert_allclose(total.signal.values, WALK.force[rows], atol=0.3)
    assert any("no gravity at their time" in words for words in warnings(total))
    late = RawSignal(Signal(WALK.time_s + 1e4, WALK.gravity), "gravity")
    apart = put_together(raw(WALK.user, "linear"), late, None)
    assert apart.signal is None
    assert any("do not overlap" in words for words in warnings(apart))


def test_gravity_alone_that_shakes_is_an_accelerometer() -> None:
    device = RawDevice({RawSensor.GRAVITY: raw(WALK.force, "gravity"), RawSensor.RATE: raw(WALK.rate, "gyro", 1.0)})
    converted = device.convert()
    assert converted.specific_force is not None
    np.testing.assert_allclose(converted.specific_force.values, WALK.force, atol=1e-9)
    assert any("it is no gravity" in words for words in converted.decisions)
