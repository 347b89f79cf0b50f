"""The sign of the acceleration and the direction of the attitude are found from gravity."""

import numpy as np
import pytest
from fabricated import Walk, make_walk

from pdr_est.frames import Array
from pdr_est.io.conversion.sign_evidence import SignEvidence, screen_evidence, unit_evidence
from pdr_est.io.conversion.signs import detect_force_sign, gravity_cosine, resolve_attitude_direction
from pdr_est.types.recording import Signal


@pytest.fixture(scope="module")
def walk() -> Walk:
    return make_walk()


def force(walk: Walk, sign: float = 1.0) -> Signal:
    return Signal(walk.time_s, sign * walk.force)


def attitude(walk: Walk) -> Signal:
    return Signal(walk.time_s, walk.quaternion)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_attitude_tells_the_sign(walk: Walk, sign: float) -> None:
    conversion = detect_force_sign(force(walk, sign), attitude(walk), None, "")
    assert (conversion.factor, conversion.warning) == (sign, "")


def test_the_attitude_overrules_the_metadata_with_a_warning(walk: Walk) -> None:
    conversion = detect_force_sign(force(walk, -1.0), attitude(walk), 1.0, "the metadata name android")
    assert conversion.factor == -1.0
    assert "contradicts" in conversion.warning


def test_an_attitude_that_contradicts_gravity_leaves_it_to_the_metadata(walk: Walk) -> None:
    sideways = Signal(walk.time_s, np.tile([np.sqrt(0.5), np.sqrt(0.5), 0.0, 0.0], (len(walk.time_s), 1)))
    upright = Signal(walk.time_s, np.tile([0.0, 0.0, 9.8], (len(walk.time_s), 1)))
    conversion = detect_force_sign(upright, sideways, -1.0, "iOS")
    assert conversion.factor == -1.0
    assert "do not agree" in conversion.warning


def along(walk: Walk, direction: tuple[float, float, float]) -> Signal:
    return Signal(walk.time_s, np.tile(9.8 * np.array(direction), (len(walk.time_s), 1)))


@pytest.mark.parametrize(
    ("direction", "unit", "sign", "certain"),
    [
        ((0.0, 0.5, 0.86), 1.0, 1.0, True),  # an ordinary table in m/s^2 of a phone in the hand
        ((0.0, 0.0, 1.0), 1.0, 1.0, True),
        ((0.0, 1.0, 0.0), 1.0, 1.0, False),
        ((0.0, -0.9, -0.3), 1.0, 1.0, False),  # at the ear
        ((0.0, 0.0, -1.0), 1.0, -1.0, False),
        ((0.0, 0.5, 0.86), 9.80665, 1.0, False),
        ((0.0, -0.9, -0.3), 9.80665, -1.0, False),
        ((0.0, 0.0, -1.0), 9.80665, -1.0, False),
    ],
)
def test_without_attitude_and_metadata_only_a_screen_that_faces_up_in_si_units_is_certain(
    walk: Walk, direction: tuple[float, float, float], unit: float, sign: float, certain: bool
) -> None:
    force = along(walk, direction)
    conversion = detect_force_sign(force, None, None, "", (screen_evidence(force), unit_evidence(unit)))
    assert conversion.factor == sign
    assert certain != ("the track is mirrored: state the sign with --map" in conversion.warning)


@pytest.mark.parametrize(
    ("log_odds", "sign", "certain"), [(7.0, 1.0, True), (4.0, 1.0, False), (-4.0, -1.0, False), (-7.0, -1.0, True)]
)
def test_the_evidence_is_summed(walk: Walk, log_odds: float, sign: float, certain: bool) -> None:
    evidence = (SignEvidence(2.0, "one reason"), SignEvidence(log_odds - 2.0, "another"))
    conversion = detect_force_sign(along(walk, (0.0, 0.0, 1.0)), None, None, "", evidence)
    assert conversion.factor == sign
    assert (conversion.warning == "") == certain
    assert "one reason; another" in conversion.decision


def test_neither_attitude_nor_metadata_wait_for_evidence(walk: Walk) -> None:
    down = (SignEvidence(-9.0, "a reason"),)
    assert detect_force_sign(force(walk), attitude(walk), None, "", down).factor == 1.0
    assert detect_force_sign(force(walk), None, 1.0, "the metadata name android", down).factor == 1.0


def conjugated(quaternion: Array) -> Array:
    return quaternion * np.array([1.0, -1.0, -1.0, -1.0])


def test_a_fitting_attitude_is_kept_and_an_inverse_one_inverted(walk: Walk) -> None:
    kept, _ = resolve_attitude_direction(force(walk), attitude(walk))
    assert kept is not None
    np.testing.assert_array_equal(kept.values, walk.quaternion)
    turned, conversion = resolve_attitude_direction(force(walk), Signal(walk.time_s, conjugated(walk.quaternion)))
    assert turned is not None
    np.testing.assert_array_equal(turned.values, walk.quaternion)
    assert "inverted" in conversion.decision


def test_an_attitude_that_fits_neither_way_is_left_out(walk: Walk) -> None:
    random = np.random.default_rng(1).normal(size=(len(walk.time_s), 4))
    kept, conversion = resolve_attitude_direction(
        force(walk), Signal(walk.time_s, random / np.linalg.norm(random, axis=1)[:, None])
    )
    assert kept is None
    assert "left out" in conversion.warning


def test_no_overlap_in_time_gives_no_cosine(walk: Walk) -> None:
    later = Signal(walk.time_s + 1000.0, walk.quaternion)
    assert gravity_cosine(force(walk), later) is None
    kept, conversion = resolve_attitude_direction(force(walk), later)
    assert kept is later
    assert "does not overlap" in conversion.warning
