"""Clock models and annotated modes."""

import numpy as np

from pdr_est.types.clock import ClockEstimate
from pdr_est.types.ground_truth import TrueModes
from pdr_est.types.steps import CarryingMode


def test_clock_times_go_there_and_back() -> None:
    clock = ClockEstimate(offset_s=2.5, skew=1e-4, sigma_s=0.03, sigma_skew=1e-5, at_s=100.0)
    reference_s = np.array([0.0, 100.0, 5000.0])
    np.testing.assert_allclose(clock.offset_at(reference_s), [2.49, 2.5, 2.99])
    np.testing.assert_allclose(clock.to_reference(reference_s + clock.offset_at(reference_s)), reference_s)
    np.testing.assert_allclose(clock.sigma_at(reference_s), np.hypot(0.03, 1e-5 * (reference_s - 100.0)))


def test_a_poor_estimate_is_used_unless_it_is_from_the_walk() -> None:
    assert ClockEstimate(0.0, 0.0, 0.1, method="walk").used
    assert not ClockEstimate(0.0, 0.0, 0.1, method="walk", doubts=("two peaks",)).used
    assert ClockEstimate(0.0, 0.0, 0.1, method="messages", doubts=("few",)).used


def test_modes_last_until_the_next_start() -> None:
    modes = TrueModes(np.array([1.0, 3.0]), np.array([CarryingMode.SWING, CarryingMode.POCKET], dtype=np.int8))
    found = modes.at(np.array([0.5, 1.0, 2.9, 3.0, 99.0]))
    assert [CarryingMode(int(one)).name for one in found] == ["UNKNOWN", "SWING", "SWING", "POCKET", "POCKET"]
