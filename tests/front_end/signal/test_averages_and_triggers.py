"""Moving averages and triggers by hand, and the same to the last bit for every way of cutting."""

from itertools import pairwise

import numpy as np
import pytest

from pdr_est.front_end.signal.event_detection import RefractoryPeriod, SchmittTrigger
from pdr_est.front_end.signal.moving_average import MovingAverage
from pdr_est.online.saved_state import pack, unpack


def test_the_mean_of_the_latest_window_by_hand() -> None:
    average = MovingAverage(window_s=0.3, rate_hz=10.0)
    np.testing.assert_allclose(average.push(np.array([3.0, 6.0, 0.0, 0.0, 9.0])), [3.0, 4.0, 3.0, 2.0, 3.0])
    assert average.delay_s == pytest.approx(0.1)


def test_a_reset_average_begins_anew() -> None:
    average = MovingAverage(window_s=0.3, rate_hz=10.0)
    average.push(np.array([100.0, -100.0]))
    average.reset()
    np.testing.assert_allclose(average.push(np.array([5.0, 8.0])), [5.0, 6.0])


def test_a_window_shorter_than_a_sample_changes_nothing() -> None:
    average, signal = MovingAverage(window_s=0.001, rate_hz=10.0), np.array([1.0, -2.0, 4.0])
    np.testing.assert_allclose(average.push(signal), signal)
    assert average.delay_s == 0.0


def test_columns_are_averaged_each_on_its_own() -> None:
    signal = np.random.default_rng(0).standard_normal((40, 3))
    together = MovingAverage(0.7, 10.0).push(signal)
    for column in range(3):
        np.testing.assert_array_equal(together[:, column], MovingAverage(0.7, 10.0).push(signal[:, column]))


def cuts(count: int, rng: np.random.Generator) -> list[tuple[int, int]]:
    """Random borders, some of them twice."""
    return list(pairwise([0, *np.sort(rng.integers(0, count + 1, 12)).tolist(), count]))


@pytest.mark.parametrize("seed", range(20))
def test_cuts_change_no_bit_of_an_average(seed: int) -> None:
    rng = np.random.default_rng(seed)
    signal = 9.8 + rng.standard_normal((200, 3))
    expected = MovingAverage(0.2, 50.0).push(signal)
    average, pieces = MovingAverage(0.2, 50.0), []
    for start, stop in cuts(len(signal), rng):
        pieces.append(average.push(signal[start:stop]))
        average = unpack(pack(average), MovingAverage)
    assert np.concatenate(pieces).tobytes() == expected.tobytes()


def test_a_trigger_fires_once_after_each_arming() -> None:
    arms = np.array([0, 0, 1, 1, 0, 0, 0, 1, 0, 1], dtype=bool)
    fires = np.array([1, 0, 0, 0, 0, 1, 1, 0, 1, 0], dtype=bool)
    assert SchmittTrigger().push(arms, fires).tolist() == [5, 8]


def test_a_trigger_stays_armed_from_block_to_block_until_it_is_reset() -> None:
    yes, no = np.array([True]), np.array([False])
    trigger = SchmittTrigger()
    assert trigger.push(yes, no).tolist() == []
    assert trigger.push(no, no).tolist() == []
    assert trigger.push(no, yes).tolist() == [0]
    assert trigger.push(no, yes).tolist() == []
    trigger.push(yes, no)
    trigger.reset()
    assert trigger.push(no, yes).tolist() == []


@pytest.mark.parametrize("seed", range(20))
def test_cuts_do_not_matter_to_a_trigger(seed: int) -> None:
    rng = np.random.default_rng(seed)
    signal = rng.standard_normal(200)
    expected = SchmittTrigger().push(signal < -1.0, signal > 1.0)
    trigger, found = SchmittTrigger(), []
    for start, stop in cuts(len(signal), rng):
        part = signal[start:stop]
        found += (start + trigger.push(part < -1.0, part > 1.0)).tolist()
    assert found == expected.tolist()


@pytest.mark.parametrize("offset_s", [0.0, 0.013, 12.34, 4321.0987, 1.7e9 + 0.21])
def test_exactly_the_refractory_time_later_is_late_enough(offset_s: float) -> None:
    """Ten samples at 50 Hz are 0.2 s, wherever the clock stands and whatever rounding makes of the difference."""
    times_s = offset_s + np.arange(60) / 50.0
    for first in range(40):
        refractory = RefractoryPeriod(0.2)
        found = [refractory.accepts(float(times_s[first + k])) for k in (0, 9, 10)]
        assert found == [True, False, True]


def test_a_refractory_time_begins_with_what_was_accepted() -> None:
    refractory = RefractoryPeriod(0.3)
    assert [refractory.accepts(time_s) for time_s in (-5.0, -4.8, -4.69, -4.4, -4.38)] == [
        True,
        False,
        True,
        False,
        True,
    ]
