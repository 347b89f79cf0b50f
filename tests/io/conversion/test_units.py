"""Units and signs are told from the values, and doubt is never silent."""

import numpy as np
import pytest
from fabricated import Walk, make_walk

from pdr_est.frames import STANDARD_GRAVITY_MPS2, Array
from pdr_est.io.conversion.units import (
    detect_acceleration_unit,
    detect_clock_unit,
    detect_force_sign,
    detect_pressure_unit,
    detect_rotation_rate_unit,
    gravity_cosine,
    resolve_attitude_direction,
)
from pdr_est.types.recording import Signal


@pytest.fixture(scope="module")
def walk() -> Walk:
    return make_walk()


def force(walk: Walk, sign: float = 1.0) -> Signal:
    return Signal(walk.time_s, sign * walk.force)


def attitude(walk: Walk) -> Signal:
    return Signal(walk.time_s, walk.quaternion)


@pytest.mark.parametrize(("divisor", "factor"), [(1.0, 1.0), (STANDARD_GRAVITY_MPS2, STANDARD_GRAVITY_MPS2)])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_unit_of_acceleration_is_found_whatever_the_sign(
    walk: Walk, divisor: float, factor: float, sign: float
) -> None:
    finding = detect_acceleration_unit(sign * walk.force / divisor)
    assert finding.factor == factor
    assert finding.warnings == ()


def test_a_phone_that_is_put_elsewhere_in_between_keeps_its_unit(walk: Walk) -> None:
    turned = np.concatenate([walk.force, -walk.force])
    assert detect_acceleration_unit(turned / STANDARD_GRAVITY_MPS2).factor == STANDARD_GRAVITY_MPS2


@pytest.mark.parametrize("scale", [0.3, 1.0, 3.0])
def test_acceleration_without_gravity_is_doubted(walk: Walk, scale: float) -> None:
    finding = detect_acceleration_unit(scale * walk.user)
    assert finding.factor == 1.0
    assert "gravity may be missing" in finding.warning


def test_a_constant_of_unknown_unit_is_doubted() -> None:
    assert detect_acceleration_unit(np.full((100, 3), 981.0)).warning


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
    finding = detect_rotation_rate_unit(np.full((100, 3), 0.01))
    assert finding.factor == 1.0
    assert "cannot be told" in finding.warning


@pytest.mark.parametrize(("median", "factor"), [(101_300.0, 1.0), (1013.0, 100.0), (101.3, 1000.0)])
def test_the_unit_of_pressure(median: float, factor: float) -> None:
    finding = detect_pressure_unit(np.full(5, median))
    assert (finding.factor, finding.warning) == (factor, "")


def test_an_impossible_pressure_is_doubted() -> None:
    assert detect_pressure_unit(np.full(5, 29.9)).warning  # inches of mercury


@pytest.mark.parametrize(
    ("start", "per_s"),
    [
        (0, 1.0),
        (0, 1e3),
        (0, 1e6),
        (0, 1e9),
        (86_400, 1e9),  # since boot
        (1_718_030_736, 1.0),
        (1_718_030_736, 1e3),
        (1_718_030_736, 1e9),
    ],
)
@pytest.mark.parametrize("rate_hz", [25.0, 100.0, 500.0])
def test_the_unit_of_a_clock(start: float, per_s: float, rate_hz: float) -> None:
    finding = detect_clock_unit((start + np.arange(1000) / rate_hz) * per_s)
    assert finding.factor == pytest.approx(1.0 / per_s)
    assert finding.warning == ""


def test_a_clock_that_stands_still_is_doubted() -> None:
    assert detect_clock_unit(np.zeros(10)).warning


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_attitude_tells_the_sign(walk: Walk, sign: float) -> None:
    finding = detect_force_sign(force(walk, sign), attitude(walk), None, "")
    assert (finding.factor, finding.warning) == (sign, "")


def test_the_attitude_overrules_the_metadata_with_a_warning(walk: Walk) -> None:
    finding = detect_force_sign(force(walk, -1.0), attitude(walk), 1.0, "the metadata name android")
    assert finding.factor == -1.0
    assert "contradicts" in finding.warning


def test_an_attitude_that_does_not_fit_leaves_it_to_the_metadata(walk: Walk) -> None:
    sideways = Signal(walk.time_s, np.tile([np.sqrt(0.5), np.sqrt(0.5), 0.0, 0.0], (len(walk.time_s), 1)))
    upright = Signal(walk.time_s, np.tile([0.0, 0.0, 9.8], (len(walk.time_s), 1)))
    finding = detect_force_sign(upright, sideways, -1.0, "iOS")
    assert finding.factor == -1.0
    assert "do not fit" in finding.warning


def test_without_attitude_and_metadata_only_face_up_is_certain(walk: Walk) -> None:
    assert detect_force_sign(force(walk), None, None, "").warning == ""
    for axis in (np.array([0.0, 0.0, -9.8]), np.array([0.0, 9.8, 0.0])):
        finding = detect_force_sign(Signal(walk.time_s, np.tile(axis, (len(walk.time_s), 1))), None, None, "")
        assert finding.factor == 1.0
        assert "cannot be told" in finding.warning


def conjugated(quaternion: Array) -> Array:
    return quaternion * np.array([1.0, -1.0, -1.0, -1.0])


def test_a_fitting_attitude_is_kept_and_an_inverse_one_inverted(walk: Walk) -> None:
    kept, _ = resolve_attitude_direction(force(walk), attitude(walk))
    assert kept is not None
    np.testing.assert_array_equal(kept.values, walk.quaternion)
    turned, finding = resolve_attitude_direction(force(walk), Signal(walk.time_s, conjugated(walk.quaternion)))
    assert turned is not None
    np.testing.assert_array_equal(turned.values, walk.quaternion)
    assert "inverted" in finding.decision


def test_an_attitude_that_fits_neither_way_is_left_out(walk: Walk) -> None:
    random = np.random.default_rng(1).normal(size=(len(walk.time_s), 4))
    kept, finding = resolve_attitude_direction(
        force(walk), Signal(walk.time_s, random / np.linalg.norm(random, axis=1)[:, None])
    )
    assert kept is None
    assert "left out" in finding.warning


def test_no_overlap_in_time_gives_no_cosine(walk: Walk) -> None:
    later = Signal(walk.time_s + 1000.0, walk.quaternion)
    assert gravity_cosine(force(walk), later) is None
    kept, finding = resolve_attitude_direction(force(walk), later)
    assert kept is later
    assert "no overlap" in finding.warning
