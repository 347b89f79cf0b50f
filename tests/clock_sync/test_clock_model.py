"""Clocks from messages, the line through their differences, and what is done with them."""

import numpy as np
import pytest

from pdr_est.clock_sync import ClockEstimate, apply_clock, estimate_clock_from_messages, move_fixes
from pdr_est.clock_sync.robust_line import fit_clock_line
from pdr_est.errors import RecordingError
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import DeviceRecording, Signal


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


def test_the_line_ignores_what_is_not_on_it() -> None:
    time_s = np.arange(20.0) * 60.0
    difference = 0.5 + 5e-5 * time_s
    difference[[3, 11]] += 0.5
    line = fit_clock_line(time_s, difference, 1e-4, 0.001)
    np.testing.assert_allclose(line.difference_at(time_s), 0.5 + 5e-5 * time_s, atol=1e-4)
    assert list(np.flatnonzero(~line.inlier)) == [3, 11]


def test_a_clock_is_taken_out_of_every_channel_and_of_the_fixes() -> None:
    time_s = np.linspace(0.0, 100.0, 11)
    theirs = 1.0001 * time_s + 7.0
    names = ("specific_force", "rotation_rate", "magnetic_field", "attitude", "pressure")
    values = np.ones((11, 3))
    device = DeviceRecording("b", **{name: Signal(theirs, values) for name in names})
    clock = ClockEstimate(offset_s=7.0 + 1e-4 * 50.0, skew=1e-4, sigma_s=0.01, sigma_skew=1e-5, at_s=50.0)
    moved = apply_clock(device, clock)
    for name in names:
        np.testing.assert_allclose(getattr(moved, name).time_s, time_s, atol=1e-9)
        assert getattr(moved, name).values is values
    np.testing.assert_array_equal(device.pressure.time_s, theirs)  # type: ignore[union-attr]
    assert any("100.0 ppm" in decision for decision in moved.decisions)
    (fix,) = move_fixes([PositionFix(theirs[4], np.zeros(2), np.eye(2))], clock)
    assert fix.time_s == pytest.approx(time_s[4], abs=1e-9)
    assert move_fixes([], clock) == ()


def test_a_doubtful_clock_warns() -> None:
    clock = ClockEstimate(0.0, 0.0, 1.0, doubts=("no walk",))
    assert apply_clock(DeviceRecording("b"), clock).warnings == ("clock: no walk",)


def test_uncertainty_grows_away_from_where_the_clock_is_known() -> None:
    clock = ClockEstimate(0.0, 0.0, 0.03, sigma_skew=1e-4, at_s=100.0)
    np.testing.assert_allclose(clock.sigma_at(np.array([100.0, 500.0])), [0.03, 0.05])
