"""The turn of a walker who puts one of two phones elsewhere, from the other phone."""

from dataclasses import replace

import numpy as np
import pytest

from pdr_est.front_end.step_noise import step_covariance
from pdr_est.pipeline.other_devices import with_turns_of_others
from pdr_est.types.measurements import DeviceMeasurements, StepOdometry, TurnHypothesis

TURN_RAD = 1.5  # of the walker, while one phone is put elsewhere
TURNS = (
    TurnHypothesis(0.7, 0.0, 0.05, "straight on"),
    TurnHypothesis(0.2, 1.4, 0.3, "principal axis"),
    TurnHypothesis(0.1, -1.6, 0.3, "any direction"),
)


def device(
    name: str, changes: dict[int, float], undecided: tuple[int, ...] = (), shift_s: float = 0.0
) -> DeviceMeasurements:
    """20 steps with some heading changes; at the undecided ones the mixture above."""
    steps = []
    for k in range(20):
        covariance = step_covariance(0.7, 0.05, 0.1, 0.02)
        turns = TURNS if k in undecided else ()
        if turns:
            covariance = step_covariance(0.7, 0.05, 0.1, 0.9)
        steps.append(
            StepOdometry(
                name,
                0.5 * k + shift_s,
                0.5 * k - 0.5 + shift_s,
                0.7,
                changes.get(k, 0.0),
                covariance,
                turn_hypotheses=turns,
            )
        )
    return DeviceMeasurements(name, -1.0, tuple(steps))


def step_10(device: DeviceMeasurements) -> StepOdometry:
    step = device.measurements[10]
    assert isinstance(step, StepOdometry)
    return step


def test_a_phone_that_stays_tells_the_turn() -> None:
    moved, still = device("a", {}, undecided=(10,)), device("b", {9: TURN_RAD}, shift_s=0.1)
    found, same = with_turns_of_others([moved, still])
    assert same == still
    step = step_10(found)
    assert step.heading_change_rad == pytest.approx(1.45, abs=0.1)
    assert np.sqrt(step.covariance[2, 2]) < 0.6
    assert step.turn_hypotheses[0].origin == "other device"
    assert step.turn_hypotheses[0].probability > 0.85
    assert sum(one.probability for one in step.turn_hypotheses) == pytest.approx(1.0)
    assert np.linalg.eigvalsh(step.covariance).min() > 0.0


def test_a_phone_that_agrees_with_going_straight_on_makes_it_certain() -> None:
    found, _ = with_turns_of_others([device("a", {}, undecided=(10,)), device("b", {})])
    step = step_10(found)
    assert step.turn_hypotheses[0].origin == "straight on"
    assert step.heading_change_rad == pytest.approx(0.0, abs=0.05)


@pytest.mark.parametrize("number", [4, 10, 12])
def test_a_phone_that_was_put_elsewhere_as_well_tells_nothing(number: int) -> None:
    moved = device("a", {}, undecided=(10,))
    found, _ = with_turns_of_others([moved, device("b", {9: TURN_RAD}, undecided=(number,))])
    assert (step_10(found) == step_10(moved)) is (number <= 10)


def test_one_phone_alone_is_left_as_it_is() -> None:
    alone = device("a", {3: 0.4}, undecided=(10,))
    assert with_turns_of_others([alone]) == [alone]


def test_a_phone_that_did_not_record_then_tells_nothing() -> None:
    moved = device("a", {}, undecided=(10,))
    late = device("b", {9: TURN_RAD})
    late = replace(late, measurements=late.measurements[9:])
    found, _ = with_turns_of_others([moved, late])
    assert step_10(found) == step_10(moved)
