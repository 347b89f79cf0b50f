"""The step length equations by hand, and the stage around them."""

from dataclasses import replace

import numpy as np
import pytest
from signals import RATE_HZ, run, step

from pdr_est.frames import Array
from pdr_est.front_end.step_length import LENGTH_MODELS, StepLength, StepLengthParams, WalkerParams
from pdr_est.front_end.step_length.cadence import PaceMeter
from pdr_est.front_end.step_length.equations import (
    gait_table_length_m,
    kim_length_m,
    mmpdr_length_m,
    range_power_length_m,
    scarlett_length_m,
    static_length_m,
    weinberg_length_m,
)
from pdr_est.front_end.step_length.length_mixture import mixture_mean_and_sigma
from pdr_est.front_end.step_length.step_length_stage import windowed_mean
from pdr_est.front_end.step_length.walk_run_model import share_of_running
from pdr_est.types.steps import Gait, Step

MAN, WOMAN = WalkerParams(height_m=1.80, gender="male"), WalkerParams(height_m=1.60, gender="female")


def length_of(a_step: Step, walker: WalkerParams = MAN, **parameters: object) -> float:
    stage = StepLength(RATE_HZ, walker, StepLengthParams(**parameters))  # type: ignore[arg-type]
    (found,) = stage.push(a_step)
    assert stage.flush() == []
    return found.length_m


def with_vertical(vertical_mps2: Array, frequency_hz: float = 1.96, start_s: float = 0.4) -> Step:
    return step(1.0, start_s, frequency_hz=frequency_hz, vertical_mps2=vertical_mps2, length_m=float("nan"))


def test_equation_2_is_a_share_of_the_height() -> None:
    assert static_length_m(1.80, "male") == pytest.approx(0.747)
    assert static_length_m(1.60, "female") == pytest.approx(0.6608)


def test_equation_3_is_the_fourth_root_of_the_range() -> None:
    assert weinberg_length_m(0.48, np.array([-6.0, 3.0, 10.0, 0.0])) == pytest.approx(0.48 * 2.0)
    assert weinberg_length_m(0.5, np.array([0.0, 81.0])) == pytest.approx(1.5)


def test_equation_4_is_the_cube_root_of_the_mean_magnitude() -> None:
    assert scarlett_length_m(0.6, np.array([-8.0, 4.0, 12.0, -8.0])) == pytest.approx(0.6 * 2.0)


def test_the_range_to_a_power() -> None:
    assert range_power_length_m(0.55, 0.5, np.array([-6.0, 10.0])) == pytest.approx(0.55 * 4.0)


def test_uptime_table_2() -> None:
    lengths = {gait: gait_table_length_m(gait) for gait in Gait}
    assert lengths == {Gait.UNKNOWN: 0.74, Gait.WALKING: 0.74, Gait.JOGGING: 1.01, Gait.RUNNING: 1.70}


def test_kim_is_the_cube_root_of_the_mean_magnitude() -> None:
    assert kim_length_m(0.98, np.array([-1.0, 1.0, -0.5, 1.5])) == pytest.approx(0.98)
    assert kim_length_m(0.5, np.array([-8.0, 8.0])) == pytest.approx(1.0)


def test_equation_9_is_the_root_of_the_frequency() -> None:
    assert mmpdr_length_m(1.80, "male", 1.96) == pytest.approx(0.3139 * 1.80 * 1.4)
    assert mmpdr_length_m(1.60, "female", 2.25) == pytest.approx(0.2975 * 1.60 * 1.5)


def test_a_first_step_takes_equation_2() -> None:
    assert mmpdr_length_m(1.80, "male", 0.0) == pytest.approx(0.747)
    assert mmpdr_length_m(1.60, "female", 0.0) == pytest.approx(0.6608)


def test_the_running_mean_by_hand() -> None:
    np.testing.assert_allclose(windowed_mean(np.array([1.0, 2.0, 6.0, 4.0]), 2), [1.5, 4.0, 5.0])
    np.testing.assert_allclose(windowed_mean(np.array([1.0, 2.0, 6.0]), 5), [3.0])
    np.testing.assert_allclose(windowed_mean(np.array([1.0, 2.0, 6.0]), 1), [1.0, 2.0, 6.0])


PLATEAUS = np.repeat([-6.0, 10.0, 3.0], 20)  # each longer than the running mean of 12 samples


@pytest.mark.parametrize(
    ("model", "expected"),
    [
        ("static", 0.747),
        ("weinberg", 0.48 * 2.0),
        ("mmpdr", 0.3139 * 1.80 * 1.4),
        ("range-power", 0.55 * 16.0**0.15),
        ("walk-run", 0.55 * 16.0**0.15 * 1.80 / 1.73),
        ("gait-table", 0.74),
        ("kim", 0.98 * (19.0 / 3.0) ** (1.0 / 3.0)),
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


WALKING, RUNNING = (1.0, 0.0, 0.0), (0.0, 0.3, 0.7)
UNKNOWN = (float("nan"),) * 3


def in_gait(a_step: Step, probability: tuple[float, float, float], gait: Gait = Gait.UNKNOWN) -> Step:
    return replace(a_step, gait=gait, gait_probability=probability)


def pushed(*steps: Step, walker: WalkerParams = MAN, **parameters: object) -> list[Step]:
    return run(StepLength(RATE_HZ, walker, StepLengthParams(**parameters)), steps)  # type: ignore[arg-type]


@pytest.mark.parametrize("model", LENGTH_MODELS)
@pytest.mark.parametrize("probability", [UNKNOWN, WALKING, RUNNING, (0.5, 0.25, 0.25)])
@pytest.mark.parametrize("samples", [1, 3, 15, 60])
def test_every_model_fills_in_length_and_sigma_and_nothing_else(
    model: str, probability: tuple[float, float, float], samples: int
) -> None:
    before = in_gait(with_vertical(np.linspace(-4.0, 5.0, samples)), probability)
    (after,) = pushed(before, model=model)
    assert 0.2 < after.length_m < 2.5
    assert 0.05 < after.sigma_length_m / after.length_m < 0.6
    assert replace(after, length_m=0.0, sigma_length_m=0.0) == replace(before, length_m=0.0, sigma_length_m=0.0)


@pytest.mark.parametrize("model", LENGTH_MODELS)
def test_a_step_without_movement_has_a_finite_length(model: str) -> None:
    (found,) = pushed(in_gait(with_vertical(np.zeros(40)), RUNNING), model=model)
    assert 0.0 <= found.length_m < 1.2
    assert np.isfinite(found.sigma_length_m)


@pytest.mark.parametrize("model", ["auto", "walk-run"])
@pytest.mark.parametrize("probability", [WALKING, RUNNING])
def test_our_models_are_proportional_to_the_height(model: str, probability: tuple[float, float, float]) -> None:
    a_step = in_gait(with_vertical(PLATEAUS), probability)
    (short,), (tall,) = (pushed(a_step, walker=WalkerParams(height_m=height), model=model) for height in (1.5, 1.8))
    assert tall.length_m == pytest.approx(1.2 * short.length_m)


def test_the_table_goes_by_the_gait() -> None:
    steps = [in_gait(with_vertical(PLATEAUS), UNKNOWN, gait) for gait in Gait]
    assert [found.length_m for found in pushed(*steps, model="gait-table")] == [0.74, 0.74, 1.01, 1.70]


def run_step(range_mps2: float, period_s: float, number: int) -> Step:
    """One of a row of running steps."""
    vertical = range_mps2 * np.sin(2.0 * np.pi * np.arange(20) / 20) / 2.0
    time_s = 10.0 + number * period_s
    a_step = step(time_s, time_s - period_s, frequency_hz=1.0 / period_s if number else 0.0, vertical_mps2=vertical)
    return in_gait(a_step, RUNNING)


def test_running_by_hand() -> None:
    """1 m at 2.6 steps a second and 27 m/s^2; square root of the cadence, power 0.6 of the range."""
    steps = [run_step(54.0, 1.0 / 3.0, number) for number in range(4)]
    walker = WalkerParams(height_m=1.73)
    lengths = [found.length_m for found in pushed(*steps, walker=walker, model="walk-run")]
    assert lengths == pytest.approx([(3.0 / 2.6) ** 0.5 * 2.0**0.6] * 4)


def test_running_goes_by_three_steps_since_the_last_standstill() -> None:
    steps = [run_step(27.0, 0.42, 0), run_step(27.0, 0.4, 1), run_step(54.0, 0.3, 2), run_step(13.5, 0.3, 3)]
    cadence_hz = np.array([1.0 / 0.42, 2.5, 1.0 / 0.35, 1.0 / 0.3])  # the first is assumed
    intensity = 27.0 * 2.0 ** np.array([0.0, 0.0, 1.0 / 3.0, 0.0])
    expected = np.sqrt(cadence_hz / 2.6) * (intensity / 27.0) ** 0.6
    walker = WalkerParams(height_m=1.73)
    found = pushed(*steps, steps[0], walker=walker, model="walk-run")
    assert [item.length_m for item in found] == pytest.approx([*expected, expected[0]])


def test_doubts_about_a_gentle_walk_do_not_shorten_it() -> None:
    a_step = with_vertical(0.2 * PLATEAUS, start_s=0.6)
    (sure,), (doubted,) = (
        pushed(in_gait(a_step, probability), model="walk-run") for probability in (WALKING, (0.7, 0.2, 0.1))
    )
    assert doubted.length_m == pytest.approx(sure.length_m)
    assert doubted.sigma_length_m > sure.sigma_length_m


def test_speed_of_running_grows_with_intensity_and_is_bounded_for_knocks() -> None:
    speeds = [
        pushed(*(run_step(range_mps2, 0.36, number) for number in range(3)), model="walk-run")[-1].length_m / 0.36
        for range_mps2 in (18.0, 27.0, 40.0, 60.0, 300.0)
    ]
    assert all(np.diff(speeds[:4]) > 0.2)
    assert speeds[0] < 2.5
    assert 4.0 < speeds[3] < 6.0
    assert speeds[4] == pytest.approx(speeds[3])


def test_length_and_sigma_are_continuous_in_the_gait_probability() -> None:
    a_step = with_vertical(3.0 * PLATEAUS, start_s=0.6)
    shares = np.linspace(0.0, 1.0, 201)
    found = [
        pushed(in_gait(a_step, (1.0 - share, share / 2.0, share / 2.0)), model="walk-run")[0] for share in shares
    ]
    length, sigma = (np.array([getattr(item, name) for item in found]) for name in ("length_m", "sigma_length_m"))
    (unknown,) = pushed(in_gait(a_step, UNKNOWN), model="walk-run")
    assert (length[0], sigma[0]) == (unknown.length_m, unknown.sigma_length_m)
    np.testing.assert_allclose(np.diff(length), (length[-1] - length[0]) / 200)
    assert np.abs(np.diff(sigma)).max() < 0.03
    assert (sigma[0], sigma[-1]) == (pytest.approx(0.07 * length[0]), pytest.approx(0.20 * length[-1]))
    assert sigma[100] > 0.45 * (length[-1] - length[0])  # which of the two it is, nobody knows


def test_the_sigma_of_a_walk_by_its_steps_is_that_of_independent_steps() -> None:
    """And of those alone: what is common to all steps must come from the uncertainty of the walker's scale."""
    rng = np.random.default_rng(3)
    steps, walks = 50, 4000
    walking, running = (0.7, 0.05), (1.0, 0.2)
    mean_m, sigma_m = mixture_mean_and_sigma(0.3, walking, running)

    def lengths_m(runs: Array) -> Array:
        return np.where(runs, rng.normal(*running, (walks, steps)), rng.normal(*walking, (walks, steps))).sum(axis=1)

    independent = lengths_m(rng.random((walks, steps)) < 0.3)
    assert independent.mean() == pytest.approx(steps * mean_m, rel=0.002)
    assert independent.std() == pytest.approx(np.sqrt(steps) * sigma_m, rel=0.05)
    all_or_none = lengths_m(np.repeat(rng.random((walks, 1)) < 0.3, steps, axis=1))
    assert all_or_none.mean() == pytest.approx(steps * mean_m, rel=0.03)
    assert all_or_none.std() > 4.0 * np.sqrt(steps) * sigma_m


def test_a_mixture_by_hand() -> None:
    assert mixture_mean_and_sigma(0.0, (0.7, 0.1), (1.0, 0.2)) == pytest.approx((0.7, 0.1))
    assert mixture_mean_and_sigma(1.0, (0.7, 0.1), (1.0, 0.2)) == pytest.approx((1.0, 0.2))
    assert mixture_mean_and_sigma(0.5, (0.6, 0.0), (1.0, 0.0)) == pytest.approx((0.8, 0.2))
    assert mixture_mean_and_sigma(0.5, (0.6, 0.3), (0.6, 0.4)) == pytest.approx((0.6, np.sqrt(0.125)))


@pytest.mark.parametrize(
    ("probability", "expected"),
    [(UNKNOWN, 0.0), (WALKING, 0.0), (RUNNING, 1.0), ((0.6, 0.3, 0.1), 0.4), ((0.0, 0.6, 0.4000001), 1.0)],
)
def test_jogging_counts_as_running(probability: tuple[float, float, float], expected: float) -> None:
    share = share_of_running(in_gait(with_vertical(PLATEAUS), probability), cadence_hz=2.6)
    assert share == pytest.approx(expected)


@pytest.mark.parametrize(("cadence_hz", "expected"), [(1.5, 0.0), (2.0, 0.0), (2.125, 0.5), (2.25, 1.0), (3.2, 1.0)])
def test_nobody_runs_at_the_cadence_of_a_walk(cadence_hz: float, expected: float) -> None:
    running = in_gait(with_vertical(PLATEAUS), RUNNING)
    assert share_of_running(running, cadence_hz) == pytest.approx(expected)


@pytest.mark.parametrize("model", LENGTH_MODELS)
@pytest.mark.parametrize("probability", [UNKNOWN, WALKING, (0.5, 0.25, 0.25)])
def test_personal_constants_multiply_every_model(model: str, probability: tuple[float, float, float]) -> None:
    person = replace(MAN, length_scale=1.1, cadence_exponent=0.5, reference_cadence_hz=1.6)
    a_step = in_gait(with_vertical(PLATEAUS, start_s=1.0 - 1.0 / 2.2), probability)  # 2.2 steps a second
    (usual,), (own,) = (pushed(a_step, walker=walker, model=model) for walker in (MAN, person))
    factor = 1.1 * np.sqrt(2.2 / 1.6)
    assert own.length_m == pytest.approx(factor * usual.length_m)
    assert own.sigma_length_m == pytest.approx(factor * usual.sigma_length_m)


def test_the_personal_cadence_is_that_of_the_last_three_steps() -> None:
    person = replace(MAN, cadence_exponent=1.0, reference_cadence_hz=1.0)
    intervals_s = (0.5, 0.8, 0.5, 0.8, 0.8)
    steps = [with_vertical(PLATEAUS, start_s=1.0 - interval_s) for interval_s in intervals_s]
    found = pushed(*steps, walker=person, model="static")
    # The first interval, which is an assumed one, does not count any more.
    assert [0.747 / item.length_m for item in found] == pytest.approx([0.5, 0.8, 0.65, 0.8, 0.8])


def test_the_cadence_is_that_of_the_last_three_steps() -> None:
    """Intervals of 0.8, 0.4, 0.5 and 0.6 s after the first step: medians 0.8, 0.6, 0.5 and 0.5 s."""
    meter = PaceMeter()
    meter.at(with_vertical(PLATEAUS, frequency_hz=0.0))
    found = [meter.at(with_vertical(PLATEAUS, start_s=1.0 - interval_s)) for interval_s in (0.8, 0.4, 0.5, 0.6)]
    assert [pace.cadence_hz for pace in found] == pytest.approx([1.0 / 0.8, 1.0 / 0.6, 2.0, 2.0])


@pytest.mark.parametrize("begins", ["standstill", "gap"])
def test_a_walk_begins_with_a_new_cadence(begins: str) -> None:
    """The first interval is the assumed one: it stands for that step alone."""
    meter = PaceMeter()
    for _ in range(4):
        meter.at(with_vertical(PLATEAUS, start_s=0.3))
    first = with_vertical(PLATEAUS, start_s=0.4, frequency_hz=0.0 if begins == "standstill" else 1.96)
    second, third = with_vertical(2.0 * PLATEAUS, start_s=0.5), with_vertical(PLATEAUS, start_s=0.55)
    walk = [first, second, third]
    if begins == "gap":
        walk = [replace(item, event=replace(item.event, segment=item.event.segment + 1)) for item in walk]
    found = [meter.at(item) for item in walk]
    assert [pace.cadence_hz for pace in found] == pytest.approx([1.0 / 0.6, 2.0, 1.0 / 0.475])
    assert [pace.range_mps2 for pace in found[:2]] == pytest.approx([16.0, 16.0 * np.sqrt(2.0)])


def test_beyond_the_cadences_of_walking_the_personal_factor_stays() -> None:
    person = replace(MAN, length_scale=1.1, cadence_exponent=1.0, reference_cadence_hz=1.75)
    found = [person.personal_factor(cadence_hz) for cadence_hz in (0.1, 0.7, 1.75, 2.5, 9.0)]
    assert found == pytest.approx([0.44, 0.44, 1.1, 1.1 * 2.5 / 1.75, 1.1 * 2.5 / 1.75])


@pytest.mark.parametrize("model", LENGTH_MODELS)
def test_a_step_that_had_begun_before_counts_for_its_part(model: str) -> None:
    whole = with_vertical(3.0 * np.sin(np.linspace(0.0, 2.0 * np.pi, 40)))
    stage = StepLength(RATE_HZ, MAN, StepLengthParams(model=model))  # type: ignore[arg-type]
    ((full,), (part,)) = (stage.push(item) for item in (whole, replace(whole, recorded_share=0.25)))
    assert part.length_m == pytest.approx(0.25 * full.length_m)
    assert part.sigma_length_m == full.sigma_length_m
