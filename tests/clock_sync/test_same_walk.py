"""The probability that two phones recorded one walk: slow walkers, strangers with the same rhythm, and real pairs."""

from dataclasses import replace
from functools import cache
from itertools import combinations, product
from pathlib import Path

import numpy as np
import pytest

from pdr_est.clock_sync import apply_clock, estimate_clock_from_motion
from pdr_est.clock_sync.clock_jumps import jump_log_likelihood_ratio
from pdr_est.clock_sync.common_signals import RATE_HZ, CommonSignals, extract_common_signals
from pdr_est.clock_sync.robust_line import constant_offset_line
from pdr_est.clock_sync.same_walk import same_walk_log_odds
from pdr_est.clock_sync.step_duration import usual_step_samples
from pdr_est.io import read
from pdr_est.simulate import robust_dr_trials, simulate_walk
from pdr_est.types.clock import ClockEstimate
from pdr_est.types.recording import DeviceRecording

CERTAIN = 3.0  # log-odds, 20 to 1


@cache
def slow_walk(number: int) -> tuple[DeviceRecording, DeviceRecording]:
    """Two phones in two pockets at three quarters of the usual cadence; no leg feels much of the other one."""
    left, right = simulate_walk(replace(robust_dr_trials(0, 8)[number], irons=())).recording.devices
    return left, right


@cache
def signals(number: int, phone: int) -> CommonSignals:
    return extract_common_signals(slow_walk(number)[phone])


def noise(rng: np.random.Generator, cycles: float, wander: float) -> np.ndarray:
    """Step phasors of a minute: cycles a second, with a phase that wanders by so much in a second's root."""
    phase = np.cumsum(2.0 * np.pi * cycles / RATE_HZ + wander * rng.standard_normal(3000) / np.sqrt(RATE_HZ))
    return 0.8 * np.exp(1j * phase)


def steps_only(phasor: np.ndarray) -> CommonSignals:
    return CommonSignals(0.0, np.zeros(len(phasor)), phasor.real, phasor, None)


@pytest.mark.parametrize("number", [0, 3, 5])
def test_slow_walkers_with_two_pockets_are_one_walk_with_known_clocks(number: int) -> None:
    left, right = slow_walk(number)
    log_odds = same_walk_log_odds(signals(number, 0), signals(number, 1), (0.0,))
    assert log_odds is not None
    assert log_odds > 2.0 * CERTAIN
    clock = estimate_clock_from_motion(left, apply_clock(right, ClockEstimate(offset_s=-2.0, skew=0.0, sigma_s=0.0)))
    assert clock.doubts == ()
    assert clock.offset_s == pytest.approx(2.0, abs=0.02)


def test_slow_walks_of_different_people_on_one_route_are_not() -> None:
    for one, two in combinations((0, 3, 5), 2):
        log_odds = same_walk_log_odds(signals(one, 0), signals(two, 1), (0.0,))
        assert log_odds is not None
        assert log_odds < 0.0


def test_an_agreement_counts_by_how_unlikely_it_is_by_chance() -> None:
    """The same phasors tell one walk where the rhythm wanders; a metronome agrees with every other one."""
    rng = np.random.default_rng(0)
    wandering, even = noise(rng, 1.8, 0.8), noise(rng, 1.8, 0.02)
    sure, unsure = (same_walk_log_odds(steps_only(own), steps_only(own), (0.0,)) for own in (wandering, even))
    assert sure is not None
    assert sure > CERTAIN
    assert unsure is not None
    assert abs(unsure) < CERTAIN
    strangers = [
        same_walk_log_odds(steps_only(noise(rng, 1.8, 0.8)), steps_only(noise(rng, 1.8, 0.8)), (0.0,))
        for _ in range(40)
    ]
    assert max(strangers) < 0.0  # type: ignore[type-var]


def test_nobody_walks_long_enough() -> None:
    phasor = noise(np.random.default_rng(0), 1.8, 0.5)
    assert same_walk_log_odds(steps_only(phasor[:1200]), steps_only(phasor[:1200]), (0.0,)) is None
    assert same_walk_log_odds(steps_only(0.1 * phasor), steps_only(phasor), (0.0,)) is None


@pytest.mark.parametrize("stride_s", [0.8, 1.1, 1.5])
@pytest.mark.parametrize("third", [0.0, 1.5])
def test_a_step_is_half_a_stride_even_where_the_third_harmonic_is_the_strongest(
    stride_s: float, third: float
) -> None:
    """A leg that hardly feels the other one repeats with the stride; the other leg does so half a stride later."""
    time_s = np.arange(0.0, 30.0, 1.0 / RATE_HZ)
    wander_s = 0.1 * np.sin(0.5 * time_s)

    def leg(behind_s: float) -> np.ndarray:
        turns = 2.0 * np.pi * (time_s + wander_s - behind_s) / stride_s
        return np.exp(2j * turns) + third * np.exp(3j * turns)

    step = usual_step_samples(leg(0.0), leg(0.5 * stride_s))
    assert step / RATE_HZ == pytest.approx(0.5 * stride_s, abs=0.021)


@pytest.mark.parametrize("jump_s", [-3.3, -1.0, 1.9, 5.0])
def test_a_jump_within_the_walk_fits_another_shift_better(jump_s: float) -> None:
    left, right = slow_walk(0)
    assert right.specific_force is not None
    middle_s = float(right.specific_force.time_s.mean())
    jumped = right.with_times(lambda time_s: time_s + np.where(time_s < middle_s, 0.0, jump_s))
    line = constant_offset_line(0.0)
    assert jump_log_likelihood_ratio(signals(0, 0), signals(0, 1), line) < 1.0
    assert jump_log_likelihood_ratio(signals(0, 0), extract_common_signals(jumped), line) > 10.0
    assert estimate_clock_from_motion(left, jumped).poor


@pytest.mark.slow
def test_real_pairs_are_one_walk_and_real_strangers_are_not(shared_data: Path) -> None:
    """WeAllWalk: three people with two phones each on six routes."""
    files = sorted((shared_data / "weallwalk/sensor").glob("*1L*"))
    walks = [[extract_common_signals(device) for device in read(file).devices] for file in files]
    assert len(walks) == 18
    own = [same_walk_log_odds(*walk, (0.0,)) for walk in walks]
    assert min(own) > CERTAIN  # type: ignore[type-var]
    pairs = [pair for walk, other in combinations(walks, 2) for pair in product(walk, other)]
    strangers = [same_walk_log_odds(one, two, (0.0,)) for one, two in pairs]
    assert np.mean([log_odds is not None and log_odds > 0.0 for log_odds in strangers]) < 0.005
