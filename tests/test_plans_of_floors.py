"""A walk over three storeys with a plan of each: that of the floor by the air pressure counts, between none."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from storeys import BUILDING, FIRST, GROUND, SECOND, TURNED, error_m, over_three_storeys

import pdr_est
from pdr_est import pipeline
from pdr_est.errors import FloorPlanError
from pdr_est.pipeline import SmoothedWalk
from pdr_est.types.findings import FindingKind
from pdr_est.types.floor_plan import BuildingPlan, FloorPlan

PARTICLE = TURNED.with_estimator("particle")
SWAPPED = replace(BUILDING, plans=(GROUND, SECOND, FIRST))


@cache
def smoothed(start: int | None = 0, known: bool = True, barometer: bool = True, seed: int = 3) -> SmoothedWalk:
    plan = replace(BUILDING, start=start) if known else None
    return pipeline.smooth_recording(over_three_storeys(barometer, seed).recording, PARTICLE, plan=plan)


def floors_of(walk: SmoothedWalk) -> list[str | None]:
    """Floors in order of time; None where no plan counts."""
    return [None if one.plan is None else one.plan.floor for one in walk.floors]


def mean_error_m(walk: SmoothedWalk, barometer: bool = True, seed: int = 3) -> float:
    return float(error_m(walk.track, over_three_storeys(barometer, seed)).mean())


@pytest.mark.parametrize(
    "seed", [3, pytest.param(4, marks=pytest.mark.slow), pytest.param(5, marks=pytest.mark.slow)]
)
def test_the_plans_of_the_floors_take_the_error_of_the_start_direction_away(seed: int) -> None:
    walk = smoothed(seed=seed)
    assert floors_of(walk) == ["0", None, "1", None, "2", None, "1"]
    assert mean_error_m(walk, seed=seed) < 0.2 * mean_error_m(smoothed(known=False, seed=seed), seed=seed)
    assert walk.warnings == ()
    for one, following in zip(walk.floors, [*walk.floors[1:], None], strict=True):
        if one.plan is not None:
            end_s = np.inf if following is None else following.time_s
            on_it = (walk.track.time_s >= one.time_s) & (walk.track.time_s < end_s)
            assert one.plan.contains(walk.track.position_m[on_it]).mean() > 0.98


def test_the_floors_of_other_plans_do_not_fit() -> None:
    recording = over_three_storeys().recording
    track = pdr_est.smooth(recording, PARTICLE, plan=SWAPPED)
    assert [one.kind for one in track.findings if one.doubtful] == [FindingKind.PLAN]
    assert "the plans '0', '2', '1' do not fit this walk" in track.findings[0].message


def test_the_only_start_from_which_all_visited_floors_have_a_plan_is_found_and_said() -> None:
    walk = smoothed(start=None)
    assert walk.floors == smoothed().floors
    assert "begins on floor 0: only then all visited floors have a plan" in walk.warnings[0]
    two = BuildingPlan("two", (GROUND, FIRST), (0, 1))
    with pytest.raises(FloorPlanError, match=r"two: shows the floors 0, 1.*say on which of them \(--floor NAME\)"):
        pipeline.smooth_recording(over_three_storeys().recording, PARTICLE, plan=two)


def test_a_floor_without_plan_is_said_and_leaves_the_track_free() -> None:
    two = BuildingPlan("two", (GROUND, FIRST), (0, 1), start=0)
    walk = pipeline.smooth_recording(over_three_storeys().recording, PARTICLE, plan=two)
    assert walk.warnings == ("no plan of floor 2, where the walker was: the track is free there",)
    assert floors_of(walk) == ["0", None, "1", None, "1"]
    assert mean_error_m(walk) < 0.4 * mean_error_m(smoothed(known=False))


def test_without_barometer_the_whole_walk_is_on_the_floor_of_the_start_and_that_is_said() -> None:
    hall = FloorPlan("hall", BUILDING.all_floors.areas, np.zeros((0, 2, 2)), 0.2, "hall")
    plan = BuildingPlan("site", (hall, SECOND), (1, 2), start=1)
    walk = pipeline.smooth_recording(over_three_storeys(False).recording, PARTICLE, plan=plan)
    assert walk.warnings[0] == "no air pressure was recorded, so that the whole walk counts as one on floor hall"
    assert walk.plan is hall
    assert [one.plan for one in walk.floors] == [hall]


def test_the_plan_with_most_steps_is_that_of_the_walk() -> None:
    assert smoothed().plan is FIRST


def test_estimators_that_know_no_plans_take_the_directions_of_all_walls() -> None:
    recording = over_three_storeys().recording
    track, free = (
        pdr_est.smooth(recording, TURNED.with_estimator("factor-graph"), plan=plan) for plan in (BUILDING, None)
    )
    assert error_m(track, over_three_storeys()).mean() < 0.5 * error_m(free, over_three_storeys()).mean()


def test_floors_may_be_given_to_any_odometry() -> None:
    (walk,) = smoothed().devices
    track = pdr_est.estimate(
        walk.whole_walk_odometry, estimator="particle", start=TURNED.start.pose(), plan=smoothed().floors
    )
    assert error_m(track, over_three_storeys()).mean() < 0.2 * mean_error_m(smoothed(known=False))
