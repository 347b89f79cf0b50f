"""Recorded signals: noise statistics, biases, clocks and losses."""

from dataclasses import replace

import numpy as np
import pytest

from pdr_est.simulate import NO_SENSOR_ERRORS, SensorErrors, SensorParams
from pdr_est.simulate.sensors.sensor_errors import record_signal, sampling_times

RATE_HZ = 200.0
TIME_S = sampling_times(100.0, RATE_HZ)
ZERO = np.zeros((len(TIME_S), 3))
CLEAN = SensorParams(rate_hz=RATE_HZ, time_jitter_s=0.0, accelerometer=NO_SENSOR_ERRORS, gyroscope=NO_SENSOR_ERRORS)


def rng(seed: int = 1) -> np.random.Generator:
    return np.random.default_rng(seed)


def test_a_perfect_sensor_records_the_signal() -> None:
    ideal = np.random.default_rng(0).normal(size=ZERO.shape)
    recorded = record_signal(TIME_S, ideal, NO_SENSOR_ERRORS, CLEAN, rng())
    np.testing.assert_array_equal(recorded.signal.values, ideal)
    np.testing.assert_array_equal(recorded.signal.time_s, TIME_S)


def test_white_noise_has_its_size_and_no_memory() -> None:
    noise = record_signal(TIME_S, ZERO, SensorErrors(noise_std=0.3), CLEAN, rng()).signal.values
    np.testing.assert_allclose(noise.std(axis=0), 0.3, rtol=0.03)
    np.testing.assert_allclose((noise[1:] * noise[:-1]).mean(axis=0) / 0.09, 0.0, atol=0.03)
    np.testing.assert_allclose(noise.mean(axis=0), 0.0, atol=0.01)


def test_bias_and_scale_are_those_reported_and_have_their_size() -> None:
    errors = SensorErrors(bias_std=0.2, scale_std=0.01)
    ideal = np.tile([1.0, -2.0, 3.0], (50, 1))
    recorded = [record_signal(TIME_S[:50], ideal, errors, CLEAN, rng(seed)) for seed in range(400)]
    np.testing.assert_allclose(recorded[0].signal.values, recorded[0].scale * ideal + recorded[0].bias)
    assert np.std([r.bias for r in recorded]) == pytest.approx(0.2, rel=0.1)
    assert np.std([r.scale for r in recorded]) == pytest.approx(0.01, rel=0.1)


def test_the_bias_walk_grows_with_the_square_root_of_time_at_any_rate() -> None:
    errors = SensorErrors(bias_walk=0.1)
    for rate_hz in (50.0, 200.0):
        time_s = sampling_times(25.0, rate_hz)
        sensors = SensorParams(rate_hz=rate_hz)
        ends = [
            record_signal(time_s, np.zeros((len(time_s), 3)), errors, sensors, rng(seed)).signal.values[-1]
            for seed in range(300)
        ]
        assert np.std(ends) == pytest.approx(0.1 * 5.0, rel=0.08)


def test_time_stamps_jitter_and_never_run_back() -> None:
    small = SensorParams(rate_hz=RATE_HZ, time_jitter_s=0.0004)
    stamps = record_signal(TIME_S, ZERO, NO_SENSOR_ERRORS, small, rng()).signal.time_s
    assert (stamps - TIME_S).std() == pytest.approx(0.0004, rel=0.05)
    large = SensorParams(rate_hz=RATE_HZ, time_jitter_s=0.05)
    assert (np.diff(record_signal(TIME_S, ZERO, NO_SENSOR_ERRORS, large, rng()).signal.time_s) > 0.0).all()


def test_a_device_clock_is_ahead_and_runs_faster() -> None:
    sensors = SensorParams(rate_hz=RATE_HZ, time_jitter_s=0.0, clock_offset_s=-2.5, clock_skew=1e-3)
    gap = replace(sensors, gaps_s=((50.0, 60.0),))
    stamps = record_signal(TIME_S, ZERO, NO_SENSOR_ERRORS, sensors, rng()).signal.time_s
    np.testing.assert_allclose(stamps[[0, -1]], [-2.5, 100.0 * 1.001 - 2.5], atol=1e-9)
    missing = np.setdiff1d(stamps, record_signal(TIME_S, ZERO, NO_SENSOR_ERRORS, gap, rng()).signal.time_s)
    np.testing.assert_allclose(missing[[0, -1]], [50.05 - 2.5, 59.995 * 1.001 - 2.5], atol=1e-9)


def test_lost_samples_and_gaps() -> None:
    sensors = SensorParams(rate_hz=RATE_HZ, time_jitter_s=0.0, lost_fraction=0.1, gaps_s=((10.0, 12.0), (50.0, 50.5)))
    ideal = np.tile(TIME_S[:, None], (1, 3))
    signal = record_signal(TIME_S, ideal, NO_SENSOR_ERRORS, sensors, rng()).signal
    assert len(signal) / (0.975 * len(TIME_S)) == pytest.approx(0.9, abs=0.01)
    assert not ((signal.time_s >= 10.0) & (signal.time_s < 12.0)).any()
    assert not ((signal.time_s >= 50.0) & (signal.time_s < 50.5)).any()
    np.testing.assert_array_equal(signal.values[:, 0], signal.time_s)  # values stay with their time


@pytest.mark.parametrize("rate_hz", [25.0, 98.0, 500.0])
def test_sampling_covers_the_walk(rate_hz: float) -> None:
    time_s = sampling_times(7.0, rate_hz)
    assert time_s[0] == 0.0
    assert 7.0 - 1.0 / rate_hz < time_s[-1] <= 7.0
    np.testing.assert_allclose(np.diff(time_s), 1.0 / rate_hz)


def test_a_given_bias_comes_on_top_of_the_one_that_is_drawn() -> None:
    drawn, given = (
        record_signal(TIME_S[:50], ZERO[:50], SensorErrors(bias_std=0.2, bias=bias), CLEAN, rng())
        for bias in ((0.0, 0.0, 0.0), (1.0, -2.0, 3.0))
    )
    np.testing.assert_allclose(given.bias - drawn.bias, [1.0, -2.0, 3.0])
    np.testing.assert_allclose(given.signal.values - drawn.signal.values, np.tile([1.0, -2.0, 3.0], (50, 1)))
