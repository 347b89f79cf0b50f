"""What the whole walk tells of its headings: directions for the estimator, or headings without their drift."""

from dataclasses import replace

import numpy as np
import pytest
from heading_walks import of_legs, park, unsteady, with_headings
from signals import run

from pdr_est.frames import Array, wrap_angle
from pdr_est.front_end.heading import HeadingParams, WholeWalkHeading, whole_walk_stage
from pdr_est.front_end.heading.course.course_params import CourseParams
from pdr_est.front_end.heading.posture_aware_yaw import AutoHeadingParams
from pdr_est.front_end.heading.whole_walk.dominant_directions import DominantParams
from pdr_est.types.sensors import Hole
from pdr_est.types.steps import Step, TurnHypothesis

PARAMETERS = DominantParams()
OFFICE = of_legs([(17.0 + 90.0 * k, 22) for k in (0, 1, 2, 1, 0, -1, 0, 1)])


def drifting(seed: int = 2) -> Array:
    """Turning by 30 degrees in all."""
    rng = np.random.default_rng(seed)
    return unsteady(OFFICE, rng, 0.003) + np.linspace(0.0, np.deg2rad(30.0), len(OFFICE))


def headings(steps: list[Step]) -> Array:
    return np.array([step.heading_rad for step in steps])


def times_s(steps: list[Step]) -> Array:
    """Since the first step."""
    return np.array([step.event.time_s - steps[0].event.time_s for step in steps])


def bare(step: Step, heading_rad: float) -> Step:
    return replace(
        step, path_heading_rad=0.0, sigma_path_heading_rad=0.0, sigma_turn_rad=0.0, heading_rad=heading_rad
    )


def test_as_priors_only_a_constant_rate_is_taken_off_and_straight_steps_get_their_direction() -> None:
    steps = with_headings(drifting())
    stage = WholeWalkHeading(PARAMETERS, as_priors=True)
    found = run(stage, steps)
    assert stage.directions is not None
    assert (stage.directions.number, stage.directions.used) == (4, True)
    assert [bare(step, 0.0) for step in found] == [bare(step, 0.0) for step in steps]
    rate = stage.directions.rate_radps
    np.testing.assert_allclose(wrap_angle(headings(steps) - headings(found)), rate * times_s(steps), atol=1e-9)
    elapsed_s = np.diff([step.event.time_s for step in steps])
    turns = np.array([step.sigma_turn_rad for step in found])
    np.testing.assert_allclose(turns[1:], stage.directions.drift_per_sqrt_s * np.sqrt(elapsed_s))
    straight = np.array([step.path_heading_rad for step in found])
    known = np.isfinite(straight)
    assert 0.8 < known.mean() < 1.0
    error = wrap_angle(straight[known] - OFFICE[known])
    inside = np.abs(wrap_angle(error - np.median(error))) < 1e-6
    assert inside.mean() > 0.95  # the last step of a leg may belong to the next piece
    sigma = np.array([step.sigma_path_heading_rad for step in found])
    assert (np.isfinite(sigma) == known).all()
    assert (sigma[known] < 0.15).all()


@pytest.mark.parametrize("probability", [0.05, 0.001])
@pytest.mark.parametrize("wrong_by_deg", [-90.0, -40.0, 10.0])
def test_priors_lie_on_one_side_of_a_turn_that_is_not_decided(probability: float, wrong_by_deg: float) -> None:
    """Also where the other turn leads between two directions; an error of 10 degrees is no other direction."""
    steps, number = with_headings(drifting()), 88
    turn_rad = float(wrap_angle(steps[number].heading_rad - steps[number - 1].heading_rad))
    turns = (
        TurnHypothesis(1.0 - probability, turn_rad, 0.03, "straight on"),
        TurnHypothesis(probability, turn_rad + np.deg2rad(wrong_by_deg), 0.03, "corner"),
    )
    steps[number] = replace(steps[number], turn_hypotheses=turns)
    found = run(WholeWalkHeading(PARAMETERS, as_priors=True), steps)
    known = np.isfinite([step.path_heading_rad for step in found])
    on_both_sides = bool(known[:number].any() and known[number:].any())
    assert on_both_sides == (probability < 0.01 or wrong_by_deg > 0.0)


def test_as_increments_the_drift_is_taken_off() -> None:
    steps = with_headings(drifting())
    found = run(WholeWalkHeading(PARAMETERS, as_priors=False), steps)
    assert np.isnan([step.path_heading_rad for step in found]).all()

    def error(steps: list[Step]) -> Array:
        off = np.unwrap(wrap_angle(headings(steps) - OFFICE))
        return np.asarray(off - off[:10].mean())

    assert np.rad2deg(np.abs(error(steps)[-10:].mean())) > 25.0
    assert np.rad2deg(np.abs(error(found)[-10:].mean())) < 8.0


@pytest.mark.parametrize("as_priors", [True, False])
def test_a_park_stays_as_it_is(as_priors: bool) -> None:
    rng = np.random.default_rng(5)
    steps = with_headings(park(rng, 300))
    assert run(WholeWalkHeading(PARAMETERS, as_priors), steps) == steps


@pytest.mark.parametrize("as_priors", [True, False])
def test_nothing_and_few_steps(as_priors: bool) -> None:
    stage = WholeWalkHeading(PARAMETERS, as_priors)
    assert run(stage, []) == []
    assert stage.directions is None
    few = with_headings([0.0, 0.1, 0.2])
    assert run(WholeWalkHeading(PARAMETERS, as_priors), few) == few


@pytest.mark.parametrize(("sigma_turn_rad", "goes_on"), [(0.1, True), (1.8, False)])
def test_directions_go_on_after_a_gap_whose_turn_is_known(sigma_turn_rad: float, goes_on: bool) -> None:
    """Of parts of a walk whose angle is not known the longest one has the priors."""
    steps = with_headings(drifting())
    half = len(steps) // 2 + 15
    gap = Hole(steps[half - 1].event.time_s, steps[half].event.time_s)
    steps[half] = replace(steps[half], holes=(gap,), sigma_turn_rad=sigma_turn_rad)
    found = run(WholeWalkHeading(PARAMETERS, as_priors=True), steps)
    known = np.isfinite([step.path_heading_rad for step in found])
    assert known[:half].mean() > 0.8
    assert (known[half:].mean() > 0.8) == goes_on
    assert known[half:].any() == goes_on


def test_only_the_default_method_has_hindsight() -> None:
    assert isinstance(whole_walk_stage(HeadingParams()), WholeWalkHeading)
    assert whole_walk_stage(HeadingParams(method="step-yaw")) is None
    off = DominantParams(enabled=False)
    turns_alone = whole_walk_stage(HeadingParams(dominant=off))
    assert isinstance(turns_alone, WholeWalkHeading)
    run(turns_alone, with_headings(drifting()))
    assert turns_alone.directions is None
    none = HeadingParams(dominant=off, auto=AutoHeadingParams(whole_walk=False), course=CourseParams(enabled=False))
    assert whole_walk_stage(none) is None
    assert whole_walk_stage(HeadingParams(auto=AutoHeadingParams(moved_rad=1.0))) is not None
