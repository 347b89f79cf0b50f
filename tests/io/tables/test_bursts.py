"""Rows that share a stamp get the times at which they were measured, however many share one."""

import numpy as np
import pytest

from pdr_est.frames import Array
from pdr_est.io.tables.times.bursts import spread_bursts

N = 3000
ROWS_S = np.arange(N) / 50.0
VALUES = np.random.default_rng(1).normal(size=(N, 6))


def burst_of_rows(smallest: int, largest: int, seed: int = 2) -> Array:
    """Number of the burst of each row."""
    cuts = np.cumsum(np.random.default_rng(seed).integers(smallest, largest + 1, N))
    return np.searchsorted(cuts, np.arange(N), side="right")


def stamped(time_s: Array, burst: Array, *, last: bool = False) -> Array:
    """Give each row the time of the first or last row of its burst."""
    rows = [np.flatnonzero(burst == one)[-1 if last else 0] for one in range(burst.max() + 1)]
    return time_s[np.array(rows)[burst]]


@pytest.mark.parametrize(("smallest", "largest"), [(5, 15), (8, 12), (1, 60), (1, 4)])
@pytest.mark.parametrize(("last", "row"), [(False, "first"), (True, "last")])
def test_bursts_of_any_size_are_spread_at_the_rate_of_the_rows(
    smallest: int, largest: int, last: bool, row: str
) -> None:
    time_s, warning = spread_bursts(stamped(ROWS_S, burst_of_rows(smallest, largest), last=last), VALUES)
    np.testing.assert_allclose(time_s, ROWS_S, atol=1e-9)
    assert "rows share one time stamp" in warning
    assert f"at 50.0 Hz, which the stamps fit to 0 s as the times of the {row} rows" in warning


def test_late_stamps_gaps_and_a_drifting_rate_are_followed() -> None:
    burst = burst_of_rows(5, 15)
    true_s = ROWS_S * (1.0 + 1e-4 * ROWS_S / 60.0) + np.where(np.arange(N) >= 1500, 30.0, 0.0)
    burst[1500:] += int(burst[1499] == burst[1500])  # a pause ends a burst
    late_s = np.random.default_rng(4).exponential(0.02, burst.max() + 1)[burst]
    time_s, warning = spread_bursts(stamped(true_s, burst, last=True) + late_s, VALUES)
    assert (np.diff(time_s) >= 0.0).all()
    assert np.abs(time_s - true_s - 0.014).max() < 0.03
    assert "the last rows" in warning


def test_bursts_of_one_size_end_where_the_next_begins() -> None:
    time_s, warning = spread_bursts(np.repeat(ROWS_S[::10], 10), VALUES)
    np.testing.assert_allclose(time_s, ROWS_S, atol=1e-9)
    assert warning.startswith("10 rows share one time stamp, every 0.2 s")


def test_stamps_of_no_steady_rate_are_only_spread() -> None:
    steps_s = np.random.default_rng(6).exponential(0.2, 400)
    counts = np.random.default_rng(7).integers(1, 16, 400)
    stamps_s = np.repeat(np.cumsum(steps_s), counts)
    _, warning = spread_bursts(stamps_s, np.random.default_rng(1).normal(size=(len(stamps_s), 3)))
    assert "Hz" not in warning
    assert warning == "" or "until the next stamp" in warning
