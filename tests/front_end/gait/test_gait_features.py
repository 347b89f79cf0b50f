"""Features of a step: exact for made-up signals, the same for every orientation, one sample enough."""

from dataclasses import replace

import numpy as np
import pytest
from signals import level, step

from pdr_est.front_end.gait.features import STRIDE_NAMES, UPTIME_NAMES, StrideFeatures, UptimeFeatures, step_features
from pdr_est.types.steps import Step

HEIGHT_MPS2 = 4.0


def bounce(count: int, start: int = 0) -> np.ndarray:
    """Two samples a quarter period: the vertical acceleration of a step of `count` samples."""
    return HEIGHT_MPS2 * np.sin(2.0 * np.pi * (start + np.arange(count)) / count)


def second_step(vertical_mps2: np.ndarray, segment: int = 0, frequency_hz: float = 2.0) -> Step:
    return step(1.1, 0.5, vertical_mps2=vertical_mps2, segment=segment, frequency_hz=frequency_hz)


def by_name(features: StrideFeatures | UptimeFeatures, found: Step) -> dict[str, float]:
    return dict(zip(features.names, features.push(found).tolist(), strict=True))


def test_uptime_features_of_numbers_worked_out_by_hand() -> None:
    """m = 3, -1, 1, 1: mean 1, variance 2, root mean square sqrt(3)."""
    found = by_name(UptimeFeatures(), second_step(np.array([3.0, -1.0, 1.0, 1.0])))
    assert tuple(found) == UPTIME_NAMES
    expected = {"duration_s": 0.6, "variance": 2.0, "peak": 3.0, "range": 4.0}
    expected |= {"rms": 3.0**0.5, "rms_duration": 0.6 * 3.0**0.5}
    assert found == pytest.approx(expected)


def test_the_peak_is_the_highest_value_and_not_the_largest_size() -> None:
    """UPTIME's peak of m = 1, -3, 0, 2: a trough below -2 is none."""
    found = by_name(UptimeFeatures(), second_step(np.array([1.0, -3.0, 0.0, 2.0])))
    assert found["peak"] == pytest.approx(2.0)
    assert found["range"] == pytest.approx(5.0)


def test_a_stride_takes_the_lowest_value_and_the_samples_upwards_of_both_steps() -> None:
    features = StrideFeatures()
    features.push(step(0.5, 0.0, vertical_mps2=np.array([-6.0, 1.0, 1.0, 1.0])))
    found = by_name(features, second_step(np.array([-2.0, -1.0, -1.0, 1.0])))
    assert found["lowest_vertical"] == -6.0
    assert found["up_share"] == pytest.approx(4.0 / 8.0)


def test_a_stride_takes_the_horizontal_movement_of_both_steps() -> None:
    def sideways(one: Step, mps2: float) -> Step:
        samples = one.samples
        moved = samples.acceleration_mps2 + np.array([mps2, 0.0, 0.0])
        return replace(one, samples=replace(samples, acceleration_mps2=moved))

    features = StrideFeatures()
    features.push(sideways(step(0.5, 0.0, vertical_mps2=bounce(24)), 4.0))
    found = by_name(features, sideways(second_step(bounce(24)), 3.0))
    assert found["log_horizontal_rms"] == pytest.approx(0.5 * np.log((16.0 + 9.0) / 2.0))


def test_stride_features_of_a_first_step() -> None:
    found = by_name(StrideFeatures(), step(0.5, 0.0, vertical_mps2=bounce(24)))
    assert tuple(found) == STRIDE_NAMES
    assert found["log_vertical_fundamental"] == pytest.approx(np.log(HEIGHT_MPS2))
    assert found["log_magnitude_fundamental"] == pytest.approx(np.log(HEIGHT_MPS2))
    assert found["log_period"] == pytest.approx(np.log(0.5))
    assert found["log_horizontal_rms"] == pytest.approx(0.5 * np.log(1e-3))
    assert found["lowest_vertical"] == pytest.approx(-HEIGHT_MPS2)
    assert found["up_share"] == np.mean(bounce(24) > 0.0)


def test_a_stride_takes_both_steps_and_no_difference_between_them() -> None:
    """A slow sway adds to one foot's step what it takes from the other's: it must cancel."""
    features = StrideFeatures()
    sway = np.sin(np.pi * np.arange(48) / 24)
    features.push(step(0.5, 0.0, vertical_mps2=bounce(24) + sway[:24]))
    found = by_name(features, second_step(bounce(24) + sway[24:]))
    assert found["log_vertical_fundamental"] == pytest.approx(np.log(HEIGHT_MPS2))
    assert found["log_period"] == pytest.approx(np.log(0.55))
    assert found["lowest_vertical"] == pytest.approx((bounce(24) + sway[24:]).min())


def test_horizontal_movement_is_told_from_vertical() -> None:
    samples = level(bounce(24))
    sideways = samples.acceleration_mps2 + np.array([3.0, 0.0, 0.0])
    moved = replace(step(0.5, 0.0), samples=replace(samples, acceleration_mps2=sideways))
    assert by_name(StrideFeatures(), moved)["log_horizontal_rms"] == pytest.approx(np.log(3.0))


@pytest.mark.parametrize("change", [{"frequency_hz": 0.0}, {"segment": 1}], ids=["pause", "gap"])
def test_after_a_pause_or_a_gap_the_step_before_does_not_count(change: dict[str, float]) -> None:
    features = StrideFeatures()
    features.push(step(0.5, 0.0, vertical_mps2=9.0 * np.ones(30)))
    again = second_step(bounce(24), **change)  # type: ignore[arg-type]
    np.testing.assert_array_equal(features.push(again), StrideFeatures().push(again))


@pytest.mark.parametrize("name", ["auto", "uptime"])
def test_every_orientation_and_no_gyroscope_give_the_same(name: str) -> None:
    rng = np.random.default_rng(3)
    turn, _ = np.linalg.qr(rng.standard_normal((3, 3)))
    for vertical in (bounce(24), np.array([2.0])):
        plain = second_step(vertical)
        samples = replace(plain.samples, acceleration_mps2=plain.samples.acceleration_mps2 + 0.5)
        turned = replace(
            samples,
            up=samples.up @ turn,
            acceleration_mps2=samples.acceleration_mps2 @ turn,
            rotation_rate_radps=np.full((len(samples), 3), np.nan),
            yaw_rad=np.full(len(samples), np.nan),
        )
        one, other = step_features(name), step_features(name)  # type: ignore[arg-type]
        expected = one.push(replace(plain, samples=samples))
        assert np.isfinite(expected).all()
        np.testing.assert_allclose(other.push(replace(plain, samples=turned)), expected, rtol=1e-12, atol=1e-12)


def test_free_fall_and_a_step_without_duration_are_finite() -> None:
    fall = replace(second_step(np.full(3, -9.80665)), start_s=1.1)
    for features in (StrideFeatures(), UptimeFeatures()):
        assert np.isfinite(features.push(fall)).all()
