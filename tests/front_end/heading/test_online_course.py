"""Sideways and backward walking at the step: offsets where they are likely, doubt where they may be."""

from collections.abc import Sequence

import numpy as np
import pytest
from test_course_offsets import stretch, walk_of

from pdr_est.config import Config
from pdr_est.frames import Array, wrap_angle
from pdr_est.front_end.heading.course.course_offsets import moves_ahead, without_courses
from pdr_est.front_end.heading.course.course_params import CourseParams
from pdr_est.front_end.heading.course.online_course import OnlineCourse
from pdr_est.online.saved_state import pack, unpack
from pdr_est.pipeline import analyse_recording
from pdr_est.simulate import robust_dr_trials, simulate_walk
from pdr_est.types.steps import Step


def online(steps: Sequence[Step]) -> list[Step]:
    stage = OnlineCourse(CourseParams())
    return [found for step in steps for found in stage.push(step)] + stage.flush()


def offset_deg(steps: Sequence[Step]) -> Array:
    return np.rad2deg(np.array([step.course_offset_rad for step in steps]))


def doubt_deg(steps: Sequence[Step]) -> Array:
    return np.rad2deg(np.array([step.sigma_course_rad for step in steps]))


@pytest.mark.parametrize("angle_deg", [90.0, -90.0, 180.0])
@pytest.mark.parametrize("count", [12, 40])
def test_a_walker_who_turns_the_body_alone_is_followed_after_some_steps(angle_deg: float, count: int) -> None:
    found = online(walk_of(np.zeros(80).tolist(), stretch(angle_deg, count)))
    np.testing.assert_allclose(wrap_angle(np.deg2rad(offset_deg(found)[38 : 30 + count] + angle_deg)), 0.0, atol=0.15)
    heading = np.array([step.heading_rad for step in found])
    assert np.rad2deg(np.abs(heading[38 : 30 + count])).max() < 9.0
    assert doubt_deg(found)[31:34].max() > 10.0
    assert np.abs(offset_deg(found)[-4:]).max() < 1.0


@pytest.mark.parametrize("angle_deg", [45.0, 90.0, 180.0])
def test_a_walker_who_turns_with_the_phone_raises_hardly_any_doubt(angle_deg: float) -> None:
    found = online(walk_of(stretch(angle_deg), stretch(angle_deg)))
    assert np.abs(offset_deg(found)).max() == 0.0
    assert doubt_deg(found).max() < 20.0
    assert (doubt_deg(found) > 0.0).sum() < 12


def test_what_is_undecided_is_told_as_doubt_about_the_heading_of_the_phone() -> None:
    steps = walk_of(np.zeros(80).tolist(), stretch(120.0, 3), noise_mps2=0.25)
    found = online(steps)
    assert doubt_deg(found)[31:35].max() > 15.0
    assert doubt_deg(found)[:30].max() == 0.0


def test_headings_of_the_phone_are_found_again() -> None:
    steps = walk_of(np.zeros(80).tolist(), stretch(90.0, 40))
    found = online(steps)
    assert not moves_ahead(found)[45:60].any()
    again = without_courses(found)
    np.testing.assert_allclose([s.heading_rad for s in again], [s.heading_rad for s in steps], atol=1e-12)
    assert (offset_deg(again) == 0.0).all()
    assert (doubt_deg(again) == 0.0).all()


def test_a_stage_that_was_saved_goes_on_as_before() -> None:
    steps = walk_of(np.zeros(80).tolist(), stretch(90.0, 40))
    stage, found = OnlineCourse(CourseParams()), []
    for step in steps:
        stage = unpack(pack(stage), OnlineCourse)
        found += stage.push(step)
    assert [step.heading_rad for step in found] == [step.heading_rad for step in online(steps)]


def test_what_a_dozen_steps_show_by_chance_is_not_believed_for_the_rest_of_the_walk() -> None:
    """In a pocket of a slow walker the acceleration of a step hardly shows the direction: by 1 standard deviation."""
    (left, _) = analyse_recording(simulate_walk(robust_dr_trials(0)[0]).recording, Config())
    assert np.count_nonzero(offset_deg(left.steps)) == 0
    assert np.median(doubt_deg(left.steps)) == 0.0
