"""Paired comparisons against numbers worked out by hand."""

import numpy as np
import pytest

from pdr_est.evaluate.metric_definitions import DEFINITIONS
from pdr_est.evaluate.paired_comparison import bootstrap_interval, compare_paired
from pdr_est.experiment.suites import SUITES


def test_errors_are_compared_walk_by_walk() -> None:
    first = {"a": 3.0, "b": 5.0, "c": 4.0, "only first": 100.0}
    second = {"a": 1.0, "b": 6.0, "c": 4.0, "only second": 0.0}
    found = compare_paired("error_open_m", "one", "two", first, second)
    assert found is not None
    assert (found.n, found.first_wins, found.second_wins, found.ties) == (3, 1, 1, 1)
    assert found.mean_first == pytest.approx(4.0)
    assert found.mean_second == pytest.approx(11.0 / 3.0)
    assert found.difference == pytest.approx((-2.0 + 1.0 + 0.0) / 3.0)
    assert found.low == pytest.approx(-2.0)  # one in 27 resamples holds walk a three times: above 2.5 %
    assert found.high == pytest.approx(1.0)
    assert found.better is None


def test_a_ratio_is_better_the_nearer_it_is_to_one() -> None:
    found = compare_paired("length_ratio", "one", "two", {"a": 0.8, "b": 1.1}, {"a": 1.1, "b": 0.95})
    assert found is not None
    assert found.difference == pytest.approx(0.5 * ((0.1 - 0.2) + (0.05 - 0.1)))
    assert (found.first_wins, found.second_wins) == (0, 2)
    assert found.better == "two"


def test_coverage_above_its_nominal_value_is_as_wrong_as_below() -> None:
    found = compare_paired("coverage95", "one", "two", {"a": 1.0}, {"a": 0.90})
    assert found is not None
    assert found.ties == 1
    assert (found.low, found.high, found.better) == (None, None, None)


def test_rounding_is_no_win() -> None:
    found = compare_paired("error_open_m", "one", "two", {"a": 1.0, "b": 2.0}, {"a": 1.0 + 1e-12, "b": 2.0})
    assert found is not None
    assert (found.difference, found.ties) == (0.0, 2)


def test_no_common_walk_no_comparison() -> None:
    assert compare_paired("error_open_m", "one", "two", {"a": 1.0}, {"b": 1.0}) is None


def test_the_interval_is_that_of_the_mean_and_always_the_same() -> None:
    values = np.random.default_rng(0).normal(3.0, 2.0, 400)
    low, high = bootstrap_interval(values)
    assert (low, high) == bootstrap_interval(values)
    assert low == pytest.approx(values.mean() - 1.96 * values.std() / 20.0, abs=0.02)
    assert high == pytest.approx(values.mean() + 1.96 * values.std() / 20.0, abs=0.02)


def test_every_metric_of_every_suite_is_defined() -> None:
    assert {metric for suite in SUITES for metric in suite.metrics} - set(DEFINITIONS) == set()
