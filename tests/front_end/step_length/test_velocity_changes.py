"""Lasting changes of the vertical velocity, and the noise that they are judged against."""

import numpy as np
import pytest

from pdr_est.frames import Array
from pdr_est.front_end.step_length.stairs.velocity_changes import CHANGE_VARIANCE, VelocityChanges
from pdr_est.front_end.step_length.stairs.vertical_motion import VerticalMotion
from pdr_est.front_end.step_length.stairs.walk_noise import WalkNoise

STEPS, UNSETTLED = 60, 3


def motions(velocity_mps: Array, begins: tuple[int, ...] = (0,)) -> list[VerticalMotion]:
    return [VerticalMotion(k in begins, float(v), 0.5, 0.5, float("nan")) for k, v in enumerate(velocity_mps)]


def changes(velocity_mps: Array, begins: tuple[int, ...] = (0,)) -> Array:
    return VelocityChanges(UNSETTLED).after(motions(velocity_mps, begins))


def test_neither_a_slope_nor_a_limp_is_a_change_and_a_lasting_one_is_found_with_its_size() -> None:
    place = np.arange(STEPS)
    level = 0.2 + 0.03 * place + 0.1 * (-1.0) ** place
    np.testing.assert_allclose(changes(level)[:, 18:], 0.0, atol=1e-12)
    late, early = changes(level - 0.3 * (place >= 30))
    assert late[33] == pytest.approx(0.3)  # the last four steps after it
    assert early[41] == pytest.approx(0.3)  # the first four before it
    np.testing.assert_allclose(late[46:], 0.0, atol=1e-12)


def test_a_change_needs_settled_steps_of_one_stretch() -> None:
    known = np.isfinite(changes(np.zeros(STEPS), begins=(0, 30)))
    expected = np.zeros(STEPS, dtype=bool)
    expected[18:30] = expected[48:] = True
    np.testing.assert_array_equal(known, [expected, expected])


def test_a_velocity_that_is_not_known_leaves_the_changes_around_it_open() -> None:
    velocity = np.zeros(STEPS)
    velocity[30] = np.nan
    known = np.isfinite(changes(velocity)[0])
    assert known[18:30].all()
    assert not known[30:46].any()
    assert known[46:].all()


@pytest.mark.parametrize("size", [1, 7, 20])
def test_changes_are_the_same_to_the_last_bit_wherever_the_steps_are_cut(size: int) -> None:
    velocity = np.random.default_rng(1).normal(0.0, 0.1, STEPS)
    steps, meter = motions(velocity, begins=(0, 25)), VelocityChanges(UNSETTLED)
    pieces = [meter.after(steps[begin : begin + size]) for begin in range(0, STEPS, size)]
    np.testing.assert_array_equal(np.concatenate(pieces, axis=1), changes(velocity, begins=(0, 25)))


def test_the_variance_of_a_change_is_the_stated_multiple_of_that_of_the_velocities() -> None:
    velocity = np.random.default_rng(2).normal(0.0, 0.1, 20_000)
    for found in changes(velocity)[:, 18:]:
        assert np.mean(found**2) == pytest.approx(CHANGE_VARIANCE * 0.01, rel=0.05)


def test_the_noise_of_a_walk_is_learnt_and_what_is_no_noise_is_not() -> None:
    noise = WalkNoise()
    assert noise.variance == 1.0
    generator = np.random.default_rng(3)
    for error in generator.normal(0.0, 2.0, 200):
        noise.learn(error**2 / noise.variance, 1.0)
    learnt = noise.variance
    assert learnt == pytest.approx(4.0, rel=0.4)
    for _ in range(50):
        noise.learn(100.0, 0.0)
    assert noise.variance == learnt


def test_of_hypotheses_the_probable_ones_tell_the_noise() -> None:
    noise = WalkNoise()
    for _ in range(300):
        noise.learn_of_hypotheses(np.array([1.0, 50.0]), np.array([0.0, -30.0]))
    assert noise.variance == pytest.approx(1.0, rel=0.01)
