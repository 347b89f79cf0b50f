"""Robust DR's heading: filters and integral of pulses by hand, and what is forgotten."""

from dataclasses import replace

import numpy as np
import pytest
from heading_steps import SAMPLES, block, walked
from signals import RATE_HZ, run

from pdr_est.frames import Array, wrap_angle
from pdr_est.front_end.heading.acceleration_integration import AccelerationIntegration, AccelerationIntegrationParams
from pdr_est.front_end.signal.blocks import part
from pdr_est.types.sensors import LevelBlock
from pdr_est.types.steps import Step

STILL = np.zeros((SAMPLES, 3))
REST = ("rotation_rate_radps", "turn_rate_radps", "mode", "mode_probability")


def accelerated(number: int, force_mps2: Array, yaw_rad: float | Array = 0.0, segment: int = 0) -> LevelBlock:
    return replace(block(number, yaw_rad, segment), acceleration_mps2=force_mps2)


def pulse(east_mps2: float, north_mps2: float) -> Array:
    """Acceleration (25, 3) in device axes for a tenth of a second, so early that both averages end in the step."""
    force = np.zeros((SAMPLES, 3))
    force[1:6] = (east_mps2, north_mps2, 3.0)
    return force


def headings(*steps: LevelBlock, parameters: AccelerationIntegrationParams | None = None) -> list[float]:
    found: list[Step] = run(
        AccelerationIntegration(RATE_HZ, parameters or AccelerationIntegrationParams()), walked(steps)
    )
    return [step.heading_rad for step in found]


@pytest.mark.parametrize("direction_deg", [0.0, 37.0, 90.0, 180.0, -120.0])
@pytest.mark.parametrize("yaw_deg", [0.0, 100.0, -179.0])
def test_the_heading_is_the_direction_of_a_pulse(direction_deg: float, yaw_deg: float) -> None:
    direction, yaw = np.deg2rad([direction_deg, yaw_deg])
    found = headings(accelerated(0, STILL, yaw), accelerated(1, pulse(np.cos(direction), np.sin(direction)), yaw))
    assert float(wrap_angle(found[1] - direction - yaw)) == pytest.approx(0.0, abs=1e-9)


def test_it_integrates_and_does_not_take_the_latest() -> None:
    """2 m/s^2 to the east, then 1 m/s^2 to the north: atan2(1, 2)."""
    found = headings(accelerated(0, STILL), accelerated(1, pulse(2.0, 0.0)), accelerated(2, pulse(0.0, 1.0)))
    assert found[2] == pytest.approx(np.arctan2(1.0, 2.0))


def test_what_lies_further_back_than_the_window_is_forgotten() -> None:
    """The pulse to the east is over, with filters and all, 1.5 s before the end of the last step."""
    forces = [STILL, pulse(2.0, 0.0), pulse(0.0, 1.0), STILL, STILL]
    found = headings(*(accelerated(number, force) for number, force in enumerate(forces)))
    assert found[2] == pytest.approx(np.arctan2(1.0, 2.0))
    assert found[4] == pytest.approx(np.pi / 2.0)


def test_the_projection_takes_the_latest_attitude() -> None:
    """The first average is over device axes: of a turning phone it mixes what the second then turns."""
    only_before = AccelerationIntegrationParams(post_window_s=0.02)
    yaw = np.zeros(SAMPLES)
    yaw[16:] = np.pi / 2.0
    force = np.zeros((SAMPLES, 3))
    force[15] = (1.0, 0.0, 0.0)  # one sample before the turn, of which nine tenths of the average come behind it
    found = headings(accelerated(0, STILL), accelerated(1, force, yaw), parameters=only_before)
    assert found[1] == pytest.approx(
        np.arctan2(9.0 - 0.5, 1.0)
    )  # the last sample counts half by the trapezoidal rule


@pytest.mark.parametrize("segment", [0, 1])
def test_a_standstill_and_a_gap_begin_anew(segment: int) -> None:
    first = [accelerated(0, STILL), accelerated(1, pulse(2.0, 0.0))]
    number = 2 if segment else 3
    found = headings(
        *first, accelerated(number, STILL, segment=segment), accelerated(number + 1, pulse(0.0, 1.0), segment=segment)
    )
    assert found[3] == pytest.approx(np.pi / 2.0)


def test_a_sample_of_two_steps_counts_once() -> None:
    first, second = accelerated(0, STILL), accelerated(1, pulse(2.0, 1.0))
    overlapping = accelerated(2, pulse(-1.0, 3.0))
    doubled = replace(
        overlapping,
        **{
            name: np.concatenate([getattr(second, name)[-1:], getattr(overlapping, name)])
            for name in ("time_s", "up", "acceleration_mps2", "vertical_mps2", "yaw_rad", *REST)
        },
        first_index=overlapping.first_index - 1,
    )
    assert headings(first, second, doubled) == headings(first, second, overlapping)


UNFILTERED = AccelerationIntegrationParams(pre_window_s=0.02, post_window_s=0.02, integration_s=0.04)


def test_the_trapezoidal_rule_takes_both_ends_of_the_window() -> None:
    """Of three samples 0.02 s apart the middle one counts once and the others half."""
    force = np.zeros((SAMPLES, 3))
    force[-4:] = [(-100.0, 0.0, 0.0), (0.0, 2.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 0.0)]
    (found,) = headings(accelerated(0, force), parameters=UNFILTERED)
    assert np.rad2deg(found) == pytest.approx(45.0)


def test_a_single_missing_sample_restarts_the_integral() -> None:
    east, north = np.zeros((SAMPLES, 3)), np.zeros((SAMPLES, 3))
    east[:, 0], north[:, 1] = 1.0, 1.0
    whole, late = accelerated(0, east), accelerated(1, north)
    assert headings(whole, late)[1] < np.pi / 2.0 - 0.1
    assert headings(part(whole, 0, SAMPLES - 1), late)[1] == pytest.approx(np.pi / 2.0)
