"""What a numeric clock counts, by its values."""

import numpy as np
import pytest
from table_walk import table_walk

from pdr_est.frames import Array
from pdr_est.io.tables.times.clock_units import detect_clock_unit, seconds_before_1970
from pdr_est.io.tables.times.unset import unset_rows

TIME_S = np.arange(500) / 50.0
UNIX_S = 1_927_000_000.0


@pytest.mark.parametrize(
    ("start", "per_s"),
    [
        (0, 1.0),
        (0, 1e3),
        (0, 1e6),
        (0, 1e9),
        (86_400, 1e9),  # since boot
        (1_718_030_736, 1.0),
        (1_718_030_736, 1e3),
        (1_718_030_736, 1e9),
    ],
)
@pytest.mark.parametrize("rate_hz", [25.0, 100.0, 500.0])
def test_the_unit_of_a_clock(start: float, per_s: float, rate_hz: float) -> None:
    conversion = detect_clock_unit((start + np.arange(1000) / rate_hz) * per_s)
    assert conversion.factor == pytest.approx(1.0 / per_s)
    assert conversion.warning == ""


def test_a_clock_that_stands_still_is_doubted() -> None:
    assert detect_clock_unit(np.zeros(10)).warning


@pytest.mark.parametrize(
    ("tick_s", "before_1970_s"),
    [
        (1e-7, 62_135_596_800.0),
        (1e-7, 11_644_473_600.0),
        (1e-6, 11_644_473_600.0),
        (86_400.0, 25_569.0 * 86_400.0),
        (86_400.0, 719_529.0 * 86_400.0),
        (86_400.0, 2_440_587.5 * 86_400.0),
    ],
    ids=[".NET", "Windows", "browsers", "spreadsheets", "MATLAB", "astronomers"],
)
def test_clocks_that_count_from_long_ago(tick_s: float, before_1970_s: float) -> None:
    ticks = (before_1970_s + UNIX_S + TIME_S) / tick_s
    found = detect_clock_unit(ticks if tick_s > 1.0 else np.round(ticks).astype(np.int64))
    assert (found.factor, found.warning) == (tick_s, "")
    assert seconds_before_1970(float(ticks[0]) * tick_s, tick_s) == before_1970_s


def test_the_date_of_a_boot_clock_is_not_known() -> None:
    assert seconds_before_1970(86_400.0, 1.0) is None
    assert seconds_before_1970(UNIX_S, 1.0) == 0.0
    assert seconds_before_1970(3e11, 1e-6) is None


@pytest.mark.parametrize("every", [1, 10])
def test_slow_rows_in_us_or_fast_ones_in_units_of_100_ns(every: int) -> None:
    """200 000 ticks from row to row are 5 Hz in us and 50 Hz in units of 100 ns."""
    walk = table_walk()
    values = np.hstack([walk.force, walk.rate])[::every]
    found = detect_clock_unit(200_000 * np.arange(len(values)), lambda: values)
    assert found.factor == (1e-7 if every == 1 else 1e-6)
    assert "may count us or units of 100 ns" in found.warning


def test_a_unit_that_cannot_be_told_is_described_by_span_and_rate() -> None:
    found = detect_clock_unit(TIME_S / 60.0)
    assert found.factor == 1.0
    assert "spans 0.1663 s for 500 rows, 3000 a second" in found.warning


@pytest.mark.parametrize(
    ("ticks", "rows"),
    [
        (np.r_[TIME_S[:9] + UNIX_S, 0.0, TIME_S[9:] + UNIX_S], [9]),
        (np.r_[0.0, 0.0, TIME_S + 3600.0], [0, 1]),
        (np.r_[TIME_S, 0.0], []),
        (np.zeros(9), []),
    ],
)
def test_a_time_of_zero_among_others_is_none(ticks: Array, rows: list[int]) -> None:
    assert np.flatnonzero(unset_rows(ticks, np.isfinite(ticks))).tolist() == rows
