"""Strides by two steps and by time: shares of steps, doubles, and what is left out."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from pdr_est.evaluate.stride_lengths import (
    lengths_by_time,
    lengths_by_two_steps,
    scored_strides,
    step_shares,
    stride_error,
)
from pdr_est.types.ground_truth import TrueStrides

STEP_ENDS_S = np.arange(1.0, 9.0) * 0.5  # eight steps of 0.5 s
LENGTH_M = np.array([0.5, 0.7, 0.6, 0.6, 0.8, 0.8, 0.8, 0.8])


def strides(*ends_s: float, length_m: float = 1.2) -> TrueStrides:
    ends = np.array(ends_s)
    return TrueStrides(ends[:-1], ends[1:], np.full(len(ends) - 1, length_m))


def share_of(truth: TrueStrides) -> np.ndarray:
    return step_shares(STEP_ENDS_S - 0.5, STEP_ENDS_S, truth)


def test_strides_that_end_with_steps_are_the_same_by_both_rules() -> None:
    share = share_of(strides(0.0, 1.0, 2.0, 4.0))
    assert_allclose(lengths_by_time(share, LENGTH_M), [1.2, 1.2, 3.2])
    assert_allclose(lengths_by_two_steps(share, LENGTH_M), [1.2, 1.2, 3.2])  # the last is two in one


def test_scatter_of_the_ends_goes_into_the_length_by_time_alone() -> None:
    share = share_of(strides(2.0, 3.1, 4.0))
    assert_allclose(share[0], [0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.2, 0.0], atol=1e-12)
    assert_allclose(lengths_by_time(share, LENGTH_M), [1.76, 1.44])
    assert_allclose(lengths_by_two_steps(share, LENGTH_M), [1.6, 1.6])


@pytest.mark.parametrize(("duration_s", "expected"), [(0.3, 1), (1.4, 1), (1.6, 2), (2.4, 2), (2.6, 3)])
def test_the_number_of_strides_is_half_that_of_the_steps_rounded(duration_s: float, expected: int) -> None:
    share = step_shares(STEP_ENDS_S - 0.5, STEP_ENDS_S, strides(0.2, 0.2 + duration_s))
    assert_allclose(lengths_by_two_steps(share, np.full(8, 0.7)), [1.4 * expected])


def test_a_stride_without_steps_has_no_length() -> None:
    share = share_of(strides(6.0, 7.0))
    assert lengths_by_time(share, LENGTH_M).tolist() == [0.0]
    assert lengths_by_two_steps(share, LENGTH_M).tolist() == [0.0]
    assert lengths_by_two_steps(np.zeros((1, 0)), np.zeros(0)).tolist() == [0.0]


def test_the_last_and_the_too_long_are_not_scored() -> None:
    truth = TrueStrides(np.arange(4.0), np.arange(1.0, 5.0), np.array([1.2, 3.0, 3.01, 1.1]))
    kept = scored_strides(truth)
    assert (kept.start_s.tolist(), kept.end_s.tolist(), kept.length_m.tolist()) == (
        [0.0, 1.0],
        [1.0, 2.0],
        [1.2, 3.0],
    )
    nothing = np.zeros(0)
    assert len(scored_strides(TrueStrides(nothing, nothing, nothing)).length_m) == 0


def test_the_error_is_relative_to_each_stride() -> None:
    assert stride_error(np.array([1.1, 1.8]), np.array([1.0, 2.0])) == pytest.approx(0.1)
