"""UPTIME's baselines on made-up signals whose steps can be told by hand."""

import numpy as np
import pytest
from signals import level, run

from pdr_est.errors import ConfigError
from pdr_est.frames import Array
from pdr_est.front_end.steps.local_variance import LocalVariance, LocalVarianceParams
from pdr_est.front_end.steps.zero_crossing import ZeroCrossing, ZeroCrossingParams

RATE_HZ = 100.0
OPEN_HZ = 49.0  # a low-pass that leaves these signals nearly alone


def crossings(signal: Array, **changes: float) -> list[float]:
    detector = ZeroCrossing(RATE_HZ, ZeroCrossingParams(**changes))
    return [event.time_s for event in run(detector, [level(signal, rate_hz=RATE_HZ)])]


def stances(signal: Array, **changes: float) -> list[float]:
    detector = LocalVariance(RATE_HZ, LocalVarianceParams(**changes))
    return [event.time_s for event in run(detector, [level(signal, rate_hz=RATE_HZ)])]


def wave(amplitude: float, offset: float = 0.0) -> Array:
    """A walk at 1.8 steps a second for 10 s."""
    return offset + amplitude * np.sin(2.0 * np.pi * 1.8 * np.arange(1000) / RATE_HZ)


def held(*values: float, each: int = 20) -> Array:
    """Each value for 0.2 s."""
    return np.repeat(values, each)


def bursts(*starts_s: float, amplitude: float = 2.0, duration_s: float = 0.3, end_s: float = 4.0) -> Array:
    """Rest but for bursts of a square wave of 10 Hz."""
    time_s = np.arange(round(end_s * RATE_HZ)) / RATE_HZ
    shake = np.where((time_s * 20.0).astype(int) % 2, -amplitude, amplitude)
    inside = np.any([(time_s >= start_s) & (time_s < start_s + duration_s) for start_s in starts_s], axis=0)
    return np.where(inside, shake, 0.0)


@pytest.mark.parametrize("offset", [0.0, 0.5, -0.5])
def test_zero_is_the_mean_and_the_filter_is_taken_off_the_time(offset: float) -> None:
    found = [time_s for time_s in crossings(wave(2.0, offset)) if time_s > 3.0]
    expected = np.arange(6, 18) / 1.8
    np.testing.assert_allclose(found, expected[expected > 3.0], atol=0.03)


def test_only_crossings_upwards_count() -> None:
    signal = held(0.0, -1.0, 1.0, 1.0, -1.0, -1.0, 1.0)
    assert crossings(signal, cutoff_hz=OPEN_HZ, mean_window_s=60.0) == pytest.approx([0.4, 1.2], abs=0.02)


@pytest.mark.parametrize(("depth", "found"), [(-0.35, [1.2]), (-0.45, [0.4, 1.2])])
def test_a_crossing_counts_after_the_dead_band_only(depth: float, found: list[float]) -> None:
    signal = held(0.0, depth, 1.0, 1.0, -1.0, -1.0, 1.0)
    assert crossings(signal, cutoff_hz=OPEN_HZ, mean_window_s=60.0) == pytest.approx(found, abs=0.02)


def test_without_a_dead_band_every_crossing_counts() -> None:
    signal = held(0.0, -0.1, 0.1, -0.1, 0.1)
    free = {"dead_band_mps2": 0.0, "min_interval_s": 0.0}
    assert crossings(signal, cutoff_hz=OPEN_HZ, mean_window_s=60.0, **free) == pytest.approx([0.4, 0.8], abs=0.02)


@pytest.mark.parametrize(("least_s", "count"), [(0.5, 17), (0.6, 9), (1.2, 6)])
def test_crossings_soon_after_a_step_are_no_steps(least_s: float, count: int) -> None:
    assert len(crossings(wave(2.0), min_interval_s=least_s)) == pytest.approx(count, abs=1)


def test_a_step_is_a_swing_that_ends_in_a_stance() -> None:
    found = stances(bursts(1.0, 2.0, 3.0), cutoff_hz=OPEN_HZ)
    assert found == pytest.approx([1.3, 2.3, 3.3], abs=0.06)
    assert stances(bursts(1.0, duration_s=10.0), cutoff_hz=OPEN_HZ) == []


@pytest.mark.parametrize(("amplitude", "count"), [(1.5, 0), (2.5, 3)])
def test_a_swing_must_vary_more_than_its_threshold(amplitude: float, count: int) -> None:
    thresholds = {"swing_mps2": 2.2, "stance_mps2": 1.0}
    assert len(stances(bursts(1.0, 2.0, 3.0, amplitude=amplitude), cutoff_hz=OPEN_HZ, **thresholds)) == count


@pytest.mark.parametrize(("stance", "count"), [(1.0, 1), (1.8, 2)])
def test_a_stance_must_vary_less_than_its_threshold(stance: float, count: int) -> None:
    """Between two bursts the phone shakes with 1.5 m/s^2."""
    signal = bursts(1.0, 2.0, amplitude=3.0) + bursts(1.3, amplitude=1.5, duration_s=0.7)
    assert len(stances(signal, cutoff_hz=OPEN_HZ, swing_mps2=2.5, stance_mps2=stance)) == count


def test_a_stance_soon_after_a_step_is_no_step() -> None:
    signal = bursts(1.0, 1.5, 2.0, duration_s=0.2)
    assert len(stances(signal, cutoff_hz=OPEN_HZ)) == 3
    assert stances(signal, cutoff_hz=OPEN_HZ, min_interval_s=0.6) == pytest.approx([1.2, 2.2], abs=0.06)


def test_the_thresholds_are_standard_deviations() -> None:
    """A square wave of amplitude 2 whose periods fill the window has standard deviation 2."""
    signal, window = bursts(1.0, 2.0), {"cutoff_hz": OPEN_HZ, "window_s": 0.1, "stance_mps2": 0.5}
    assert len(stances(signal, swing_mps2=1.9, **window)) == 2
    assert len(stances(signal, swing_mps2=2.4, **window)) == 0


def test_a_stance_cannot_vary_more_than_a_swing() -> None:
    with pytest.raises(ConfigError, match=r"stance_mps2 2\.0 is above swing_mps2 1\.0"):
        LocalVariance(RATE_HZ, LocalVarianceParams(swing_mps2=1.0, stance_mps2=2.0))
