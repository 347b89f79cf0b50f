"""Samples of many steps: each step keeps its own, and has the same sums in whatever batch it comes."""

import numpy as np
from signals import step

from pdr_est.front_end.signal.step_samples import StepSamples, of_equal_count, rows_from

COUNTS = (7, 3, 7, 1, 30, 3)


def steps_of_all_counts() -> list:
    rng = np.random.default_rng(0)
    return [step(k + 1.0, k + 0.5, vertical_mps2=rng.normal(size=count)) for k, count in enumerate(COUNTS)]


def sums(steps: list) -> np.ndarray:
    samples = StepSamples(steps)
    vertical, total = samples.column("vertical_mps2"), np.full(len(steps), np.nan)
    for count, places in of_equal_count(samples.count):
        total[places] = rows_from(vertical, samples.start[places], count).sum(axis=1)
    return total


def test_steps_with_as_many_samples_come_together_in_their_order() -> None:
    groups = {count: places.tolist() for count, places in of_equal_count(StepSamples(steps_of_all_counts()).count)}
    assert groups == {1: [3], 3: [1, 5], 7: [0, 2], 30: [4]}


def test_each_row_has_the_samples_of_its_step() -> None:
    steps = steps_of_all_counts()
    samples = StepSamples(steps)
    up = samples.column("up")
    assert rows_from(up, samples.start[[0, 2]], 7).shape == (2, 7, 3)
    for one, start, count in zip(steps, samples.start, samples.count, strict=True):
        (row,) = rows_from(samples.column("vertical_mps2"), np.array([start]), int(count))
        np.testing.assert_array_equal(row, one.samples.vertical_mps2)


def test_a_step_has_the_same_sum_alone_and_with_others_to_the_last_bit() -> None:
    steps = steps_of_all_counts()
    np.testing.assert_array_equal(sums(steps), [sums([one])[0] for one in steps])
    np.testing.assert_array_equal(sums(steps), [one.samples.vertical_mps2.sum() for one in steps])
