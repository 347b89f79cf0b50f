"""Sideways and backward walking: made-up accelerations along the way of a walker whose phone turns or does not."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from heading_steps import SAMPLES, block, step_of

from pdr_est import pipeline
from pdr_est.config import Config
from pdr_est.frames import Array, wrap_angle
from pdr_est.front_end.heading import HeadingParams, whole_walk_stage
from pdr_est.front_end.heading.course.course_offsets import with_courses
from pdr_est.front_end.heading.course.course_params import CourseParams
from pdr_est.front_end.heading.course.leading_acceleration import leading_acceleration
from pdr_est.front_end.heading.whole_walk.dominant_directions import DominantParams
from pdr_est.simulate import BodyParams, BodyTurn, PathParams, Scenario, simulate_walk
from pdr_est.types.analysis import SmoothedWalk
from pdr_est.types.measurements import StepOdometry
from pdr_est.types.steps import CarryingMode, Step

PARAMETERS = CourseParams()
AHEAD_RAD = 0.4  # direction of a walker who moves ahead, against the phone
PHASE_RAD = 2.0 * np.pi * (np.arange(SAMPLES) + 0.5) / SAMPLES


def walk_of(
    course_deg: Sequence[float],
    phone_deg: Sequence[float],
    noise_mps2: float = 0.06,
    mode: CarryingMode = CarryingMode.HOLDING,
) -> list[Step]:
    """Steps of a phone that lies flat, whose headings are the yaw of the phone."""
    rng = np.random.default_rng(5)
    steps = []
    for number, (course, phone) in enumerate(zip(np.deg2rad(course_deg), np.deg2rad(phone_deg), strict=True)):
        across = np.cos(PHASE_RAD + 0.5 * np.pi)  # a quarter of a step ahead of the vertical
        error = noise_mps2 * rng.standard_normal(2)
        angle = course + AHEAD_RAD - phone
        horizontal = np.array([0.6 * np.cos(angle), 0.6 * np.sin(angle)]) + error
        acceleration = np.zeros((SAMPLES, 3))
        acceleration[:, :2] = across[:, None] * horizontal
        samples = replace(
            block(number, float(phone)), acceleration_mps2=acceleration, vertical_mps2=2.0 * np.cos(PHASE_RAD)
        )
        steps.append(replace(step_of(samples, mode), heading_rad=float(wrap_angle(phone))))
    return steps


def stretch(angle_deg: float, count: int = 10) -> list[float]:
    """A turn that is undone after some steps, on a walk of 80 steps."""
    half, out = 0.5 * angle_deg, [angle_deg] * count
    return [0.0] * 30 + [half, *out, half] + [0.0] * (48 - count)


def headings_deg(steps: Sequence[Step]) -> Array:
    return np.rad2deg(wrap_angle(np.array([step.heading_rad for step in steps])))


def test_the_leading_acceleration_points_where_the_walker_moves() -> None:
    steps = walk_of([0.0, 90.0, 10.0], [0.0, 60.0, -30.0], noise_mps2=0.0)
    expected = 0.3 * np.exp(1j * (np.deg2rad([0.0, 90.0, 10.0]) + AHEAD_RAD))
    np.testing.assert_allclose(leading_acceleration(steps), expected, atol=1e-12)


@pytest.mark.parametrize("angle_deg", [45.0, 90.0, -90.0, 135.0, 180.0])
def test_a_walker_who_turns_the_body_alone_goes_straight_on(angle_deg: float) -> None:
    steps = walk_of(np.zeros(80).tolist(), stretch(angle_deg))
    found = with_courses(steps, PARAMETERS)
    assert np.abs(headings_deg(found)[32:40]).max() < 8.0
    offset = np.array([step.course_offset_rad for step in found])
    np.testing.assert_allclose(wrap_angle(offset[32:40] + np.deg2rad(angle_deg)), 0.0, atol=0.15)
    assert [step.heading_rad for step in found[:20]] == [step.heading_rad for step in steps[:20]]
    np.testing.assert_allclose(headings_deg(found)[46:], 0.0, atol=1.5)  # the headings afterwards are not turned


@pytest.mark.parametrize("angle_deg", [45.0, 90.0, 180.0])
def test_a_walker_who_turns_with_the_phone_keeps_every_heading(angle_deg: float) -> None:
    steps = walk_of(stretch(angle_deg), stretch(angle_deg))
    assert with_courses(steps, PARAMETERS) == steps


def test_noise_alone_turns_nothing() -> None:
    steps = walk_of(stretch(90.0), stretch(90.0), noise_mps2=0.6)
    assert with_courses(steps, PARAMETERS) == steps


def test_what_is_undecided_is_told_as_doubt() -> None:
    found = with_courses(walk_of(np.zeros(80).tolist(), stretch(120.0, 3), noise_mps2=0.25), PARAMETERS)
    sigma = np.array([step.sigma_course_rad for step in found])
    assert sigma[31:34].min() > 0.3
    assert sigma[:15].max() < 0.1


def test_a_phone_in_a_swinging_hand_tells_nothing() -> None:
    steps = walk_of(np.zeros(80).tolist(), stretch(90.0), mode=CarryingMode.SWING)
    assert with_courses(steps, PARAMETERS) == steps


def test_steps_after_the_phone_was_put_elsewhere_have_a_zero_of_their_own() -> None:
    steps = walk_of(np.zeros(80).tolist(), stretch(90.0))
    elsewhere = walk_of((np.zeros(80) + 70.0).tolist(), np.zeros(80).tolist())
    moved = [replace(step, event=replace(step.event, segment=1)) for step in elsewhere]
    found = with_courses([*steps, *moved], PARAMETERS)
    assert np.abs(headings_deg(found)[32:40]).max() < 8.0
    assert found[80:] == moved


def test_the_stage_has_a_switch() -> None:
    only = HeadingParams(dominant=DominantParams(enabled=False))
    stage = whole_walk_stage(only)
    assert stage is not None
    for step in walk_of(np.zeros(80).tolist(), stretch(90.0)):
        stage.push(step)
    assert np.abs(headings_deg(stage.flush())[32:40]).max() < 8.0
    off = replace(only, course=CourseParams(enabled=False), auto=replace(only.auto, whole_walk=False))
    assert whole_walk_stage(off) is None


def walked(angle_deg: float, enabled: bool) -> tuple[float, SmoothedWalk]:
    """Root mean square error (m) of a straight walk of 40 m, best shift and rotation removed, and the walk."""
    turn = BodyTurn(start_s=14.0, end_s=20.0, angle_rad=np.deg2rad(angle_deg))
    body = BodyParams(turns=(turn,))
    walk = simulate_walk(Scenario(path=PathParams(vertices_m=((0.0, 0.0), (40.0, 0.0))), body=body, seed=3))
    config = replace(Config(), heading=HeadingParams(course=CourseParams(enabled=enabled)))
    found = pipeline.smooth_recording(walk.recording, config)
    place = found.track.position_m @ np.array([1.0, 1.0j])
    true = walk.position_at(found.track.time_s) @ np.array([1.0, 1.0j])
    place, true = place - place.mean(), true - true.mean()
    turned = np.sum(true * place.conj())
    return float(np.sqrt(np.mean(np.abs(place * turned / abs(turned) - true) ** 2))), found


@pytest.mark.parametrize("angle_deg", [60.0, -90.0, 180.0])
def test_a_simulated_walker_who_goes_on_sideways_or_backwards_is_followed(angle_deg: float) -> None:
    of_lengths_m, _ = walked(0.0, enabled=True)
    without_m, _ = walked(angle_deg, enabled=False)
    with_m, found = walked(angle_deg, enabled=True)
    assert without_m > of_lengths_m + 1.0
    assert with_m < of_lengths_m + 0.4 * (without_m - of_lengths_m)
    causal, whole = (
        sum(one.heading_change_rad for one in odometry if isinstance(one, StepOdometry))
        for odometry in (found.devices[0].odometry, found.devices[0].whole_walk_odometry)
    )
    assert wrap_angle(causal - whole) == pytest.approx(0.0, abs=0.06)


@pytest.mark.parametrize("name", ["dead-reckoning", "factor-graph"])
def test_half_a_minute_of_sideways_walking_is_followed_online_and_at_the_end(name: str) -> None:
    body = BodyParams(turns=(BodyTurn(start_s=14.0, end_s=44.0, angle_rad=-0.5 * np.pi),))
    walk = simulate_walk(Scenario(path=PathParams(vertices_m=((0.0, 0.0), (75.0, 0.0))), body=body, seed=3))
    config = replace(Config(), estimator=replace(Config().estimator, name=name))
    track = pipeline.smooth_recording(walk.recording, config).track
    place = track.position_m - track.position_m[0]
    true = walk.position_at(track.time_s)
    before = np.searchsorted(track.time_s, 13.0)
    error_rad = np.arctan2(*(true[before] - true[0])[::-1]) - np.arctan2(*place[before][::-1])
    turn = np.array([[np.cos(error_rad), -np.sin(error_rad)], [np.sin(error_rad), np.cos(error_rad)]])
    assert np.linalg.norm(place @ turn.T + true[0] - true, axis=1).max() < 10.0  # 55 m by the headings of the phone
