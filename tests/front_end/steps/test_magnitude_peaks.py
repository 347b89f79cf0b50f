"""Textbook detector: peaks of the magnitude, compared with scipy's `find_peaks` on signals made by hand."""

import numpy as np
from scipy.signal import find_peaks
from signals import level, run

from pdr_est.frames import Array
from pdr_est.front_end.steps.magnitude_peaks import MagnitudePeaks, MagnitudePeaksParams

RATE_HZ = 100.0
OPEN_HZ = 49.0  # a low-pass that leaves these signals nearly alone


def peaks_s(signal: Array, **changes: float) -> Array:
    detector = MagnitudePeaks(RATE_HZ, MagnitudePeaksParams(**changes))
    return np.array([event.time_s for event in run(detector, [level(signal, rate_hz=RATE_HZ)])])


def wave(heights: Array, period_s: float = 0.55) -> Array:
    """Half waves of these heights, one a period."""
    phase = np.arange(0.0, len(heights) * period_s, 1.0 / RATE_HZ) / period_s
    return heights[phase.astype(int)] * np.sin(np.pi * (phase % 1.0))


def test_separate_peaks_are_those_of_find_peaks() -> None:
    signal = wave(np.random.default_rng(3).uniform(0.1, 3.0, 60))
    expected, _ = find_peaks(signal, height=0.5, distance=30)
    np.testing.assert_allclose(peaks_s(signal, cutoff_hz=OPEN_HZ), expected / RATE_HZ, atol=0.02)


def test_of_near_peaks_the_highest_is_taken() -> None:
    signal = wave(np.array([1.0, 2.0, 1.5, 0.2, 0.2, 1.0]), period_s=0.2)
    np.testing.assert_allclose(peaks_s(signal, cutoff_hz=OPEN_HZ), [0.3, 1.1], atol=0.02)
    assert len(peaks_s(signal, cutoff_hz=OPEN_HZ, min_interval_s=0.1)) == 4


def test_low_peaks_are_no_steps() -> None:
    assert len(peaks_s(wave(np.full(20, 0.45)), cutoff_hz=OPEN_HZ)) == 0
    assert len(peaks_s(wave(np.full(20, 0.45)), cutoff_hz=OPEN_HZ, threshold_mps2=0.4)) == 20
