"""UPTIME's state machine on made-up magnitudes whose states follow from the paper's table by hand."""

import numpy as np
import pytest
from signals import level, run

from pdr_est.errors import ConfigError
from pdr_est.frames import STANDARD_GRAVITY_MPS2
from pdr_est.front_end.signal.vectors import excess_magnitude
from pdr_est.front_end.steps.uptime_fsm import UptimeFsm, UptimeFsmParams, UptimeState
from pdr_est.testing import one_by_one

STEP = [0.7, 1.9, 0.0, -1.1, -0.9, -0.5]  # one transition a sample but for the third, at 50 Hz
PEAK = [0.7, 1.9]
TROUGH = [*PEAK, -1.1]


def states(*magnitude: float, rate_hz: float = 50.0, **changes: float) -> list[int]:
    """The state after each sample."""
    stage = UptimeFsm(rate_hz, UptimeFsmParams(**changes))
    found = []
    for block in one_by_one([level(np.array(magnitude), rate_hz=rate_hz)]):
        stage.push(block)
        found.append(int(stage.state))
    return found


def step_indices(magnitude: list[float], rate_hz: float = 50.0, **changes: float) -> list[int]:
    stage = UptimeFsm(rate_hz, UptimeFsmParams(**changes))
    return [event.index for event in run(stage, [level(np.array(magnitude), rate_hz=rate_hz)])]


@pytest.mark.parametrize(
    ("magnitude", "expected"),
    [
        ([0.5, -3.0, 0.5], [0, 0, 0]),
        ([0.5, 0.7, 1.7], [0, 1, 1]),
        ([0.7, 1.9, 1.9], [1, 2, 2]),
        ([1.9, 1.9], [1, 2]),
        ([0.7, 0.5, 0.7], [1, 4, 1]),
        ([0.7, 0.5, 1.9, 1.9], [1, 4, 1, 2]),
        ([0.7, 0.5, 0.5, 0.7], [1, 4, 0, 1]),
        ([0.7, -2.0, -2.0], [1, 4, 0]),
        ([*PEAK, 0.5, -0.9, 1.9], [1, 2, 2, 2, 2]),
        ([*PEAK, -1.1, -3.0], [1, 2, 3, 3]),
        ([*TROUGH, -0.9, -0.7], [1, 2, 3, 5, 5]),
        ([*TROUGH, -0.9, -1.1, -0.9], [1, 2, 3, 5, 3, 5]),
        ([*TROUGH, -0.9, -0.5, -0.5], [1, 2, 3, 5, 6, 0]),
        ([*TROUGH, 0.5, 1.9, 1.9, 1.9], [1, 2, 3, 5, 6, 0, 1]),
    ],
)
def test_every_transition_of_the_table(magnitude: list[float], expected: list[int]) -> None:
    assert states(*magnitude) == expected


@pytest.mark.parametrize(
    ("magnitude", "expected"),
    [
        ([0.6], [0]),
        ([0.7, 1.8], [1, 1]),
        ([0.7, 0.6], [1, 4]),
        ([*PEAK, -1.0], [1, 2, 3]),
        ([*TROUGH, -1.0], [1, 2, 3, 3]),
        ([*TROUGH, -0.9, -0.6], [1, 2, 3, 5, 5]),
    ],
)
def test_a_magnitude_of_exactly_a_threshold_does_not_exceed_it(magnitude: list[float], expected: list[int]) -> None:
    """The thresholds are those of Table I with the rounding of a magnitude of that size."""
    block = level(np.array([0.6, 1.8, -1.0, -0.6]))
    rounded = excess_magnitude(block.up, block.acceleration_mps2).tolist()
    names = ("threshold_mps2", "positive_peak_mps2", "negative_peak_mps2", "negative_threshold_mps2")
    assert states(*magnitude, **dict(zip(names, rounded, strict=True))) == expected


def test_a_step_ends_in_s6() -> None:
    assert step_indices([*STEP, 0.0, 0.0, *STEP]) == [5, 13]
    assert step_indices(STEP[:-1]) == []


@pytest.mark.parametrize("missing", [1, 3])
def test_without_a_positive_or_a_negative_peak_there_is_no_step(missing: int) -> None:
    """Of two humps one lacks its crest or its trough: what follows can only complete the other."""
    hump = [value for position, value in enumerate(STEP) if position != missing]
    assert len(step_indices([*hump, 0.0, *STEP])) == 1
    assert step_indices(hump) == []


def test_a_negative_peak_is_no_positive_one() -> None:
    """The sign of the magnitude less gravity counts, not its size."""
    assert states(-0.7, -1.9, -1.9) == [0, 0, 0]
    assert states(*PEAK, 1.9, 1.1) == [1, 2, 2, 2]


def test_a_new_segment_begins_in_s0() -> None:
    stage = UptimeFsm(50.0, UptimeFsmParams())
    blocks = [level(np.array(STEP[:4])), level(np.array(STEP[4:]), segment=1, first_index=100)]
    assert run(stage, blocks) == []
    assert stage.state is UptimeState.NOT_WALKING


def test_a_step_has_no_time_limit() -> None:
    assert step_indices([*PEAK, *[0.0] * 500, *STEP[3:]]) == [504]


def test_jolts_that_are_over_within_a_transition_are_no_steps() -> None:
    jolt = [0.0, 2.0, -2.0, 0.0, 2.0, -2.0, 0.0]
    assert step_indices(jolt * 5, rate_hz=400.0) == []
    assert step_indices(list(np.repeat(STEP, 8)), rate_hz=400.0) == [40]
    assert step_indices([*STEP, 0.0, *STEP], rate_hz=400.0, transition_s=0.0) == [5, 12]


def test_a_transition_takes_its_time_over_the_border_of_blocks() -> None:
    assert states(0.7, 1.9, 1.9, 1.9, 1.9, rate_hz=100.0) == [1, 1, 2, 2, 2]


def test_thresholds_must_rise() -> None:
    with pytest.raises(ConfigError, match="negative_peak_mps2 < negative_threshold_mps2"):
        UptimeFsm(50.0, UptimeFsmParams(negative_peak_mps2=-0.5))


def test_the_magnitude_by_hand() -> None:
    g = STANDARD_GRAVITY_MPS2
    up = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [0.0, 0.6, 0.8]])
    acceleration = g * np.array([[0.75, 0.0, 0.0], [0.0, 0.5, 0.0], [0.0, -0.6, -0.8]])
    np.testing.assert_allclose(excess_magnitude(up, acceleration), [0.25 * g, 0.5 * g, -g], atol=1e-12)
