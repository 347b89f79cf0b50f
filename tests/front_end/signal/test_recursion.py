"""The filters in numpy against those of scipy, and the independence of their output from the cuts."""

import numpy as np
import pytest
from scipy import signal
from scipy.spatial.transform import Rotation

from pdr_est.frames import Array
from pdr_est.front_end.signal.axis_turn import AxisTurn
from pdr_est.front_end.signal.butterworth import (
    frequency_response,
    high_pass_section,
    joined_sections,
    low_pass_sections,
)
from pdr_est.front_end.signal.filters import CausalBandPass, CausalLowPass
from pdr_est.front_end.signal.recursion import RecursiveFilter

RATE_HZ = 50.0
FREQUENCIES_HZ = np.linspace(0.01, 24.9, 200)
NOISE = np.random.default_rng(5).normal(9.81, 3.0, (9000, 3))


def response_of_scipy(order: int, cutoff_hz: float, kind: str) -> Array:
    sections = signal.butter(order, cutoff_hz, kind, fs=RATE_HZ, output="sos")
    response: Array = signal.sosfreqz(sections, FREQUENCIES_HZ, fs=RATE_HZ)[1]
    return response


def filtered_by_scipy(sections: Array, samples: Array) -> Array:
    start = np.multiply.outer(signal.sosfilt_zi(sections), samples[0])
    filtered: Array = signal.sosfilt(sections, samples, axis=0, zi=start)[0]
    return filtered


@pytest.mark.parametrize("cutoff_hz", [0.3, 5.0, 24.0])
@pytest.mark.parametrize("order", [1, 2, 3, 4, 5])
def test_the_low_pass_is_that_of_scipy(order: int, cutoff_hz: float) -> None:
    found = frequency_response(low_pass_sections(order, cutoff_hz, RATE_HZ), FREQUENCIES_HZ, RATE_HZ)
    np.testing.assert_allclose(found, response_of_scipy(order, cutoff_hz, "lowpass"), rtol=0.0, atol=1e-12)


@pytest.mark.parametrize("cutoff_hz", [0.01, 0.5, 20.0])
def test_the_high_pass_is_that_of_scipy(cutoff_hz: float) -> None:
    found = frequency_response(high_pass_section(cutoff_hz, RATE_HZ)[None], FREQUENCIES_HZ, RATE_HZ)
    np.testing.assert_allclose(found, response_of_scipy(1, cutoff_hz, "highpass"), rtol=0.0, atol=1e-12)


def test_joined_sections_do_what_both_do() -> None:
    first, second = low_pass_sections(1, 3.0, RATE_HZ)[0], high_pass_section(0.5, RATE_HZ)
    joined = frequency_response(joined_sections(first, second)[None], FREQUENCIES_HZ, RATE_HZ)
    both = frequency_response(np.stack([first, second]), FREQUENCIES_HZ, RATE_HZ)
    np.testing.assert_allclose(joined, both, rtol=0.0, atol=1e-14)


@pytest.mark.parametrize("count", [1, 15, 16, 17, 100, 9000])
def test_the_recursion_is_that_of_scipy(count: int) -> None:
    sections = low_pass_sections(5, 3.0, RATE_HZ)
    samples = NOISE[:count]
    np.testing.assert_allclose(
        RecursiveFilter(sections).push(samples), filtered_by_scipy(sections, samples), rtol=0.0, atol=1e-12
    )


@pytest.mark.parametrize("size", [1, 7, 16, 33, 200, 4097])
@pytest.mark.parametrize("make", [lambda: CausalLowPass(5.0, RATE_HZ), lambda: CausalBandPass(0.5, 3.0, RATE_HZ)])
def test_cuts_change_no_bit(make, size: int) -> None:  # type: ignore[no-untyped-def]
    cut = make()
    pieces = [cut.push(NOISE[i : i + size]) for i in range(0, len(NOISE), size)]
    np.testing.assert_array_equal(np.concatenate(pieces), make().push(NOISE))


def test_columns_do_not_mix_and_what_is_not_finite_stays_in_its_own() -> None:
    samples = NOISE[:500].copy()
    samples[200, 1] = np.inf
    samples[:, 2] = np.nan
    together, alone = CausalLowPass(5.0, RATE_HZ).push(samples), CausalLowPass(5.0, RATE_HZ).push(NOISE[:500, 0])
    np.testing.assert_array_equal(together[:, 0], alone)
    np.testing.assert_array_equal(together[:200, 1], CausalLowPass(5.0, RATE_HZ).push(NOISE[:200, 1]))
    assert not np.isfinite(together[200:, 1]).any()
    assert np.isnan(together[:, 2]).all()


@pytest.mark.parametrize("seed", range(8))
def test_turned_attitudes_are_those_of_turned_axes(seed: int) -> None:
    turn, attitude = Rotation.random(2, random_state=seed)
    if seed == 0:
        turn = Rotation.from_euler("x", 180.0, degrees=True)  # a quaternion with three zeros
    w_first = attitude.as_quat()[None, [3, 0, 1, 2]]
    found = AxisTurn(turn.as_matrix()).attitudes(w_first)[0]
    expected = (attitude * turn).as_quat()[[3, 0, 1, 2]]
    np.testing.assert_allclose(found * np.sign(found @ expected), expected, rtol=0.0, atol=1e-14)
