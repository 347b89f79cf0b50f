"""Our law of the step length by the shape of the vertical acceleration."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from signals import RATE_HZ, corner_walk, levels_of, run, step

from pdr_est.config import Config
from pdr_est.frames import Array
from pdr_est.front_end.step_length import HarmonicParams, StepLength, StepLengthParams, WalkerParams
from pdr_est.front_end.step_length.harmonic_model import (
    TurnMeter,
    first_harmonic_mps2,
    harmonic_length_m,
    upper_values_mps2,
    walked_part,
)
from pdr_est.pipeline.front_end_chain import stepping
from pdr_est.types.steps import Step

CONSTANTS = HarmonicParams()


def sine(amplitude_mps2: float, count: int, harmonic: int = 1, phase_rad: float = 0.3) -> Array:
    return amplitude_mps2 * np.sin(2.0 * np.pi * harmonic * np.arange(count) / count + phase_rad)


def turning(yaw_rad: Array, frequency_hz: float = 1.9) -> Step:
    a_step = step(1.0, 0.5, frequency_hz=frequency_hz, vertical_mps2=np.zeros(len(yaw_rad)))
    rate_radps = (yaw_rad[-1] - yaw_rad[0]) / (a_step.event.time_s - a_step.start_s)
    return replace(a_step, samples=replace(a_step.samples, turn_rate_radps=np.full(len(yaw_rad), rate_radps)))


def test_the_first_harmonic_is_that_of_the_step_alone() -> None:
    signal = 5.0 + sine(3.0, 25) + sine(2.0, 25, harmonic=2) + sine(1.0, 25, harmonic=3)
    assert first_harmonic_mps2(signal) == pytest.approx(3.0)


def test_the_upper_values_are_exceeded_by_a_tenth_about_the_mean() -> None:
    assert upper_values_mps2(np.arange(11.0) + 7.0) == pytest.approx(9.0 - 5.0)
    signal = np.random.default_rng(1).normal(size=33)
    assert upper_values_mps2(signal) == pytest.approx(np.quantile(signal, 0.9) - signal.mean())
    assert upper_values_mps2(sine(2.0, 1000)) == pytest.approx(2.0 * np.cos(0.1 * np.pi), rel=1e-3)


def test_a_step_by_hand() -> None:
    vertical = sine(3.0, 1000)
    upper = 3.0 * np.cos(0.1 * np.pi)
    expected = 0.761 * 1.8 / 1.73 * 3.0**0.59 * upper**-0.4 * 0.5**0.4 * np.exp(-0.25 * 0.2)
    assert harmonic_length_m(CONSTANTS, 1.8, 0.5, 0.2, vertical) == pytest.approx(expected, rel=1e-3)


def test_a_usual_step_has_a_usual_length() -> None:
    """Amplitudes and durations of a stroll, a walk and a jog on a treadmill, 2.2 m/s."""
    lengths = [
        harmonic_length_m(CONSTANTS, 1.73, duration_s, 0.0, sine(amplitude, 40) + sine(0.2 * amplitude, 40, 2))
        for amplitude, duration_s in ((1.1, 0.68), (3.0, 0.53), (13.5, 0.37))
    ]
    assert lengths == pytest.approx([0.67, 0.74, 0.85], abs=0.04)


def test_a_sharp_blow_does_not_lengthen_a_step() -> None:
    smooth = sine(2.0, 50)
    knocked = smooth + np.where(np.arange(50) % 25 < 4, 4.0, 0.0)
    lengths = [harmonic_length_m(CONSTANTS, 1.73, 0.55, 0.0, signal) for signal in (smooth, knocked)]
    assert lengths[1] < lengths[0]


@pytest.mark.parametrize("shift", [0, 7, 31])
def test_the_sample_that_begins_a_step_does_not_matter(shift: int) -> None:
    signal = sine(2.0, 40) + sine(0.8, 40, harmonic=2, phase_rad=1.0)
    lengths = [harmonic_length_m(CONSTANTS, 1.73, 0.6, 0.0, np.roll(signal, by)) for by in (0, shift)]
    assert lengths[1] == pytest.approx(lengths[0], rel=1e-9)


@pytest.mark.parametrize("rate_hz", [25.0, 100.0, 200.0])
def test_the_length_hardly_changes_with_the_sampling_rate(rate_hz: float) -> None:
    def lengths_m(rate_hz: float) -> float:
        config = Config()
        blocks = levels_of(corner_walk(), config, rate_hz)
        return sum(
            found.length_m
            for found in run(stepping(replace(config, resample=replace(config.resample, rate_hz=rate_hz))), blocks)
        )

    assert lengths_m(rate_hz) == pytest.approx(lengths_m(RATE_HZ), rel=0.03)


def test_the_turn_is_that_of_the_last_four_steps() -> None:
    meter = TurnMeter()
    ends_rad = np.array([0.0, 0.4, 0.4, 0.4, 0.4, 3.0, 3.3, 3.3])
    yaw_rad = [np.linspace(begin, end, 20) for begin, end in pairwise(ends_rad)]
    found = [meter.at(turning(part)) for part in yaw_rad]
    assert found == pytest.approx([0.4, 0.2, 0.4 / 3.0, 0.1, 2.6 / 4.0, 2.9 / 4.0, 2.9 / 4.0])


def test_a_phone_that_turns_to_and_fro_within_a_stride_does_not_turn() -> None:
    meter = TurnMeter()
    swings = [turning(np.linspace(0.0, 0.5, 20)), turning(np.linspace(0.5, 0.0, 20))] * 4
    assert [meter.at(item) for item in swings][3::2] == pytest.approx([0.0, 0.0, 0.0], abs=1e-12)


def test_a_walk_begins_without_the_turns_of_the_last_one_and_a_turn_is_bounded() -> None:
    meter = TurnMeter()
    assert meter.at(turning(np.linspace(0.0, 2.5, 20))) == 1.0
    assert meter.at(turning(np.linspace(1.0, 1.1, 20), frequency_hz=0.0)) == pytest.approx(0.1)


def test_a_step_on_the_spot_is_shorter() -> None:
    stage = StepLength(RATE_HZ, WalkerParams(), StepLengthParams())
    straight, about = (
        replace(turning(yaw_rad), samples=replace(turning(yaw_rad).samples, vertical_mps2=sine(2.0, 25)))
        for yaw_rad in (np.zeros(25), np.linspace(0.0, 0.8, 25))
    )
    lengths = [stage.push(item)[0].length_m for item in (straight, replace(about, frequency_hz=0.0))]
    assert lengths[1] == pytest.approx(np.exp(-0.25 * 0.8) * lengths[0])


def test_without_gyroscope_a_step_counts_as_straight() -> None:
    assert TurnMeter().at(turning(np.full(20, np.nan))) == 0.0


@pytest.mark.parametrize("blow_mps2", [0.0, 3.0, 40.0])
def test_lengths_stay_those_of_people(blow_mps2: float) -> None:
    for amplitude in (0.0, 0.1, 1.0, 5.0, 15.0, 30.0):
        signal = sine(amplitude, 30) + np.where(np.arange(30) == 11, blow_mps2, 0.0)
        assert 0.15 < harmonic_length_m(CONSTANTS, 1.73, 0.5, 0.0, signal) < 1.3


def test_an_interval_shorter_than_any_step_counts_for_its_time() -> None:
    assert walked_part(CONSTANTS, 0.4) == walked_part(CONSTANTS, 0.7) == 1.0
    halves = [
        walked_part(CONSTANTS, duration_s) * harmonic_length_m(CONSTANTS, 1.73, duration_s, 0.0, sine(3.0, 20))
        for duration_s in (0.15, 0.3)
    ]
    assert halves[1] == pytest.approx(2.0 * halves[0])


@pytest.mark.parametrize(("gait", "expected"), [((1.0, 0.0, 0.0), 0.9**0.6), ((0.0, 0.0, 1.0), 1.0)])
def test_a_runner_takes_such_steps_and_a_walker_does_not(gait: tuple[float, float, float], expected: float) -> None:
    short = replace(
        step(1.0, 0.64, frequency_hz=1.0 / 0.36, vertical_mps2=sine(6.0, 18)),
        gait_probability=gait,
        recorded_share=1.0,
    )
    (sized,) = StepLength(RATE_HZ, WalkerParams(), StepLengthParams()).push(short)
    whole = harmonic_length_m(CONSTANTS, 1.73, 0.36, 0.0, short.samples.vertical_mps2)
    assert sized.length_m == pytest.approx(expected * whole)
