"""Whose steps count: alignment of devices against all alternatives, and walks in which one device errs."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import pytest

from pdr_est.estimators.person.steps import nearest_pairs, steps_of_person
from pdr_est.frames import Array
from pdr_est.types.steps import CarryingMode
from pdr_est.types.track import Track

STEPS_S = np.arange(0.5, 15.1, 0.5)
FIRST_STEP_S = 0.6  # what the front end takes for the first step after a standstill


def device(times_s: Array, start_s: float = 0.0, stands: float = 2.0) -> Track:
    """A device that saw steps at these times, and stood where there was none for longer than `stands`."""
    times = np.concatenate([[start_s], times_s])
    begins = np.concatenate([times[:1], times[:-1]])
    begins = np.where(np.diff(times, prepend=times[0]) > stands, times - FIRST_STEP_S, begins)
    n = len(times)
    return Track(
        time_s=times,
        moving_from_s=begins,
        device=np.array(["a"] * n),
        position_m=np.zeros((n, 2)),
        heading_rad=np.zeros(n),
        covariance_m2=np.tile(np.eye(2), (n, 1, 1)),
        sigma_heading_rad=np.ones(n),
        mode=np.full(n, CarryingMode.POCKET, dtype=np.int8),
        step_length_m=np.full(n, 0.7),
        kind="filtered",
        estimator="ekf",
    )


def steps(*seen: Array) -> Array:
    return steps_of_person([device(times) for times in seen]).time_s


# --- pairs -------------------------------------------------------------------------------------------------------


def most_that_pairs_give(a_s: Sequence[float], b_s: Sequence[float], within_s: float) -> float:
    """The largest sum, by trying everything."""
    if not a_s or not b_s:
        return 0.0
    without = max(most_that_pairs_give(a_s[1:], b_s, within_s), most_that_pairs_give(a_s, b_s[1:], within_s))
    gain = within_s - abs(a_s[0] - b_s[0])
    return max(without, gain + most_that_pairs_give(a_s[1:], b_s[1:], within_s)) if gain >= 0.0 else without


def test_pairs_are_the_best_of_all() -> None:
    random = np.random.default_rng(5)
    for _ in range(60):
        a, b = (np.sort(random.uniform(0.0, 3.0, random.integers(0, 8))) for _ in range(2))
        pairs = nearest_pairs(a, b, 0.7)
        assert all(abs(a[i] - b[j]) <= 0.7 for i, j in pairs)
        assert all(i < k and j < m for (i, j), (k, m) in pairwise(pairs))
        total = sum(0.7 - abs(a[i] - b[j]) for i, j in pairs)
        assert total == pytest.approx(most_that_pairs_give(list(a), list(b), 0.7), abs=1e-12)


def test_a_step_too_many_shifts_no_pair_after_it() -> None:
    b = np.arange(0.0, 5.0, 0.5)
    a = np.sort(np.append(b, 2.25))
    assert nearest_pairs(a, b, 0.35) == [(i, i) for i in range(5)] + [(i + 1, i) for i in range(5, 10)]


def test_near_pairs_rather_than_many() -> None:
    assert nearest_pairs(np.array([0.0, 0.3]), np.array([0.3, 0.6]), 0.35) == [(1, 0)]


# --- steps -------------------------------------------------------------------------------------------------------


def test_a_step_is_where_those_who_saw_it_are_in_the_mean() -> None:
    person = steps_of_person([device(STEPS_S), device(STEPS_S + 0.2), device(STEPS_S + 0.1)])
    np.testing.assert_allclose(person.time_s, STEPS_S + 0.1)
    np.testing.assert_allclose(person.moving_from_s[1:], STEPS_S[:-1] + 0.1)


def test_phones_at_either_leg_see_the_feet_at_different_times_and_miss_some() -> None:
    limp = np.where(np.arange(len(STEPS_S)) % 2, 0.08, -0.02)
    left, right = np.delete(STEPS_S + limp, [4, 12]), np.delete(STEPS_S - limp, [7, 20])
    np.testing.assert_allclose(steps(left, right), STEPS_S, atol=0.09)


def test_clocks_that_are_more_than_half_a_step_apart_make_no_more_steps() -> None:
    assert 29 <= len(steps(STEPS_S, STEPS_S + 0.3)) <= 30


def test_a_step_amid_the_step_of_others_does_not_count() -> None:
    np.testing.assert_allclose(steps(np.sort(np.append(STEPS_S, 5.25)), STEPS_S), STEPS_S)


def test_a_phone_that_moves_alone_in_a_pause_makes_no_step() -> None:
    pause = STEPS_S[(STEPS_S < 5.1) | (STEPS_S > 6.9)]  # 5.0, then 7.0
    np.testing.assert_allclose(steps(np.sort(np.append(pause, 6.0)), pause), pause)


def test_a_rhythm_that_one_keeps_while_another_stands_must_last_to_be_a_walk() -> None:
    def seen(alone: int) -> int:
        gap = np.abs(STEPS_S - 3.1 - 0.25 * alone) < 0.25 * alone  # from 3.5 on
        return len(steps(STEPS_S, STEPS_S[~gap]))

    # The first step after a standstill is taken to last 0.6 s, so that the one before it may just have been missed.
    assert seen(6) == len(STEPS_S) - 5
    assert seen(12) == len(STEPS_S)


def test_steps_in_a_gap_of_another_recording_count() -> None:
    hidden = (STEPS_S > 3.1) & (STEPS_S < 6.1)
    bridged = device(STEPS_S[~hidden], stands=np.inf)  # moving all the time, as the bridge over a gap says
    person = steps_of_person([device(STEPS_S), bridged])
    np.testing.assert_allclose(person.time_s, STEPS_S)


def test_a_device_that_comes_later_or_stops_earlier_leaves_the_steps_to_the_others() -> None:
    late = device(STEPS_S[10:], start_s=5.3)
    np.testing.assert_allclose(steps_of_person([device(STEPS_S), late]).time_s, STEPS_S)
    np.testing.assert_allclose(steps(STEPS_S[:20], STEPS_S), STEPS_S)


def test_a_jolt_after_the_last_step_does_not_count() -> None:
    np.testing.assert_allclose(steps(np.append(STEPS_S, STEPS_S[-1] + 0.55), STEPS_S), STEPS_S)


def test_it_does_not_matter_which_of_two_devices_is_the_first() -> None:
    random = np.random.default_rng(3)
    for _ in range(10):
        a, b = (np.sort(random.choice(STEPS_S, 25, replace=False)) + random.normal(0.0, 0.02, 25) for _ in range(2))
        np.testing.assert_allclose(steps(a, b), steps(b, a))


def test_what_comes_later_changes_the_last_steps_at_most() -> None:
    left, right = np.delete(STEPS_S, [4, 12]), np.delete(STEPS_S + 0.1, [7, 20])
    whole = steps(left, right)
    for until_s in np.arange(4.0, 15.0, 0.7):
        part = steps(left[left < until_s], right[right < until_s])
        settled = until_s - 2.0
        np.testing.assert_array_equal(part[part < settled], whole[whole < settled])


def test_devices_without_steps() -> None:
    none = np.empty(0)
    assert len(steps(none, none)) == 0
    np.testing.assert_allclose(steps(none, STEPS_S), STEPS_S)
    np.testing.assert_allclose(steps(STEPS_S, none), STEPS_S)
