"""The step length equations of MMPDR by hand, and the stage around them."""

import numpy as np
import pytest
from signals import RATE_HZ, step

from pdr_est.frames import Array
from pdr_est.front_end.step_length import StepLength, StepLengthParams, WalkerParams
from pdr_est.front_end.step_length.equations import (
    mmpdr_length_m,
    scarlett_length_m,
    static_length_m,
    weinberg_length_m,
)
from pdr_est.front_end.step_length.stage import running_mean
from pdr_est.records import Step

MAN, WOMAN = WalkerParams(height_m=1.80, gender="male"), WalkerParams(height_m=1.60, gender="female")


def length_of(a_step: Step, walker: WalkerParams = MAN, **parameters: object) -> float:
    stage = StepLength(RATE_HZ, walker, StepLengthParams(**parameters))  # type: ignore[arg-type]
    (found,) = stage.push(a_step)
    assert stage.flush() == []
    return found.length_m


def with_vertical(vertical_mps2: Array, frequency_hz: float = 1.96) -> Step:
    return step(1.0, 0.4, frequency_hz=frequency_hz, vertical_mps2=vertical_mps2, length_m=float("nan"))


def test_equation_2_is_a_share_of_the_height() -> None:
    assert static_length_m(1.80, "male") == pytest.approx(0.747)
    assert static_length_m(1.60, "female") == pytest.approx(0.6608)


def test_equation_3_is_the_fourth_root_of_the_range() -> None:
    assert weinberg_length_m(0.48, np.array([-6.0, 3.0, 10.0, 0.0])) == pytest.approx(0.48 * 2.0)
    assert weinberg_length_m(0.5, np.array([0.0, 81.0])) == pytest.approx(1.5)


def test_equation_4_is_the_cube_root_of_the_mean_magnitude() -> None:
    assert scarlett_length_m(0.6, np.array([-8.0, 4.0, 12.0, -8.0])) == pytest.approx(0.6 * 2.0)


def test_equation_9_is_the_root_of_the_frequency() -> None:
    assert mmpdr_length_m(1.80, "male", 1.96) == pytest.approx(0.3139 * 1.80 * 1.4)
    assert mmpdr_length_m(1.60, "female", 2.25) == pytest.approx(0.2975 * 1.60 * 1.5)


def test_a_first_step_takes_equation_2() -> None:
    assert mmpdr_length_m(1.80, "male", 0.0) == pytest.approx(0.747)
    assert mmpdr_length_m(1.60, "female", 0.0) == pytest.approx(0.6608)


def test_the_running_mean_by_hand() -> None:
    np.testing.assert_allclose(running_mean(np.array([1.0, 2.0, 6.0, 4.0]), 2), [1.5, 4.0, 5.0])
    np.testing.assert_allclose(running_mean(np.array([1.0, 2.0, 6.0]), 5), [3.0])
    np.testing.assert_allclose(running_mean(np.array([1.0, 2.0, 6.0]), 1), [1.0, 2.0, 6.0])


PLATEAUS = np.repeat([-6.0, 10.0, 3.0], 20)  # each longer than the running mean of 12 samples


@pytest.mark.parametrize(
    ("model", "expected"),
    [
        ("static", 0.747),
        ("weinberg", 0.48 * 2.0),
        ("mmpdr", 0.3139 * 1.80 * 1.4),
        ("range-power", 0.55 * 16.0**0.15),
    ],
)
def test_the_stage_applies_the_chosen_model(model: str, expected: float) -> None:
    assert length_of(with_vertical(PLATEAUS), model=model) == pytest.approx(expected)


def test_scarlett_averages_the_smoothed_magnitude() -> None:
    assert length_of(with_vertical(np.full(40, -8.0)), model="scarlett") == pytest.approx(0.6 * 2.0)


def test_the_constants_are_parameters() -> None:
    assert length_of(with_vertical(PLATEAUS), model="weinberg", weinberg_k2=0.3) == pytest.approx(0.6)
    found = length_of(with_vertical(PLATEAUS), model="range-power", range_power_k=0.4, range_power_exponent=0.25)
    assert found == pytest.approx(0.8)


def test_smoothing_takes_spikes_off_the_range() -> None:
    spiked = PLATEAUS.copy()
    spiked[30] += 120.0
    smooth = length_of(with_vertical(spiked), model="weinberg", smoothing_s=0.24)
    assert smooth == pytest.approx(0.48 * (16.0 + 120.0 / 12.0) ** 0.25)
    assert length_of(with_vertical(spiked), model="weinberg", smoothing_s=0.02) == pytest.approx(0.48 * 136.0**0.25)


@pytest.mark.parametrize("model", ["weinberg", "scarlett", "range-power"])
def test_a_step_too_short_to_show_its_acceleration_takes_the_static_model(model: str) -> None:
    assert length_of(with_vertical(np.zeros(15)), WOMAN, model=model) == pytest.approx(0.6608)


@pytest.mark.parametrize("samples", [16, 20, 24])
def test_brisk_steps_are_measured(samples: int) -> None:
    """At 3.1, 2.5 and 2.1 steps a second."""
    rising = 8.0 * np.arange(samples) / samples
    means = 8.0 * (samples - 12) / samples
    assert length_of(with_vertical(rising), model="weinberg") == pytest.approx(0.48 * means**0.25)


def test_the_window_is_in_seconds() -> None:
    stage = StepLength(2 * RATE_HZ, MAN, StepLengthParams(model="weinberg"))
    (found,) = stage.push(with_vertical(np.repeat(PLATEAUS, 2)))
    assert found.length_m == pytest.approx(0.96)
