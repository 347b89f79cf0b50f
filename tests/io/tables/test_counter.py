"""Counters that overflow go on rising; nothing else is changed."""

import numpy as np
import pytest

from pdr_est.io.tables.times.counter import unwrap_counter


@pytest.mark.parametrize("bits", [16, 32])
def test_a_counter_goes_on_where_it_overflows(bits: int) -> None:
    true = np.arange(2**bits - 500, 2**bits + 500, 10, dtype=np.int64)
    assert np.array_equal(unwrap_counter(true % 2**bits), true)


@pytest.mark.parametrize(
    "ticks",
    [
        np.array([100, 200, 300, 0, 100]),  # a restart
        np.array([998, 999, 0, 1]),  # milliseconds of a second
        np.array([59_980, 0, 20]),  # milliseconds of a minute
        np.array([999_999_000, 10_000]),  # nanoseconds of a second
        np.array([2**40, 2**40 + 1]),
        np.array([-1, 5]),
    ],
)
def test_other_columns_stay_as_they_are(ticks: np.ndarray[tuple[int], np.dtype[np.int64]]) -> None:
    assert unwrap_counter(ticks) is ticks


def test_numbers_with_fractions_stay_as_they_are() -> None:
    ticks = np.array([65_535.0, 0.0])
    assert unwrap_counter(ticks) is ticks
