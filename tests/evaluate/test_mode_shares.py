"""The share of walking time that each carrying mode has."""

from math import isnan

import numpy as np
import pytest

from pdr_est.evaluate.carrying_modes import mode_shares
from pdr_est.types.sensors import LevelBlock
from pdr_est.types.steps import CarryingMode, Step, StepEvent

HOLDING, SWING = CarryingMode.HOLDING, CarryingMode.SWING


def step(end_s: float, lasts_s: float, mode: CarryingMode) -> Step:
    none = np.zeros(0)
    vectors = np.zeros((0, 3))
    samples = LevelBlock(0, 0, none, vectors, vectors, none, none, vectors, none, np.zeros(0, dtype=np.int8), none)
    return Step(StepEvent(0, end_s, 0, mode), end_s - lasts_s, 0.0, samples)


def test_shares_are_of_time_and_the_longest_comes_first() -> None:
    shares = mode_shares([step(1.0, 0.5, HOLDING), step(2.5, 1.5, SWING), step(3.0, 0.5, HOLDING)])
    assert list(shares.items()) == [(SWING, pytest.approx(0.6)), (HOLDING, pytest.approx(0.4))]


def test_of_two_equal_modes_the_lower_number_comes_first() -> None:
    assert list(mode_shares([step(1.0, 0.5, SWING), step(1.5, 0.5, HOLDING)])) == [HOLDING, SWING]


def test_no_steps_have_no_shares_and_steps_without_time_unknown_ones() -> None:
    assert mode_shares([]) == {}
    assert isnan(mode_shares([step(1.0, 0.0, HOLDING)])[HOLDING])
