"""Movement of a phone from running sums, by hand."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from signals import RATE_HZ, level

from pdr_est.frames import Array
from pdr_est.front_end.signal.blocks import part
from pdr_est.front_end.steps.step_evidence.movement import (
    Movement,
    MovementSums,
    movement_between,
    movements_between,
    strength_between,
    strengths_between,
)
from pdr_est.types.sensors import LevelBlock


def times(count_s: float) -> Array:
    return np.arange(round(count_s * RATE_HZ)) / RATE_HZ


def moving(acceleration: Array, up: Array | None = None) -> LevelBlock:
    block = level(np.zeros(len(acceleration)))
    return replace(block, acceleration_mps2=acceleration, up=block.up if up is None else up)


def sums_of(block: LevelBlock) -> Array:
    return MovementSums(RATE_HZ).push(block)


def movement_of(block: LevelBlock) -> Movement:
    """Movement in the last 2 s."""
    sums = sums_of(block)
    return movement_between(sums[-101], sums[-51], sums[-1], 100)


def test_the_strength_is_that_of_the_vibration_in_all_directions() -> None:
    """Sines of 3 and 4 m/s^2 have a standard deviation of 5 / sqrt(2); the average over 0.1 s takes 6.5 % at 2 Hz."""
    t = times(5.0)
    wave = np.sin(4.0 * np.pi * t)
    block = moving(np.stack([3.0 * wave, np.zeros(len(t)), 4.0 * wave], axis=1))
    assert movement_of(block).acceleration_mps2 == pytest.approx(0.935 * 5.0 / np.sqrt(2.0), rel=0.01)
    sums = sums_of(block)
    assert strength_between(sums[-101], sums[-1], 100) == pytest.approx(0.935 * 5.0 / np.sqrt(2.0), rel=0.01)


def test_a_braking_vehicle_is_no_vibration() -> None:
    """Whoever brakes for a second and rolls for the next one is not shaken."""
    braking = np.outer(np.repeat([0.0, -2.0], [101, 50]), [1.0, 0.0, 0.0])
    assert movement_of(moving(braking)).acceleration_mps2 < 0.3
    assert strength_between(*sums_of(moving(braking))[[-101, -1]], 100) > 0.9


def test_a_swing_in_one_plane_does_not_tilt_sideways() -> None:
    """Of swings about two axes, a quarter of a period apart, the smaller one counts."""
    t = times(4.0)
    for sideways_rad in (0.0, 0.2, 0.3):
        forward, sideways = 0.4 * np.sin(2.0 * np.pi * t), sideways_rad * np.cos(2.0 * np.pi * t)
        up = np.stack([np.sin(forward), np.sin(sideways), np.ones(len(t))], axis=1)
        up /= np.linalg.norm(up, axis=1)[:, None]
        movement = movement_of(moving(np.zeros((len(t), 3)), up))
        assert movement.sideways_tilt_rad == pytest.approx(sideways_rad / np.sqrt(2.0), abs=0.03)


@pytest.mark.parametrize(("x", "z", "share"), [(3.0, 4.0, 0.64), (3.0, 0.0, 0.0), (0.0, 4.0, 1.0)])
def test_vertical_share_of_the_vibration(x: float, z: float, share: float) -> None:
    wave = np.sin(4.0 * np.pi * times(5.0))
    block = moving(np.stack([x * wave, np.zeros(len(wave)), z * wave], axis=1))
    assert movement_of(block).vertical_share == pytest.approx(share, abs=1e-6)


def test_movement_does_not_depend_on_the_axes() -> None:
    rng = np.random.default_rng(3)
    acceleration, up = rng.normal(size=(200, 3)), rng.normal((0.0, 3.0, 9.0), size=(200, 3))
    up /= np.linalg.norm(up, axis=1)[:, None]
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    turned = movement_of(moving(acceleration @ turn.T, up @ turn.T))
    assert turned == pytest.approx(movement_of(moving(acceleration, up)), rel=1e-9)


def test_running_sums_do_not_depend_on_the_cuts() -> None:
    rng = np.random.default_rng(0)
    block = moving(rng.normal(size=(400, 3)) + 1e3, rng.normal(size=(400, 3)))
    whole = sums_of(block)
    cuts = [0, 1, 2, 7, 8, 150, 151, 400]
    pieces = MovementSums(RATE_HZ)
    in_parts = np.concatenate([pieces.push(part(block, start, stop)) for start, stop in pairwise(cuts)])
    np.testing.assert_array_equal(in_parts, whole)
    assert len(pieces.push(part(block, 0, 0))) == 0


def test_a_new_segment_has_sums_of_its_own() -> None:
    block = moving(np.random.default_rng(1).normal(size=(60, 3)))
    sums = MovementSums(RATE_HZ)
    first = sums.push(block)
    sums.reset()
    np.testing.assert_array_equal(sums.push(block), first)


def test_many_spans_have_the_movement_of_each_to_the_last_bit() -> None:
    rng = np.random.default_rng(5)
    sums = sums_of(moving(rng.normal(size=(300, 3)) * rng.uniform(0.0, 9.0, (300, 1)), rng.normal(size=(300, 3))))
    ends, halves = np.array([20, 150, 151, 299]), np.array([10, 3, 50, 100])
    spans = [
        (sums[end - 2 * half], sums[end - half], sums[end], 2 * half) for end, half in zip(ends, halves, strict=True)
    ]
    rows = sums[ends - 2 * halves], sums[ends - halves], sums[ends]
    assert movements_between(*rows, 2 * halves) == [movement_between(*span) for span in spans]
    assert strengths_between(rows[0], rows[2], 2 * halves) == [strength_between(a, c, n) for a, _, c, n in spans]
