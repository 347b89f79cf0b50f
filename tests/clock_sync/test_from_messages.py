"""The clock of a device from the messages that it answered."""

import numpy as np
import pytest

from pdr_est.clock_sync import estimate_clock_from_messages
from pdr_est.errors import RecordingError


def test_one_exchange_is_the_paper_s_formula() -> None:
    clock = estimate_clock_from_messages(np.array([10.0]), np.array([112.5]), np.array([10.2]))
    assert clock.offset_s == pytest.approx(112.5 - 10.1, abs=1e-9)
    assert clock.sigma_s == pytest.approx(0.1 / np.sqrt(3.0), rel=0.01)
    assert clock.method == "messages"


@pytest.mark.parametrize("share", [0.0, 0.3, 1.0])
def test_the_offset_is_never_wrong_by_more_than_half_the_round_trip(share: float) -> None:
    """Whatever share of the round trip is on the way there."""
    t1 = np.array([5.0])
    clock = estimate_clock_from_messages(t1, t1 + share * 0.08 + 3.0, t1 + 0.08)
    assert abs(clock.offset_s - 3.0) <= 0.04 + 1e-9


def test_several_exchanges_give_the_skew_and_queues_do_not_matter() -> None:
    rng = np.random.default_rng(0)
    t1 = np.linspace(0.0, 1800.0, 40)
    there, back = 0.01 + 0.002 * rng.random((2, 40))
    there[::5] += 0.4  # waited in a queue, one way
    t2 = 1.0001 * (t1 + there) + 2.0
    clock = estimate_clock_from_messages(t1, t2, t1 + there + back)
    times = np.linspace(0.0, 1800.0, 7)
    np.testing.assert_allclose(clock.offset_at(times), 1e-4 * times + 2.0, atol=0.003)
    assert not clock.poor


def test_slow_messages_are_doubted() -> None:
    assert estimate_clock_from_messages(np.array([0.0]), np.array([0.5]), np.array([1.0])).poor


def test_unusable_messages_are_refused() -> None:
    with pytest.raises(RecordingError, match="one of each"):
        estimate_clock_from_messages(np.zeros(2), np.zeros(1), np.zeros(2))
    with pytest.raises(RecordingError, match="no answer"):
        estimate_clock_from_messages(np.array([1.0]), np.array([1.0]), np.array([0.0]))
    with pytest.raises(RecordingError, match="finite"):
        estimate_clock_from_messages(np.array([np.nan]), np.array([1.0]), np.array([0.0]))
