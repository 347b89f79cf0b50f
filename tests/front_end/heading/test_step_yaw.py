"""Table IV of MMPDR: the mean yaw of a step wherever the angles are cut."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from signals import step

from pdr_est.frames import Array, wrap_angle
from pdr_est.front_end.heading.step_yaw import StepYaw, calibrated_mean_yaw


def table_iv(yaw_rad: Array) -> float:
    """The pseudocode as published: negative angles go up by a turn before the mean is taken."""
    mean = float(np.mean([angle + 2.0 * np.pi if angle < 0.0 else angle for angle in yaw_rad]))
    return mean - 2.0 * np.pi if mean > np.pi else mean


@pytest.mark.parametrize(
    ("yaw_deg", "mean_deg"),
    [
        ([10.0, 20.0, 60.0], 30.0),
        ([-10.0, -20.0, -60.0], -30.0),
        ([-10.0, 10.0, 6.0], 2.0),  # along yaw 0, where the table as published gives 122
        ([170.0, -170.0, -174.0], -178.0),  # along 180, which is what the table is for
        ([178.0, 174.0, -178.0], 178.0),
        ([-179.0, 179.0], 180.0),
        ([90.0], 90.0),
    ],
)
def test_means_by_hand(yaw_deg: list[float], mean_deg: float) -> None:
    assert np.rad2deg(calibrated_mean_yaw(np.deg2rad(yaw_deg))) == pytest.approx(mean_deg)


@pytest.mark.parametrize("yaw_deg", [[170.0, -170.0, -174.0], [5.0, 80.0, 30.0], [-100.0, -60.0], [179.0, -150.0]])
def test_it_is_the_published_table_wherever_that_is_right(yaw_deg: list[float]) -> None:
    assert calibrated_mean_yaw(np.deg2rad(yaw_deg)) == pytest.approx(table_iv(np.deg2rad(yaw_deg)), abs=1e-12)


@given(st.floats(-np.pi, np.pi), st.lists(st.floats(-1.5, 1.5), min_size=1, max_size=40))
def test_the_mean_turns_with_the_walker(direction: float, swing: list[float]) -> None:
    """Whatever the direction, the mean is the direction plus the mean of the swinging about it."""
    found = calibrated_mean_yaw(wrap_angle(direction + np.array(swing)))
    assert float(wrap_angle(found - direction - np.mean(swing))) == pytest.approx(0.0, abs=1e-9)
    assert -np.pi <= found <= np.pi


def test_the_stage_averages_over_the_samples_of_the_step() -> None:
    plain = step(1.0, 0.4)
    yaw = np.deg2rad(np.resize([170.0, -178.0], 30))
    turned = replace(plain, samples=replace(plain.samples, yaw_rad=yaw), heading_rad=float("nan"))
    (found,) = StepYaw().push(turned)
    assert np.rad2deg(found.heading_rad) == pytest.approx(176.0)
    assert replace(found, heading_rad=plain.heading_rad, samples=plain.samples) == plain
