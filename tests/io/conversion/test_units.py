"""Units are detected from the values, and an open question is a warning."""

import numpy as np
import pytest
from fabricated import Walk, make_walk

from pdr_est.frames import STANDARD_GRAVITY_MPS2
from pdr_est.io.conversion.units import (
    detect_acceleration_unit,
    detect_pressure_unit,
    detect_rotation_rate_unit,
)


@pytest.fixture(scope="module")
def walk() -> Walk:
    return make_walk()


@pytest.mark.parametrize(("divisor", "factor"), [(1.0, 1.0), (STANDARD_GRAVITY_MPS2, STANDARD_GRAVITY_MPS2)])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_unit_of_acceleration_is_found_whatever_the_sign(
    walk: Walk, divisor: float, factor: float, sign: float
) -> None:
    conversion = detect_acceleration_unit(sign * walk.force / divisor)
    assert conversion.factor == factor
    assert conversion.warnings == ()


def test_a_phone_that_is_put_elsewhere_in_between_keeps_its_unit(walk: Walk) -> None:
    turned = np.concatenate([walk.force, -walk.force])
    assert detect_acceleration_unit(turned / STANDARD_GRAVITY_MPS2).factor == STANDARD_GRAVITY_MPS2


@pytest.mark.parametrize("scale", [0.3, 1.0, 3.0])
def test_acceleration_without_gravity_is_doubted(walk: Walk, scale: float) -> None:
    conversion = detect_acceleration_unit(scale * walk.user)
    assert conversion.factor == 1.0
    assert "gravity may be missing" in conversion.warning


def test_a_constant_of_unknown_unit_is_doubted() -> None:
    assert detect_acceleration_unit(np.full((100, 3), 981.0)).warning


def test_thousandths_are_found(walk: Walk) -> None:
    acceleration = detect_acceleration_unit(walk.force / STANDARD_GRAVITY_MPS2 * 1e3)
    assert acceleration.factor == pytest.approx(1e-3 * STANDARD_GRAVITY_MPS2)
    rotation = detect_rotation_rate_unit(1e3 * np.degrees(walk.rate))
    assert rotation.factor == pytest.approx(np.pi / 180e3)
    assert acceleration.warnings + rotation.warnings == ()


def test_the_unit_of_rotation_is_found_for_a_walk(walk: Walk) -> None:
    assert detect_rotation_rate_unit(walk.rate) == detect_rotation_rate_unit(walk.rate)
    assert (detect_rotation_rate_unit(walk.rate).factor, detect_rotation_rate_unit(walk.rate).warning) == (1.0, "")
    degrees = detect_rotation_rate_unit(np.degrees(walk.rate))
    assert degrees.factor == pytest.approx(np.pi / 180.0)
    assert degrees.warning == ""


@pytest.mark.parametrize("spike", [1e6, -500.0])
def test_a_single_damaged_number_does_not_decide_the_unit_of_rotation(walk: Walk, spike: float) -> None:
    damaged = walk.rate.copy()
    damaged[3, 1] = spike
    assert detect_rotation_rate_unit(damaged).factor == 1.0


def test_a_phone_that_hardly_turns_leaves_the_unit_of_rotation_open() -> None:
    conversion = detect_rotation_rate_unit(np.full((100, 3), 0.01))
    assert conversion.factor == 1.0
    assert "cannot be determined" in conversion.warning


@pytest.mark.parametrize(("median", "factor"), [(101_300.0, 1.0), (1013.0, 100.0), (101.3, 1000.0)])
def test_the_unit_of_pressure(median: float, factor: float) -> None:
    conversion = detect_pressure_unit(np.full(5, median))
    assert (conversion.factor, conversion.warning) == (factor, "")


def test_an_impossible_pressure_is_doubted() -> None:
    assert detect_pressure_unit(np.full(5, 29.9)).warning  # inches of mercury
