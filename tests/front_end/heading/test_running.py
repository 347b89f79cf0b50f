"""Runners, whose leading acceleration points backwards: they are told, and no track is turned by them."""

from collections.abc import Sequence
from dataclasses import replace
from math import log

import numpy as np
import pytest
from test_course_offsets import stretch, walk_of
from test_online_course import online

from pdr_est import pipeline
from pdr_est.config import Config, StartParams
from pdr_est.frames import wrap_angle
from pdr_est.front_end.heading.course.course_offsets import with_courses
from pdr_est.front_end.heading.course.course_params import CourseParams
from pdr_est.front_end.heading.course.running import RunningBelief, StepPace, pace_of, running_probabilities
from pdr_est.front_end.heading.step_motion import motion_of
from pdr_est.simulate import SimulatedWalk, simulate_walk, uptime_trip
from pdr_est.types.steps import CarryingMode, Step

CORRELATED_STEPS = CourseParams().correlated_steps
WALK, QUICK, JOG = (
    StepPace(log(bounce), log(cadence), True) for bounce, cadence in ((2.5, 1.8), (4.0, 2.1), (8.5, 2.6))
)


def made_to_run(steps: Sequence[Step], first: int, last: int, bounce: float = 6.0) -> list[Step]:
    """Steps of which some bounce more often and so many times as much, with the acceleration to the other side."""
    done = list(steps)
    for k in range(first, last):
        samples = steps[k].samples
        shaken = replace(
            samples,
            vertical_mps2=bounce * samples.vertical_mps2,
            acceleration_mps2=-1.5 * samples.acceleration_mps2,
        )
        done[k] = replace(steps[k], samples=shaken, frequency_hz=2.7, motion=None)
    return done


def jogging_steps() -> list[Step]:
    """A walk that turns by 90 degrees before and in the middle of a stretch of jogging, and back."""
    phone = [0.0] * 20 + [45.0] + [90.0] * 19 + [135.0] + [180.0] * 19 + [135.0] + [90.0] * 19
    return made_to_run(walk_of(phone, phone), 30, 55)


def test_jogging_is_told_from_walking_by_all_steps_at_the_end() -> None:
    running = running_probabilities([*[WALK] * 20, *[JOG] * 20, *[QUICK] * 20], CORRELATED_STEPS)
    assert running[:18].max() < 0.01
    assert running[24:36].min() > 0.99
    assert running[42:].max() < 0.01


def test_hurried_walking_is_no_running() -> None:
    slow = StepPace(log(2.0), log(1.7), True)
    assert running_probabilities([*[slow] * 20, *[QUICK] * 20, *[slow] * 20], CORRELATED_STEPS).max() < 0.1


def test_a_slow_jog_is_told_over_what_is_usual_of_the_walker() -> None:
    shuffle = StepPace(log(4.6), log(2.4), True)
    alone = running_probabilities([shuffle] * 20, CORRELATED_STEPS)
    beside = running_probabilities([*[StepPace(log(1.2), log(1.6), True)] * 40, *[shuffle] * 20], CORRELATED_STEPS)
    assert beside[45:].min() > 0.9 > alone.max()


def test_the_belief_goes_on_over_steps_that_tell_nothing() -> None:
    belief = RunningBelief([WALK] * 20, CORRELATED_STEPS)
    for _ in range(20):
        at_last = belief.push(JOG)
    afterwards = [belief.push(StepPace(0.0, 0.0, False)) for _ in range(5)]
    assert afterwards == sorted(afterwards, reverse=True)
    assert at_last > afterwards[-1] > 0.9


def test_bounce_and_cadence_of_a_step_are_its_own() -> None:
    step = walk_of([0.0], [0.0])[0]
    pace = pace_of(replace(step, frequency_hz=2.0), motion_of(step))
    assert pace == pytest.approx((log(2.0 / np.sqrt(2.0)), log(2.0), True))
    assert not pace_of(replace(step, frequency_hz=0.0), motion_of(step)).known


def test_a_jog_around_corners_turns_no_heading() -> None:
    steps = jogging_steps()
    assert with_courses(steps, CourseParams()) == steps
    assert [step.heading_rad for step in online(steps)] == [step.heading_rad for step in steps]


def test_the_same_acceleration_without_the_bounce_of_a_runner_does() -> None:
    sideways = [0.0] * 30 + [90.0, 180.0] + [180.0] * 16 + [90.0] + [0.0] * 31
    steps = walk_of(np.zeros(80).tolist(), sideways)
    assert max(abs(step.course_offset_rad) for step in with_courses(steps, CourseParams())) > 2.0


def test_a_walker_who_jogged_before_is_followed_sideways() -> None:
    walk = walk_of(np.zeros(80).tolist(), stretch(90.0))
    found = with_courses(made_to_run(walk, 0, 12), CourseParams())
    heading_rad = np.array([step.heading_rad for step in found])
    assert np.rad2deg(np.abs(wrap_angle(heading_rad))).max() < 50.0
    assert np.rad2deg(np.abs(wrap_angle(heading_rad[32:40]))).max() < 8.0


def heading_errors_over_sigma(walk: SimulatedWalk, estimator: str) -> np.ndarray:
    """Heading errors of the track from the known start over their standard deviations, median over nine steps."""
    x_m, y_m = walk.truth_position_m[0].tolist()
    heading_rad = float(wrap_angle(walk.truth_heading_rad[0]))
    start = StartParams(x_m=x_m, y_m=y_m, heading_rad=heading_rad, sigma_heading_rad=0.0)
    config = replace(Config(), start=start, estimator=replace(Config().estimator, name=estimator))
    found = pipeline.smooth_recording(walk.recording, config)
    middle_s = np.array([0.5 * (step.start_s + step.event.time_s) for step in found.devices[0].steps])
    error_rad = wrap_angle(found.track.heading_rad[1:] - walk.heading_at(middle_s))
    windows = np.lib.stride_tricks.sliding_window_view(np.unwrap(error_rad), 9)
    median_rad = wrap_angle(np.median(windows, axis=1))
    assert np.rad2deg(np.abs(median_rad)).max() < 30.0
    return np.asarray(median_rad / np.maximum(found.track.sigma_heading_rad[5:-4], 0.02))


@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, 1, 2, 3])
@pytest.mark.parametrize("mode", [CarryingMode.HOLDING, CarryingMode.POCKET])
def test_a_simulated_trip_with_jogging_and_corners_keeps_its_headings(mode: CarryingMode, seed: int) -> None:
    ratio = heading_errors_over_sigma(simulate_walk(uptime_trip("compound", seed, mode)), "factor-graph")
    assert np.sqrt(np.mean(ratio**2)) < 2.5


@pytest.mark.parametrize("estimator", ["factor-graph", "ekf"])
def test_a_corner_while_jogging_turns_no_track(estimator: str) -> None:
    trip = uptime_trip("compound", 0)
    path = replace(trip.path, vertices_m=((0.0, 0.0), (40.0, 0.0), (40.0, 40.0), (0.0, 40.0)))
    jog = replace(trip.gait.stretches[0], from_m=30.0, to_m=60.0)
    walk = simulate_walk(replace(trip, path=path, gait=replace(trip.gait, stretches=(jog,))))
    assert np.sqrt(np.mean(heading_errors_over_sigma(walk, estimator) ** 2)) < 2.0
