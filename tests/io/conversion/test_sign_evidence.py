"""What tells the sign of an acceleration without attitude: screen, unit, magnetic dip, and turns of fixes."""

from functools import cache

import numpy as np
import pytest

from pdr_est.frames import Array
from pdr_est.io.conversion.sign_evidence import dip_evidence, screen_evidence, turn_evidence, unit_evidence
from pdr_est.simulate import SimulatedWalk, preset, simulate_walk
from pdr_est.types.recording import Signal


def resting(direction: tuple[float, float, float]) -> Signal:
    return Signal(np.arange(100) / 50.0, np.tile(9.8 * np.array(direction), (100, 1)))


@cache
def walked() -> SimulatedWalk:
    return simulate_walk(preset("l_shape")).with_fixes(1.0, 1.0)


def phone() -> tuple[Signal, Signal]:
    device = walked().recording.devices[0]
    assert device.specific_force is not None
    assert device.rotation_rate is not None
    return device.specific_force, device.rotation_rate


def negated(signal: Signal) -> Signal:
    return Signal(signal.time_s, -signal.values)


def test_the_screen_faces_up_and_either_sign_of_the_other_axes_is_alike() -> None:
    assert screen_evidence(resting((0.0, 0.0, 1.0))).log_odds == pytest.approx(4.0)
    assert screen_evidence(resting((0.0, 0.0, -1.0))).log_odds == pytest.approx(-4.0)
    assert screen_evidence(resting((0.0, 1.0, 0.0))).log_odds == 0.0


def test_metres_are_mostly_up_and_g_says_nothing() -> None:
    assert unit_evidence(1.0).log_odds > 2.0
    assert unit_evidence(9.80665).log_odds == 0.0


@pytest.mark.parametrize(("latitude_deg", "sign"), [(None, 1.0), (50.0, 1.0), (-35.0, -1.0)])
def test_the_field_points_down_in_the_north_and_up_in_the_south(latitude_deg: float | None, sign: float) -> None:
    field = Signal(np.arange(100) / 50.0, np.tile([0.0, 20.0, -40.0], (100, 1)))
    up = dip_evidence(resting((0.0, 0.0, 1.0)), field, latitude_deg)
    down = dip_evidence(resting((0.0, 0.0, -1.0)), field, latitude_deg)
    assert up is not None
    assert down is not None
    assert up.log_odds * sign > 0.0 > down.log_odds * sign


def test_the_field_says_nothing_at_the_equator_or_where_it_is_level() -> None:
    steep = Signal(np.arange(100) / 50.0, np.tile([0.0, 20.0, -40.0], (100, 1)))
    level = Signal(np.arange(100) / 50.0, np.tile([0.0, 40.0, -2.0], (100, 1)))
    assert dip_evidence(resting((0.0, 0.0, 1.0)), steep, 5.0) is None
    assert dip_evidence(resting((0.0, 0.0, 1.0)), level) is None


def test_turns_of_fixes_prove_the_sign() -> None:
    force, rate = phone()
    up, down = (turn_evidence(one, rate, walked().recording.fixes) for one in (force, negated(force)))
    assert up is not None
    assert down is not None
    assert up.log_odds > 1.0
    assert down.log_odds == pytest.approx(-up.log_odds, abs=0.2)


def test_a_damaged_sample_does_not_hide_the_turns() -> None:
    force, rate = phone()
    values: Array = force.values.copy()
    values[50] = 1e12
    evidence = turn_evidence(Signal(force.time_s, values), rate, walked().recording.fixes)
    assert evidence is not None
    assert evidence.log_odds > 1.0


def test_fixes_that_lie_together_show_no_turn() -> None:
    force, rate = phone()
    assert turn_evidence(force, rate, walked().recording.fixes[:8]) is None
    assert turn_evidence(force, rate, ()) is None
