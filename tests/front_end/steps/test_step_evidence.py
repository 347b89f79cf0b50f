"""The evidence of the default step detector by hand: peaks, walking, and the signal of a swinging phone."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from signals import RATE_HZ, level

from pdr_est.frames import Array
from pdr_est.front_end.signal.blocks import part
from pdr_est.front_end.steps.step_evidence.movement import Movement, MovementSums
from pdr_est.front_end.steps.step_evidence.step_intervals import hidden_step_log_odds
from pdr_est.front_end.steps.step_evidence.step_probability import PeakShape, peak_log_odds, probability
from pdr_est.front_end.steps.step_evidence.step_signal import StepSignal
from pdr_est.front_end.steps.step_evidence.stride_likeness import StrideLikeness, horizontal_patterns
from pdr_est.front_end.steps.step_evidence.walking_belief import (
    STRONG_MPS2,
    USUAL_LIKENESS,
    PeakRhythm,
    WalkingBelief,
    walking_evidence,
)
from pdr_est.types.sensors import LevelBlock
from pdr_est.types.steps import CarryingMode

USUAL = PeakShape(height=2.0, rise=3.0, strength=2.0)


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


STEADY = PeakRhythm(interval_s=0.5, previous_s=0.5, one_before_s=0.5, rise_mps2=3.0)
WALKING = Movement(acceleration_mps2=1.5, vertical_share=0.5, sideways_tilt_rad=0.03)
RIDING = Movement(acceleration_mps2=0.4, vertical_share=0.5, sideways_tilt_rad=0.01)
SURE = 2.7 - 3.5 * 0.05  # the constant, and the steadiest rhythm


def test_evidence_of_walking_by_hand() -> None:
    assert walking_evidence(WALKING, STEADY) == 2.0  # no peak tells more
    slow = STEADY._replace(interval_s=1.4, previous_s=1.4)
    assert walking_evidence(WALKING, slow) == pytest.approx(SURE - 0.9 * np.log(1.4 / 0.6))
    weak = WALKING._replace(acceleration_mps2=0.6)
    assert walking_evidence(weak, STEADY) == pytest.approx(SURE + 6.0 * np.log(0.6 / 0.9))
    level_ = WALKING._replace(vertical_share=0.1)
    assert walking_evidence(level_, STEADY) == pytest.approx(SURE + 1.2 * np.log(0.1 / 0.4))
    assert walking_evidence(RIDING, STEADY) == -2.0


def test_a_hand_that_turns_the_phone_over_reaches_further_than_a_walker() -> None:
    """Neither a high bounce nor a tilt to the side speaks against walking, but both together do."""
    high = STEADY._replace(rise_mps2=12.0)
    assert high.bounce_m == pytest.approx(12.0 * (0.5 / (2.0 * np.pi)) ** 2)
    turned = WALKING._replace(sideways_tilt_rad=0.2)
    assert walking_evidence(WALKING, high) == walking_evidence(turned, STEADY._replace(rise_mps2=2.0)) == 2.0
    reach = high.bounce_m * 0.2 / (0.045 * 0.07)
    assert walking_evidence(turned, high) == pytest.approx(SURE - 1.9 * np.log(reach))


@pytest.mark.parametrize(
    ("interval_s", "previous_s", "one_before_s", "change"),
    [
        (0.6, 0.5, np.inf, np.log(1.2)),
        (0.6, 0.5, 0.6, 0.05),  # feet that differ
        (0.5, 0.5, 0.5, 0.05),
        (1.5, 0.5, 0.5, 0.6),
        (0.5, np.inf, np.inf, 0.3),
        (np.inf, 0.5, 0.5, 0.3),
    ],
)
def test_change_of_the_rhythm(interval_s: float, previous_s: float, one_before_s: float, change: float) -> None:
    assert PeakRhythm(interval_s, previous_s, one_before_s, 1.0).change == pytest.approx(change)


def test_the_rhythm_passes_on() -> None:
    assert STEADY.followed_by(0.7, 2.0) == PeakRhythm(0.7, 0.5, 0.5, 2.0)


def test_belief_needs_more_to_change_than_to_begin() -> None:
    belief = WalkingBelief()
    assert belief.log_odds < 0.0
    belief.add(walking_evidence(WALKING, STEADY))
    assert belief.log_odds > 0.0
    for _ in range(20):
        belief.add(walking_evidence(WALKING, STEADY))
    settled = belief.log_odds
    belief.add(walking_evidence(RIDING, STEADY))
    assert 0.0 < belief.log_odds < settled
    for _ in range(20):
        belief.add(walking_evidence(RIDING, STEADY))
    ridden = belief.log_odds
    assert ridden < -4.0
    assert not belief.rode
    belief.stand()
    assert belief.rode
    assert ridden < belief.log_odds < -2.0
    for _ in range(4):
        belief.add(walking_evidence(WALKING, STEADY))
    assert belief.log_odds > 0.0
    belief.stand()
    assert not belief.rode
    assert belief.log_odds == WalkingBelief().log_odds


def pattern_of(horizontal_mps2: Array, at_s: Array) -> list[Array | None]:
    """Patterns before times of a phone that lies flat and is accelerated along x."""
    block = level(np.zeros(len(horizontal_mps2)))
    acceleration = np.stack([horizontal_mps2, np.zeros(len(block)), np.zeros(len(block))], axis=1)
    sums = MovementSums(RATE_HZ).push(replace(block, acceleration_mps2=acceleration))
    places = np.round(at_s * RATE_HZ).astype(np.intp)
    return horizontal_patterns(sums, places, [RIDING] * len(places), RATE_HZ)


def test_strides_that_repeat_themselves_are_alike() -> None:
    t = times(12.0)
    steps_s = np.arange(4.0, 11.0, 0.55)
    stride, other = np.sin(2.0 * np.pi * t / 1.1), np.random.default_rng(0).normal(size=len(t))
    found = []
    for signal in (stride, other, 0.01 * other):
        likeness = StrideLikeness()
        found.append([likeness.add(pattern) for pattern in pattern_of(2.0 * signal, steps_s)])
        assert found[-1][:2] == [None, None]  # nothing to compare with
    alike, unlike, weak = (np.array(row[4:], dtype=np.float64) for row in found)
    assert alike.min() > 0.95
    assert np.abs(unlike).mean() < 0.25
    np.testing.assert_allclose(weak, USUAL_LIKENESS, atol=0.05)  # what is too weak tells nothing


def test_feet_are_compared_with_themselves() -> None:
    """Steps of one foot are the opposite of the other's, as a swaying trunk has them."""
    t = times(12.0)
    patterns = pattern_of(2.0 * np.sin(2.0 * np.pi * t / 1.1), np.arange(4.0, 11.0, 0.55))
    one, other = patterns[5], patterns[6]
    assert one is not None
    assert other is not None
    assert float(one @ other) < -0.9


def test_likeness_does_not_count_for_a_strong_movement() -> None:
    likeness = StrideLikeness()
    assert likeness.add(None) is None
    strong = [WALKING._replace(acceleration_mps2=STRONG_MPS2)]
    sums = MovementSums(RATE_HZ).push(level(np.ones(100)))
    assert horizontal_patterns(sums, np.array([90]), strong, RATE_HZ) == [None]
    assert walking_evidence(strong[0], STEADY, -1.0) == walking_evidence(strong[0], STEADY)


def test_evidence_of_likeness_by_hand() -> None:
    gentle = WALKING._replace(acceleration_mps2=0.9)
    doubt = 7.0 * np.log(2.0 / 0.9)
    assert walking_evidence(gentle, STEADY, 0.1) == pytest.approx(SURE + doubt * (0.1 - 0.45))
    assert walking_evidence(gentle, STEADY, USUAL_LIKENESS) == walking_evidence(gentle, STEADY)
    weak, weaker = (gentle._replace(acceleration_mps2=strength) for strength in (0.75, 0.7))
    assert walking_evidence(weak, STEADY, 0.5) == walking_evidence(weak, STEADY, 1.0)
    assert walking_evidence(weaker, STEADY, 0.4) < walking_evidence(weak, STEADY, 0.4)


REGULAR = {"ratio": 2.0, "last_ratio": 1.0, "same_foot_ratio": 2.0, "strength_ratio": 1.0}


@pytest.mark.parametrize(
    "changes",
    [
        {"ratio": 1.5},
        {"ratio": 3.0},  # of two steps
        {"last_ratio": 0.6},  # after a step that was found too early
        {"same_foot_ratio": 1.0},  # of somebody who limps
        {"strength_ratio": 0.3},  # of somebody who stands for a moment
    ],
)
def test_a_pause_hides_a_step_if_it_fits_the_rhythm(changes: dict[str, float]) -> None:
    regular = hidden_step_log_odds(**REGULAR)
    assert regular > 3.0
    assert hidden_step_log_odds(**(REGULAR | changes)) < regular - 1.0


def test_hidden_step_by_hand() -> None:
    expected = -1.2 + 1.8 * np.log(2.1) - 8.5 * np.log(1.05) + 5.5 * np.log(1.9) + 12.0 * np.log(2.9 / 3.0)
    assert hidden_step_log_odds(2.1, 0.8, 1.9, 0.8) == pytest.approx(expected + 3.0 * np.log(0.8))


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
