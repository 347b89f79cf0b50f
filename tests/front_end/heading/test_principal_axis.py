"""The principal axis of made-up strides with a known direction, and of simulated held phones."""

from dataclasses import replace

import numpy as np
import pytest
from heading_steps import SAMPLES, block, step_of
from signals import corner_walk, levels_of, run

from pdr_est.config import Config
from pdr_est.frames import wrap_angle
from pdr_est.front_end.attitude import AttitudeParams
from pdr_est.front_end.heading import HeadingParams
from pdr_est.front_end.heading.principal_axis import (
    PrincipalAxis,
    PrincipalAxisParams,
    StrideMotion,
    direction_from_steps,
    walking_direction,
)
from pdr_est.pipeline import front_end_chain as chains
from pdr_est.types.steps import CarryingMode, Step

PARAMETERS = PrincipalAxisParams()
PHASE = 2.0 * np.pi * (np.arange(SAMPLES) + 0.5) / SAMPLES
POCKET, SWING, TRANS = CarryingMode.POCKET, CarryingMode.SWING, CarryingMode.TRANS


def stepping(
    number: int,
    forward_deg: float = 0.0,
    yaw_deg: float = 0.0,
    *,
    lead_deg: float = 90.0,
    forward_mps2: float = 2.0,
    sway_mps2: float = 1.5,
    mode: CarryingMode = POCKET,
    compensated: bool = False,
) -> Step:
    """Step `number` of a walk towards forward_deg in the level frame: forward acceleration ahead of the vertical one
    by lead_deg, and a sway to the side with half the frequency."""
    forward = forward_mps2 * np.cos(PHASE + np.deg2rad(lead_deg))
    left = sway_mps2 * np.cos(0.5 * PHASE + np.pi * number + 0.7)
    angle = np.deg2rad(forward_deg - yaw_deg)  # in device axes
    force = np.stack(
        [
            np.cos(angle) * forward - np.sin(angle) * left,
            np.sin(angle) * forward + np.cos(angle) * left,
            3.0 * np.cos(PHASE),
        ],
        axis=1,
    )
    samples = replace(
        block(number, float(np.deg2rad(yaw_deg))), acceleration_mps2=force, vertical_mps2=3.0 * np.cos(PHASE)
    )
    return step_of(samples, mode, compensated)


def error_deg(found_rad: float, true_deg: float) -> float:
    return abs(float(np.rad2deg(wrap_angle(found_rad - np.deg2rad(true_deg)))))


@pytest.mark.parametrize("forward_deg", [0.0, 45.0, 90.0, 100.0, 180.0, -30.0, -135.0])
@pytest.mark.parametrize("yaw_deg", [0.0, 130.0, 180.0])
def test_direction_and_sign_are_exact(forward_deg: float, yaw_deg: float) -> None:
    """The sway, stronger than the forward acceleration even, cancels over whole strides."""
    steps = [stepping(number, forward_deg, yaw_deg, sway_mps2=5.0) for number in range(8)]
    found = direction_from_steps(steps, PARAMETERS)
    assert found is not None
    assert error_deg(found.at(float(np.deg2rad(yaw_deg))), forward_deg) < 1e-6
    assert error_deg(found.offset_rad, yaw_deg - forward_deg) < 1e-6
    assert found.coherence == pytest.approx(1.0)
    assert found.sigma_rad == pytest.approx(PARAMETERS.sigma_rad)


@pytest.mark.parametrize("lead_deg", [60.0, 95.0, 120.0])
def test_the_phase_may_be_off_by_a_third_of_a_quarter(lead_deg: float) -> None:
    found = direction_from_steps([stepping(number, 20.0, lead_deg=lead_deg) for number in range(8)], PARAMETERS)
    assert found is not None
    assert error_deg(found.at(0.0), 20.0) < 1e-6
    assert found.coherence == pytest.approx(np.cos(np.deg2rad(lead_deg - 90.0)))


def test_backwards_is_where_the_acceleration_lags() -> None:
    found = direction_from_steps([stepping(number, 20.0, lead_deg=-90.0) for number in range(8)], PARAMETERS)
    assert found is not None
    assert error_deg(found.at(0.0), -160.0) < 1e-6


@pytest.mark.parametrize("lead_deg", [0.0, 180.0])
def test_without_the_phase_nothing_is_known(lead_deg: float) -> None:
    found = direction_from_steps([stepping(number, 20.0, lead_deg=lead_deg) for number in range(8)], PARAMETERS)
    assert found is not None
    assert found.coherence < 0.3
    assert found.sigma_rad == pytest.approx(np.pi / np.sqrt(3.0))


def test_a_phone_that_feels_nothing() -> None:
    found = direction_from_steps([step_of(block(number), POCKET) for number in range(8)], PARAMETERS)
    assert found is not None
    assert (found.coherence, found.sigma_rad) == (0.0, pytest.approx(np.pi / np.sqrt(3.0)))


def test_what_holds_no_stride_that_counts_tells_nothing() -> None:
    first, second = stepping(0), stepping(1)
    assert direction_from_steps([], PARAMETERS) is None
    assert direction_from_steps([first], PARAMETERS) is None
    assert direction_from_steps([replace(first, frequency_hz=0.0), second], PARAMETERS) is None
    assert direction_from_steps([first, stepping(1, mode=SWING)], PARAMETERS) is None
    assert direction_from_steps([first, stepping(1, compensated=True)], PARAMETERS) is None


@pytest.mark.parametrize(("strides", "trusted"), [(1, False), (2, False), (3, True), (8, True)])
def test_few_strides_are_not_trusted(strides: int, trusted: bool) -> None:
    found = direction_from_steps([stepping(number) for number in range(2 * strides)], PARAMETERS)
    assert found is not None
    assert found.trusted is trusted
    assert (found.sigma_rad < 0.2) is trusted


def test_the_stage_follows_turns_of_the_walker_at_once() -> None:
    """The phone is turned by 70 degrees against the walker, who turns by 90 between two strides."""
    directions = [10.0] * 6 + [100.0] * 6
    steps = [stepping(number, forward, forward + 70.0) for number, forward in enumerate(directions)]
    for step, forward_deg in zip(run(PrincipalAxis(PARAMETERS), steps), directions, strict=True):
        assert error_deg(step.heading_rad, forward_deg) < 1e-6


@pytest.mark.parametrize("alone", [False, True])
def test_the_first_steps_wait_for_strides_that_count(alone: bool) -> None:
    """The walker sets off with a push forward, like a step with the opposite phase; perhaps a standstill follows."""
    steps = [replace(stepping(0, 10.0, 80.0, lead_deg=-90.0, forward_mps2=20.0), frequency_hz=0.0)]
    steps += [stepping(number, 10.0, 80.0) for number in range(1, 14)]
    if alone:
        steps[1] = replace(steps[1], frequency_hz=0.0)
    for step in run(PrincipalAxis(PARAMETERS), steps):
        assert error_deg(step.heading_rad, 10.0) < 1e-6
        assert step.sigma_turn_rad == 0.0


def test_the_stage_keeps_an_offset_that_it_trusts() -> None:
    """Later strides have the wrong phase: they are not believed."""
    steps = [stepping(number, 10.0, 80.0) for number in range(8)]
    steps += [stepping(number, -120.0, 95.0, lead_deg=0.0, forward_mps2=20.0) for number in range(8, 20)]
    found = run(PrincipalAxis(PARAMETERS), steps)
    assert error_deg(found[-1].heading_rad, 25.0) < 1e-6


def test_a_late_correction_of_a_guess_is_told() -> None:
    """Eight strides without the right phase, as long as the stage waits, then eight with it."""
    steps = [stepping(number, 10.0, 80.0, lead_deg=0.0, forward_mps2=0.1) for number in range(16)]
    steps += [stepping(number, 10.0, 80.0) for number in range(16, 32)]
    found = run(PrincipalAxis(PARAMETERS), steps)
    told = [number for number, step in enumerate(found) if step.sigma_turn_rad > 0.0]
    assert len(told) == 1
    assert found[told[0]].sigma_turn_rad == pytest.approx(np.pi / np.sqrt(3.0))
    assert all(error_deg(step.heading_rad, 10.0) < 5.0 for step in found[told[0] :])


def test_steps_wait_for_a_direction_but_not_for_ever() -> None:
    stage = PrincipalAxis(PARAMETERS)
    unsure = [stepping(number, 10.0, lead_deg=0.0) for number in range(20)]
    assert [len(stage.push(step)) for step in unsure] == [0] * 15 + [16, 0, 2, 0, 2]
    stage = PrincipalAxis(PARAMETERS)
    assert [len(stage.push(stepping(number, 10.0))) for number in range(8)] == [0, 0, 0, 0, 0, 6, 0, 2]


def test_a_change_of_mode_forgets_the_strides_before() -> None:
    steps = [stepping(number, 10.0, 80.0) for number in range(8)]
    steps += [stepping(8, 0.0, 33.0, mode=TRANS, compensated=True), stepping(9, 0.0, 33.0, mode=TRANS)]
    steps += [stepping(number, 10.0, -60.0, mode=SWING) for number in range(10, 14)]
    found = run(PrincipalAxis(PARAMETERS), steps)
    assert [step.event for step in found] == [step.event for step in steps]
    assert [error_deg(step.heading_rad, 10.0) < 1e-6 for step in found] == [True] * 8 + [False] * 2 + [True] * 4


def test_a_simulated_held_phone() -> None:
    """The true directions of the legs of the walk are 0 and 90 degrees in the frame of the recorded attitude."""
    walk = corner_walk()
    config = Config(attitude=AttitudeParams(source="device"), heading=HeadingParams(method="principal-axis"))
    steps = run(chains.stepping(config), levels_of(walk, config))
    middle_s = np.array([0.5 * (step.start_s + step.event.time_s) for step in steps])
    error = wrap_angle(np.array([step.heading_rad for step in steps]) - walk.heading_at(middle_s))
    assert np.rad2deg(np.median(np.abs(error))) < 6.0
    assert np.rad2deg(np.max(np.abs(error))) < 40.0  # the average over a stride cuts the corner


def test_the_sigma_of_the_axis_falls_with_the_number_of_strides() -> None:
    """One along and 0.2 across, to either side by turns: 0.2 rad for a stride, half of that for four."""
    strides = [
        StrideMotion(np.array([1.0, 0.2 * (-1) ** k], dtype=np.complex128), vertical_mps2=-1j, yaw_rad=0.0)
        for k in range(4)
    ]
    found = walking_direction(strides, PrincipalAxisParams(strides=4, sigma_rad=0.0))
    assert found.trusted
    assert found.offset_rad == pytest.approx(0.0, abs=1e-12)
    assert found.sigma_rad == pytest.approx(0.1)
    assert found.coherence == pytest.approx(1.0 / np.sqrt(1.04))
