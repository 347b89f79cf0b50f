"""Paired comparisons against numbers worked out by hand."""

import numpy as np
import pytest

from pdr_est.evaluate.metric_definitions import DEFINITIONS
from pdr_est.evaluate.paired_comparison import (
    MOST_RESAMPLED,
    PairedComparison,
    PairedValues,
    bootstrap_intervals,
    compare_pairs,
)
from pdr_est.experiment.suites import SUITES


def compared(metric: str, by_first: dict[str, float], by_second: dict[str, float]) -> PairedComparison:
    (found,) = compare_pairs([PairedValues(metric, "one", "two", by_first, by_second)])
    return found


def test_errors_are_compared_walk_by_walk() -> None:
    first = {"a": 3.0, "b": 5.0, "c": 4.0, "only first": 100.0}
    second = {"a": 1.0, "b": 6.0, "c": 4.0, "only second": 0.0}
    found = compared("error_open_m", first, second)
    assert (found.n, found.first_wins, found.second_wins, found.ties) == (3, 1, 1, 1)
    assert found.mean_first == pytest.approx(4.0)
    assert found.mean_second == pytest.approx(11.0 / 3.0)
    assert found.difference == pytest.approx((-2.0 + 1.0 + 0.0) / 3.0)
    assert found.low == pytest.approx(-2.0)  # one in 27 resamples holds walk a three times: above 2.5 %
    assert found.high == pytest.approx(1.0)
    assert found.better is None


def test_a_ratio_is_better_the_nearer_it_is_to_one() -> None:
    found = compared("length_ratio", {"a": 0.8, "b": 1.1}, {"a": 1.1, "b": 0.95})
    assert found.difference == pytest.approx(0.5 * ((0.1 - 0.2) + (0.05 - 0.1)))
    assert (found.first_wins, found.second_wins) == (0, 2)
    assert found.better == "two"


def test_coverage_above_its_nominal_value_is_as_wrong_as_below() -> None:
    found = compared("coverage95", {"a": 1.0}, {"a": 0.90})
    assert found.ties == 1
    assert (found.low, found.high, found.better) == (None, None, None)


def test_rounding_is_no_win() -> None:
    found = compared("error_open_m", {"a": 1.0, "b": 2.0}, {"a": 1.0 + 1e-12, "b": 2.0})
    assert (found.difference, found.ties) == (0.0, 2)


def test_no_common_walk_no_comparison() -> None:
    assert compare_pairs([PairedValues("error_open_m", "one", "two", {"a": 1.0}, {"b": 1.0})]) == ()


def test_several_pairs_are_compared_as_each_by_itself() -> None:
    rng = np.random.default_rng(3)
    values = [{f"walk{i}": float(value) for i, value in enumerate(rng.normal(size=n))} for n in (9, 9, 9, 5)]
    pairs = [PairedValues("error_open_m", "one", str(i), values[0], other) for i, other in enumerate(values[1:])]
    together = compare_pairs(pairs)
    assert [pair.n for pair in together] == [9, 9, 5]
    for pair, alone in zip(together, (compare_pairs([pair])[0] for pair in pairs), strict=True):
        assert (pair.low, pair.high) == pytest.approx((alone.low, alone.high), abs=1e-12)
        assert pair.second == alone.second


def test_the_interval_is_that_of_means_of_walks_drawn_with_replacement() -> None:
    values = np.random.default_rng(0).exponential(3.0, (2, 40))
    rng = np.random.default_rng(1)
    drawn = rng.integers(40, size=(200_000, 40))
    expected = [np.quantile(row[drawn].mean(axis=1), [0.025, 0.975]) for row in values]
    assert bootstrap_intervals(values) == pytest.approx(np.array(expected), abs=0.03)
    assert np.array_equal(bootstrap_intervals(values), bootstrap_intervals(values))


def test_the_interval_of_many_walks_goes_over_into_the_normal_one() -> None:
    values = np.random.default_rng(0).exponential(3.0, (1, MOST_RESAMPLED + 1))
    low, high = bootstrap_intervals(values)[0]
    by_drawing = bootstrap_intervals(values[:, :-1])[0]
    assert (low, high) == pytest.approx(by_drawing, abs=0.1 * (high - low))
    assert low < values.mean() < high


def test_every_metric_of_every_suite_is_defined() -> None:
    assert {metric for suite in SUITES for metric in suite.metrics} - set(DEFINITIONS) == set()
