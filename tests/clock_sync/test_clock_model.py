"""An estimated clock is applied to recordings and fixes."""

import numpy as np
import pytest

from pdr_est.clock_sync import ClockEstimate, apply_clock, move_fixes
from pdr_est.types.measurements import PositionFix
from pdr_est.types.recording import DeviceRecording, Signal


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
