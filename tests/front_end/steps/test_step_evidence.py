"""The evidence of the default step detector by hand: peaks, walking, and the signal of a swinging phone."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from signals import RATE_HZ, level

from pdr_est.frames import Array
from pdr_est.front_end.signal.blocks import part
from pdr_est.front_end.steps.step_evidence.step_probability import PeakShape, peak_log_odds, probability
from pdr_est.front_end.steps.step_evidence.step_signal import StepSignal
from pdr_est.front_end.steps.step_evidence.walking_belief import (
    Movement,
    MovementSums,
    WalkingBelief,
    movement_between,
    strength_between,
)
from pdr_est.types.sensors import LevelBlock
from pdr_est.types.steps import CarryingMode

USUAL = PeakShape(height=2.0, rise=3.0, strength=2.0)
WALKING = Movement(acceleration_mps2=1.5, tilting=0.03, turning=0.0)
RIDING = Movement(acceleration_mps2=0.4, tilting=0.01, turning=0.0)


def times(count_s: float) -> Array:
    return np.arange(round(count_s * RATE_HZ)) / RATE_HZ


def test_the_odds_of_a_peak_by_hand() -> None:
    """At 1 m/s^2, as usual and in time, only the constant counts."""
    one = PeakShape(1.0, 1.0, 1.0)
    assert peak_log_odds(one, one, 1.0) == pytest.approx(3.04)
    doubled, halved = one._replace(rise=2.0), one._replace(strength=0.5)
    assert peak_log_odds(doubled, doubled, 1.0) == pytest.approx(3.04 + 2.02 * np.log(2.0))
    assert peak_log_odds(one, doubled, 1.0) == pytest.approx(3.04 - 1.94 * np.log(2.0))
    assert peak_log_odds(halved, one, 1.0) == pytest.approx(3.04 - 0.97 * np.log(2.0))
    assert peak_log_odds(one, one, 0.5) == pytest.approx(3.04 - 4.11 * np.log(2.0))
    assert peak_log_odds(one, one, 2.0) == pytest.approx(3.04 - 1.56 * np.log(2.0))


def test_what_is_beyond_the_limits_tells_no_more() -> None:
    assert peak_log_odds(USUAL, USUAL, 9.0) == peak_log_odds(USUAL, USUAL, 4.0)
    assert peak_log_odds(USUAL, USUAL, 0.0) == peak_log_odds(USUAL, USUAL, 0.2)
    assert np.isfinite(peak_log_odds(PeakShape(0.0, 0.0, 0.0), USUAL, 1.0))


@pytest.mark.parametrize("interval_ratio", [0.5, 0.7, 1.4, 1.9])
def test_a_peak_is_the_less_probable_the_further_it_is_from_the_rhythm(interval_ratio: float) -> None:
    assert peak_log_odds(USUAL, USUAL, interval_ratio) < peak_log_odds(USUAL, USUAL, 1.0)


def test_odds_and_probability() -> None:
    assert probability(0.0) == 0.5
    assert probability(np.log(3.0)) == pytest.approx(0.75)


def test_the_usual_shape_follows_slowly() -> None:
    assert USUAL.blended(PeakShape(1.0, 1.0, 1.0), 0.75) == pytest.approx((1.75, 2.5, 1.75))


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


def test_tilting_there_and_back_is_not_turning_over() -> None:
    t = times(4.0)
    for angle, is_turned in ((0.5 * np.sin(2.0 * np.pi * t), False), (np.where(t < 3.0, 0.0, 1.2), True)):
        up = np.stack([np.sin(angle), np.zeros(len(t)), np.cos(angle)], axis=1)
        movement = movement_of(moving(np.zeros((len(t), 3)), up))
        assert movement.tilting == pytest.approx(np.sqrt(1.0 - np.linalg.norm(up[-100:].mean(axis=0))))
        assert (movement.turning > 0.5) is is_turned
        assert is_turned or movement.turning < 1e-3


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


def test_evidence_of_walking_by_hand() -> None:
    assert Movement(1.0, 0.1, 0.0).log_odds == pytest.approx(1.6)
    assert Movement(0.5, 0.1, 0.0).log_odds == pytest.approx(1.6 - 3.19 * np.log(2.0))
    assert Movement(1.0, 0.5, 0.0).log_odds == pytest.approx(1.6 - 7.34 * np.log(0.5 / 0.4))
    assert Movement(1.0, 0.1, 0.2).log_odds == pytest.approx(1.6 - 13.19 * 0.2)
    assert Movement(9.0, 0.1, 0.0).log_odds == 2.0
    assert Movement(0.01, 0.9, 1.0).log_odds == -2.0


def test_belief_needs_more_to_change_than_to_begin() -> None:
    belief = WalkingBelief()
    assert belief.log_odds < 0.0
    belief.add(WALKING)
    assert belief.log_odds > 0.0
    for _ in range(20):
        belief.add(WALKING)
    settled = belief.log_odds
    belief.add(RIDING)
    assert 0.0 < belief.log_odds < settled
    for _ in range(20):
        belief.add(RIDING)
    assert belief.log_odds < -2.0
    for _ in range(5):
        belief.add(WALKING)
    assert belief.log_odds > 0.0
    belief.stand()
    assert belief.log_odds < 0.0


def swinging(rotation_radps: float, vertical_mps2: float, duration_s: float = 20.0) -> LevelBlock:
    """A swinging phone with a step every 0.55 s: in the acceleration, or only in the rotation."""
    t = times(duration_s)
    stride = np.sin(2.0 * np.pi * t / 1.1)
    ripple = 0.3 * np.random.default_rng(0).normal(size=len(t))
    return replace(
        level(vertical_mps2 * np.sin(4.0 * np.pi * t / 1.1) + 1.5 * stride + ripple),
        rotation_rate_radps=np.outer(rotation_radps * stride + ripple, [0.0, 1.0, 0.0]),
        mode=np.full(len(t), CarryingMode.SWING, dtype=np.int8),
    )


def signal_of(block: LevelBlock) -> Array:
    return StepSignal(0.3, 2.0, 2.0, RATE_HZ).push(block)


def test_a_swinging_phone_takes_the_signal_that_repeats_itself_better() -> None:
    """Of a strong swing whose strides hide the steps the rotation is taken; of a gentle one the acceleration."""
    strong, gentle = swinging(3.0, 0.2), swinging(0.1, 5.0)
    held = [replace(block, mode=np.ones(len(block), dtype=np.int8)) for block in (strong, gentle)]
    late = slice(round(6.0 * RATE_HZ), None)
    assert np.abs(signal_of(strong) - signal_of(held[0]))[late].min(initial=1.0) >= 0.0
    assert np.abs(signal_of(strong) - signal_of(held[0]))[late].max() > 1.0
    np.testing.assert_array_equal(signal_of(gentle)[late], signal_of(held[1])[late])


@pytest.mark.parametrize("seed", range(3))
def test_the_choice_of_the_signal_does_not_depend_on_the_cuts(seed: int) -> None:
    gentle, strong = swinging(0.1, 5.0), swinging(3.0, 0.2)
    whole, pieces = StepSignal(0.3, 2.0, 2.0, RATE_HZ), StepSignal(0.3, 2.0, 2.0, RATE_HZ)
    rng = np.random.default_rng(seed)
    for block in (gentle, strong):
        cuts = np.unique([0, *rng.integers(0, len(block), 60), len(block)]).tolist()
        in_parts = np.concatenate([pieces.push(part(block, start, stop)) for start, stop in pairwise(cuts)])
        np.testing.assert_array_equal(in_parts, whole.push(block))
