"""The causal filters and the search for extrema that the stages share."""

import numpy as np
import pytest

from pdr_est.front_end.signal.event_detection import local_maxima, local_minima
from pdr_est.front_end.signal.filters import CADENCE_HZ, CausalBandPass, CausalFilter, CausalLowPass

RATE_HZ = 50.0
TIME_S = np.arange(1500) / RATE_HZ


def gain(a_filter: CausalFilter, frequency_hz: float) -> float:
    """Amplitude of the settled answer to a sine of amplitude 1."""
    answer = a_filter.push(np.sin(2.0 * np.pi * frequency_hz * TIME_S))
    return float(np.abs(answer[1000:]).max())


def test_the_low_pass_halves_the_power_at_its_cutoff() -> None:
    assert gain(CausalLowPass(5.0, RATE_HZ), 5.0) == pytest.approx(np.sqrt(0.5), abs=0.01)
    assert gain(CausalLowPass(5.0, RATE_HZ), 1.0) == pytest.approx(1.0, abs=0.01)
    assert gain(CausalLowPass(5.0, RATE_HZ), 20.0) < 0.03


def test_the_band_pass_keeps_its_band() -> None:
    assert gain(CausalBandPass(0.3, 2.0, RATE_HZ), 1.0) == pytest.approx(0.95, abs=0.02)
    assert gain(CausalBandPass(0.3, 2.0, RATE_HZ), 0.03) < 0.12
    assert gain(CausalBandPass(0.3, 2.0, RATE_HZ), 6.0) < 0.05


@pytest.mark.parametrize("level", [0.0, 9.81, -3.0])
def test_a_filter_starts_in_the_steady_state_of_its_first_sample(level: float) -> None:
    constant = np.full(50, level)
    np.testing.assert_allclose(CausalLowPass(5.0, RATE_HZ).push(constant), level, atol=1e-9)
    np.testing.assert_allclose(CausalBandPass(0.3, 2.0, RATE_HZ).push(constant), 0.0, atol=1e-9)


def test_a_reset_forgets_the_past() -> None:
    a_filter, fresh = CausalLowPass(5.0, RATE_HZ), CausalLowPass(5.0, RATE_HZ)
    a_filter.push(np.full(50, 100.0))
    a_filter.reset()
    np.testing.assert_array_equal(a_filter.push(np.sin(TIME_S)), fresh.push(np.sin(TIME_S)))


@pytest.mark.parametrize("a_filter", [CausalLowPass(5.0, RATE_HZ), CausalBandPass(0.3, 2.0, RATE_HZ)])
def test_the_delay_is_that_of_a_walks_crests(a_filter: CausalFilter) -> None:
    answer = a_filter.push(np.sin(2.0 * np.pi * CADENCE_HZ * TIME_S))
    crests_s = TIME_S[local_maxima(answer)][-5:]
    late_s = (crests_s - 0.25 / CADENCE_HZ) % (1.0 / CADENCE_HZ)
    np.testing.assert_allclose(late_s, a_filter.delay_s, atol=0.5 / RATE_HZ)


def test_extrema_by_hand() -> None:
    samples = np.array([9.0, 1.0, 3.0, 2.0, 2.0, 2.0, 4.0, 4.0, 1.0, 1.0, 0.0, 5.0])
    assert np.flatnonzero(local_maxima(samples)).tolist() == [2, 6]  # a plateau counts once, where it begins
    assert np.flatnonzero(local_minima(samples)).tolist() == [1, 3, 8, 10]  # 3 and 8: level next, which may rise


@pytest.mark.parametrize("count", [0, 1, 2])
def test_few_samples_have_no_extrema(count: int) -> None:
    assert not local_maxima(np.arange(count, dtype=np.float64)).any()
