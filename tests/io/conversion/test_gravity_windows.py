"""Gravity that the gyroscope carries along stays where it is, and moves if the gyroscope is wrong."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from pdr_est.frames import STANDARD_GRAVITY_MPS2, Array
from pdr_est.io.conversion.gravity_drift import WalkerVelocity, gravity_scatter, hann_means, log_likelihood
from pdr_est.io.conversion.gravity_windows import GravityWindows, cross_matrices, gravity_windows, turned_by
from pdr_est.types.recording import Signal

TIME_S = np.arange(0.0, 30.0, 0.01)


def tumbling(sign: float = 1.0) -> tuple[Signal, Signal]:
    """A device at rest that turns about a slowly changing axis; sign: of the rotation rate."""
    rate = np.column_stack([0.6 * np.sin(0.4 * TIME_S), 0.5 * np.cos(0.3 * TIME_S), 0.4 * np.sin(0.2 * TIME_S)])
    steps = Rotation.from_rotvec(0.5 * (rate[1:] + rate[:-1]) * 0.01)
    attitude = [Rotation.identity()]
    for step in steps:
        attitude.append(attitude[-1] * step)
    up = Rotation.concatenate(attitude).inv().apply([0.0, 0.0, STANDARD_GRAVITY_MPS2])
    return Signal(TIME_S, up), Signal(TIME_S, sign * rate)


def test_a_device_at_rest_sees_gravity_stand_still() -> None:
    windows = gravity_windows(*tumbling())
    assert windows is not None
    assert np.sqrt(gravity_scatter(windows.turned, windows).max()) < 0.01


def test_the_other_sense_of_rotation_makes_it_move_and_is_less_likely() -> None:
    right, wrong = (gravity_windows(*tumbling(sign)) for sign in (1.0, -1.0))
    assert right is not None
    assert wrong is not None
    moved = gravity_scatter(wrong.turned, wrong)
    assert np.sqrt(moved.mean()) > 3.0
    assert log_likelihood(moved, wrong) < log_likelihood(gravity_scatter(right.turned, right), right) - 20.0


def test_a_constant_rate_turns_by_its_integral() -> None:
    rate = np.broadcast_to(np.array([0.3, -0.2, 0.5]), (1, 100, 3))
    expected = Rotation.from_rotvec(np.array([0.3, -0.2, 0.5]) * 99.5 * 0.02).as_matrix()
    np.testing.assert_allclose(turned_by(rate, 0.02)[0, -1], expected, atol=1e-12)


def test_the_means_suppress_the_rhythm_of_walking() -> None:
    period_s = 0.04
    time_s = np.arange(150) * period_s
    for cadence_hz in (0.9, 1.4, 1.8, 2.4):
        wave = np.sin(2.0 * np.pi * cadence_hz * time_s)[None, :, None] * np.ones(3)
        assert np.abs(hann_means(wave, period_s)).max() < 0.05
    assert hann_means(np.ones((2, 150, 3)), period_s) == pytest.approx(1.0)


def standing(count: int, period_s: float = 0.04) -> GravityWindows:
    """Windows of a device that does not turn."""
    force = np.zeros((count, 150, 3))
    return GravityWindows(np.zeros(count), force, np.zeros_like(force), period_s, np.full(count, 0.09))


@pytest.mark.slow
def test_scatter_is_the_variance_of_a_component() -> None:
    windows = standing(4000)
    means = np.random.default_rng(0).normal(scale=0.7, size=(4000, 4, 3))
    assert WalkerVelocity.of(windows.turned, windows).scatter(means).mean() == pytest.approx(0.49, rel=0.03)


def test_the_velocity_of_a_walker_who_turns_does_not_count() -> None:
    yaw_rate = np.zeros((1, 150, 3))
    yaw_rate[0, 50:90, 2] = 1.0
    turned = turned_by(yaw_rate, 0.04)
    velocity = turned @ np.array([1.3, 0.0, 0.0])
    level = np.gradient(velocity, 0.04, axis=1) + np.array([0.0, 0.0, STANDARD_GRAVITY_MPS2])
    device = np.einsum("kjab,kja->kjb", turned, level)
    windows = GravityWindows(np.zeros(1), device, yaw_rate, 0.04, np.array([0.09]))
    means = hann_means(level, 0.04)
    assert np.sqrt(np.square(means - means.mean(axis=1, keepdims=True)).sum() / 9.0) > 0.25
    assert np.sqrt(gravity_scatter(turned, windows)[0]) < 0.1


def test_cross_matrices_are_cross_products() -> None:
    a, b = np.random.default_rng(1).normal(size=(2, 5, 3))
    np.testing.assert_allclose(np.einsum("kab,kb->ka", cross_matrices(a), b), np.cross(a, b))


def without(signal: Signal, rows: slice) -> Signal:
    kept = np.ones(len(signal), dtype=np.bool_)
    kept[rows] = False
    return Signal(signal.time_s[kept], signal.values[kept])


def test_windows_with_a_pause_are_left_out() -> None:
    force, rate = tumbling()
    full, holed = gravity_windows(force, rate), gravity_windows(force, without(rate, slice(1000, 1100)))
    assert full is not None
    assert holed is not None
    assert len(holed) < len(full)
    assert not ((holed.start_s < 11.0) & (holed.start_s > 4.1)).any()
    long = np.concatenate([force.time_s[:1500], force.time_s[1500:] + 600.0])
    apart = gravity_windows(Signal(long, force.values), Signal(long, rate.values))
    assert apart is not None
    assert ((apart.start_s <= 9.1) | (apart.start_s >= 614.9)).all()


def test_damaged_rows_and_a_clock_that_jumps_back_do_no_harm() -> None:
    force, rate = tumbling()
    values: Array = force.values.copy()
    values[40] = np.nan
    time_s = force.time_s.copy()
    time_s[500] = 2.0
    windows = gravity_windows(Signal(time_s, values), rate)
    assert windows is not None
    assert np.sqrt(gravity_scatter(windows.turned, windows).max()) < 0.02


def test_there_are_none_without_common_time() -> None:
    force, rate = tumbling()
    assert gravity_windows(force, Signal(rate.time_s + 27.0, rate.values)) is None
    assert gravity_windows(force, Signal(np.empty(0), np.empty((0, 3)))) is None
