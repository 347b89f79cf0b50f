"""Every heading method by its name, on a simulated walk and on steps of a device without gyroscope."""

from dataclasses import replace
from functools import cache
from typing import get_args

import numpy as np
import pytest
from signals import RATE_HZ, corner_walk, levels_of, run

from pdr_est.config import Config
from pdr_est.frames import wrap_angle
from pdr_est.front_end.attitude import AccelerometerTilt, AttitudeParams
from pdr_est.front_end.heading import HEADINGS, HeadingName, HeadingParams, HeadingUse, heading_stage
from pdr_est.pipeline.front_end_chain import stepping
from pdr_est.types.sensors import ImuBlock
from pdr_est.types.steps import Step

WITHOUT_FIELD = [method for method in HEADINGS if method != "magnetometer"]  # which has tests of its own


@cache
def plain_steps() -> tuple[Step, ...]:
    """Steps of a held phone, without heading."""
    return tuple(replace(s, heading_rad=np.nan) for s in run(stepping(Config()), levels_of(corner_walk())))


@pytest.mark.parametrize("use", get_args(HeadingUse))
@pytest.mark.parametrize("method", WITHOUT_FIELD)
def test_every_step_gets_a_heading_and_keeps_the_rest(method: HeadingName, use: HeadingUse) -> None:
    found = run(heading_stage(RATE_HZ, HeadingParams(method=method, use=use)), plain_steps())
    assert [step.event for step in found] == [step.event for step in plain_steps()]
    assert all(-np.pi <= step.heading_rad <= np.pi for step in found)
    assert [step.length_m for step in found] == [step.length_m for step in plain_steps()]
    straight = [np.isfinite(step.path_heading_rad) for step in found]
    assert any(straight) is (method in ("hde", "psp") and use == "priors")


@pytest.mark.parametrize("method", ["step-yaw", "mmpdr", "principal-axis"])
def test_the_corner_is_a_right_angle(method: HeadingName) -> None:
    """The methods that follow the yaw of a held phone; 27 m with the corner behind 15 m."""
    found = run(heading_stage(RATE_HZ, HeadingParams(method=method)), plain_steps())
    heading = np.unwrap([step.heading_rad for step in found])
    change = np.median(heading[-8:]) - np.median(heading[4:12])
    assert np.rad2deg(wrap_angle(change)) == pytest.approx(90.0, abs=6.0)


@pytest.mark.parametrize("method", WITHOUT_FIELD)
def test_without_gyroscope_there_is_no_heading_and_no_complaint(method: HeadingName) -> None:
    def bare(step: Step) -> Step:
        samples = step.samples
        force = samples.acceleration_mps2 + 9.80665 * samples.up
        imu = ImuBlock(samples.first_index, samples.segment, samples.time_s, force, None)
        (level,) = AccelerometerTilt(RATE_HZ, AttitudeParams()).push(imu)
        return replace(step, samples=level)

    found = run(heading_stage(RATE_HZ, HeadingParams(method=method)), [bare(step) for step in plain_steps()])
    assert len(found) == len(plain_steps())
    assert np.isnan([step.heading_rad for step in found]).all()
