"""Turns of the axes of a device: what they are called, and what they leave as it was."""

import numpy as np
import pytest

from pdr_est.errors import ConfigError
from pdr_est.frames import up_in_device
from pdr_est.preprocessing.turned_axes import AxisTurn, turn_axes
from pdr_est.simulate import simulate_walk
from pdr_est.simulate.people.population import PopulationParams, sample_population
from pdr_est.types.recording import Recording


def test_a_quarter_turn_about_x_takes_y_to_z() -> None:
    assert AxisTurn.named("x90").matrix() @ [1.0, 2.0, 3.0] == pytest.approx([1.0, -3.0, 2.0])
    assert AxisTurn.named("z-90").matrix() @ [1.0, 2.0, 3.0] == pytest.approx([2.0, -1.0, 3.0])


def test_a_random_turn_is_a_rotation_that_its_seed_tells() -> None:
    first, again, other = (AxisTurn.named(name).matrix() for name in ("random:3", "random:3", "random:4"))
    assert np.array_equal(first, again)
    assert not np.allclose(first, other)
    assert first @ first.T == pytest.approx(np.eye(3))
    assert np.linalg.det(first) == pytest.approx(1.0)


@pytest.mark.parametrize("name", ["", "w90", "x", "random", "random:-1", "x90deg"])
def test_other_names_are_refused(name: str) -> None:
    with pytest.raises(ConfigError, match="write an axis and degrees"):
        AxisTurn.named(name)


def test_attitudes_turn_with_the_vectors() -> None:
    turn = AxisTurn.named("random:1")
    attitude = np.random.default_rng(0).standard_normal((5, 4))
    attitude /= np.linalg.norm(attitude, axis=1, keepdims=True)
    assert up_in_device(turn.attitudes(attitude)) == pytest.approx(up_in_device(attitude) @ turn.matrix().T)


def test_all_signals_turn_and_the_recording_says_so() -> None:
    recording = recorded()
    turned = turn_axes(recording, AxisTurn.named("y30"))
    for before, after in zip(recording.devices, turned.devices, strict=True):
        assert before.usual_axes
        assert not after.usual_axes
        for name in ("specific_force", "rotation_rate", "magnetic_field"):
            old, new = getattr(before, name).values, getattr(after, name).values
            assert new == pytest.approx(old @ AxisTurn.named("y30").matrix().T)
            assert not np.allclose(new, old)
        assert after.specific_force is not None
        assert before.specific_force is not None
        assert after.specific_force.time_s is before.specific_force.time_s


def recorded() -> Recording:
    (member,) = sample_population(PopulationParams(number=1, duration_s=20.0, magnetometer=True), 1)
    return simulate_walk(member.scenario).recording
