"""The stride in a signal, and slow walkers with a phone in the pocket, whose legs add humps between steps."""

from dataclasses import replace

import numpy as np
import pytest
from signals import RATE_HZ

from pdr_est import pipeline
from pdr_est.config import Config
from pdr_est.errors import ConfigError
from pdr_est.frames import Array
from pdr_est.front_end.steps import StepsParams
from pdr_est.front_end.steps.bandpass_peaks import AutoStepParams
from pdr_est.front_end.steps.stride_period import StridePeriod, StridePeriodParams
from pdr_est.simulate import DeviceParams, PathParams, Scenario, SensorParams, SimulatedWalk, simulate_walk
from pdr_est.simulate.people.person import sample_person


def stride_in(signal: Array, later: int = 0) -> float:
    stride = StridePeriod(RATE_HZ, StridePeriodParams())
    stride.append(signal, len(signal))
    return stride.ending_at(later)


def limping(stride_s: float, weak: float, duration_s: float = 8.0) -> Array:
    """Two humps a stride, one of them weaker."""
    phase = 2.0 * np.pi * np.arange(round(duration_s * RATE_HZ)) / RATE_HZ / stride_s
    signal: Array = np.cos(2.0 * phase) + (1.0 - weak) * np.cos(phase)
    return signal


@pytest.mark.parametrize("stride_s", [0.9, 1.08, 1.5, 2.0])
def test_a_stride_is_where_the_signal_repeats(stride_s: float) -> None:
    assert stride_in(limping(stride_s, weak=0.3)) == pytest.approx(stride_s, abs=1.5 / RATE_HZ)


def test_what_is_later_does_not_count() -> None:
    signal = np.concatenate([limping(1.2, 0.3), limping(1.8, 0.3)])
    assert stride_in(signal, later=400) == pytest.approx(1.2, abs=0.02)
    assert stride_in(signal) == pytest.approx(1.8, abs=0.02)


def test_without_a_rhythm_there_is_no_stride() -> None:
    assert stride_in(np.random.default_rng(0).standard_normal(400)) == np.inf
    assert stride_in(limping(1.2, 0.3, duration_s=3.0)) == np.inf
    assert stride_in(np.zeros(400)) == np.inf


@pytest.mark.parametrize(
    "times", [{"longest_s": 3.5}, {"least_s": 7.0}, {"shortest_s": 2.4}, {"longest_s": 3.495, "memory_s": 3.4}]
)
def test_times_that_do_not_rise_are_refused(times: dict[str, float]) -> None:
    with pytest.raises(ConfigError, match="do not rise"):
        StridePeriod(RATE_HZ, StridePeriodParams(**times))


def test_the_longest_stride_may_be_as_long_as_what_there_is() -> None:
    parameters = StridePeriodParams(longest_s=3.499, least_s=3.5)
    stride = StridePeriod(RATE_HZ, parameters)
    signal = limping(1.2, 0.3, duration_s=3.5)
    stride.append(signal, len(signal))
    assert stride.ending_at(0) == pytest.approx(1.2, abs=0.03)


def in_pocket(seed: int, cadence_hz: float, rate_hz: float) -> SimulatedWalk:
    person = sample_person(np.random.default_rng(seed))
    return simulate_walk(
        Scenario(
            path=PathParams(vertices_m=((0.0, 0.0), (30.0, 0.0), (30.0, 15.0))),
            gait=replace(person.gait, cadence_hz=cadence_hz, cadence_variation=0.02),
            body=person.body,
            devices=(DeviceParams(carry=person.pocket, sensors=SensorParams(rate_hz=rate_hz)),),
            seed=seed,
        )
    )


@pytest.mark.parametrize("cadence_hz", [1.3, 1.6, 2.1])
@pytest.mark.parametrize("rate_hz", [24.0, 50.0])
def test_slow_legs_add_no_steps(cadence_hz: float, rate_hz: float) -> None:
    for seed in (0, 1):
        walk = in_pocket(seed, cadence_hz, rate_hz)
        (found,) = pipeline.analyse_recording(walk.recording, Config())
        assert walk.recording.truth.steps is not None
        assert len(found.steps) / len(walk.recording.truth.steps.time_s) == pytest.approx(1.0, abs=0.05)


def test_the_share_of_half_a_stride_is_what_refuses_them() -> None:
    walk = in_pocket(1, 1.3, 50.0)
    without = StepsParams(auto=AutoStepParams(pocket_interval_share=0.0))
    (before,) = pipeline.analyse_recording(walk.recording, replace(Config(), steps=without))
    (after,) = pipeline.analyse_recording(walk.recording, Config())
    assert len(before.steps) > 1.1 * len(after.steps)
