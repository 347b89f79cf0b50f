import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import linear_sum_assignment

from pdr_est.evaluate import step_detection as steps

TRUE_S = np.arange(10.0, 20.0, 0.5)
# Multiples of 2**-10 s: exact in binary, so that a shift breaks no tie.
TIMES = st.lists(st.integers(0, 4096).map(lambda n: n / 1024.0), max_size=12).map(lambda t: np.array(sorted(t)))


def values(detected_s, true_s=TRUE_S):
    return steps.score_steps(np.asarray(detected_s, dtype=np.float64), np.asarray(true_s, dtype=np.float64)).values()


@pytest.mark.parametrize("offset_s", [-0.2, 0.0, 0.24])
def test_the_same_steps_a_fixed_time_off_are_all_right(offset_s):
    assert values(TRUE_S + offset_s) == {"count_error": 0.0, "step_precision": 1.0, "step_recall": 1.0}


def test_a_missed_and_a_false_step_by_hand():
    # 20 true steps; number 5 is missed, two false ones stand between others: 21 detected, 19 pairs.
    detected = np.sort(np.append(np.delete(TRUE_S, 5), [17.26, 18.26]))
    assert values(detected) == pytest.approx(
        {"count_error": 1 / 20, "step_precision": 19 / 21, "step_recall": 19 / 20}
    )


def test_steps_outside_the_annotated_span_do_not_count():
    outside = [8.0, 9.0, 9.69, 19.81, 21.0]
    assert values(np.sort(np.append(TRUE_S, outside)))["step_precision"] == 1.0
    within_the_tolerance = [9.71, 19.79]
    assert values(np.sort(np.append(TRUE_S, within_the_tolerance)))["count_error"] == pytest.approx(2 / 20)


def test_the_span_is_that_of_the_steps_without_their_offset():
    # All are 0.2 s early, the last one at 19.3 s. One more 0.35 s later is 0.15 s after the last true step, but
    # 0.35 s after it without the offset.
    early = np.append(TRUE_S - 0.2, 19.5 - 0.2 + 0.35)
    assert values(early) == {"count_error": 0.0, "step_precision": 1.0, "step_recall": 1.0}
    late = np.append(10.0 + 0.2 - 0.35, TRUE_S + 0.2)
    assert values(late) == {"count_error": 0.0, "step_precision": 1.0, "step_recall": 1.0}


def test_a_step_too_far_from_its_own_is_no_match():
    assert values([0.0, 0.6, 1.2, 1.8 + 0.31], [0.0, 0.6, 1.2, 1.8])["step_recall"] == pytest.approx(0.75)
    assert values([0.0, 0.6, 1.2, 1.8 + 0.29], [0.0, 0.6, 1.2, 1.8])["step_recall"] == 1.0


def test_nothing_detected():
    found = values([])
    assert (found["count_error"], found["step_recall"]) == (1.0, 0.0)
    assert math.isnan(found["step_precision"])


def test_offset_by_hand():
    # Nearest detected less true: 0.1, -0.2, 0.3; median 0.1.
    assert steps.median_offset(np.array([1.1, 1.8, 3.3]), np.array([1.0, 2.0, 3.0])) == pytest.approx(0.1)


def test_the_tolerance_itself_is_near_enough():
    assert steps.largest_matching(np.array([0.0]), np.array([0.25]), 0.25) == 1


@given(TIMES, TIMES)
@settings(deadline=None, max_examples=200)
def test_matching_is_the_largest_one(a, b):
    near = np.abs(a[:, None] - b[None, :]) <= 0.3
    rows, columns = linear_sum_assignment(near, maximize=True)
    assert steps.largest_matching(a, b, 0.3) == near[rows, columns].sum() == steps.largest_matching(b, a, 0.3)


@given(TIMES, TIMES.filter(len), st.integers(-100, 100))
@settings(deadline=None, max_examples=100)
def test_counts_are_consistent_and_a_common_shift_changes_no_offset(detected, true, shift_s):
    score = steps.score_steps(detected, true)
    assert 0 <= score.matched <= min(score.detected, score.true)
    assert score.detected <= len(detected)
    moved = steps.median_offset(detected + shift_s, true + shift_s)
    assert moved == pytest.approx(score.offset_s, abs=0.0, nan_ok=True)


def test_false_steps_per_minute():
    assert steps.steps_per_minute(3, (10.0, 100.0)) == pytest.approx(2.0)
    assert math.isnan(steps.steps_per_minute(0, (1.0, 1.0)))
