"""A floor plan on its way through the pipeline: to the estimators that use it, and by its walls into the headings."""

from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from typing import Any, ClassVar

import numpy as np
import pytest

import pdr_est
from pdr_est import pipeline
from pdr_est.config import Config, StartParams
from pdr_est.errors import FloorPlanError
from pdr_est.estimators import EstimatorSpec, estimator_named
from pdr_est.frames import Array, GeoOrigin, rotate_vectors
from pdr_est.parts import Parts
from pdr_est.pipeline.map_directions import with_plan_directions
from pdr_est.simulate import preset, simulate_walk
from pdr_est.simulate.walk import SimulatedWalk
from pdr_est.types.floor_plan import FloorPlan, PresentFloor, WalkableArea
from pdr_est.types.measurements import DeviceMeasurements
from pdr_est.types.track import Track

WRONG_BY_RAD = 0.15
START = Config(start=StartParams(x_m=0.0, y_m=0.0, heading_rad=WRONG_BY_RAD, sigma_heading_rad=0.25)).with_estimator(
    "factor-graph"
)


@cache
def office() -> SimulatedWalk:
    """Twice round a block of an office, along x and y."""
    return simulate_walk(preset("office_loop"))


def hall(turn_rad: float = 0.0) -> FloorPlan:
    """A plan around the walk, with a block of ten rooms beside it, all turned about the start."""
    truth_m = office().truth_position_m
    low, high = truth_m.min(axis=0) - 4.0, truth_m.max(axis=0) + 4.0

    def box(west: float, south: float, east: float, north: float) -> Array:
        corners = np.array([[west, south], [east, south], [east, north], [west, north]])
        return rotate_vectors(corners, turn_rad)

    rooms = [box(high[0] + 5.0 * k, low[1], high[0] + 5.0 * k + 4.0, low[1] + 6.0) for k in range(1, 11)]
    areas = [WalkableArea(ring) for ring in (box(*low, *high), *rooms)]
    return FloorPlan("hall", tuple(areas), np.empty((0, 2, 2)), 0.2)


def heading_error_rad(track: Track) -> float:
    """Angle by which the whole track is turned about its start."""
    truth_m = np.column_stack(
        [np.interp(track.time_s, office().truth_time_s, axis_m) for axis_m in office().truth_position_m.T]
    )
    own = (track.position_m - track.position_m[0]) @ np.array([1.0, 1j])
    true = (truth_m - truth_m[0]) @ np.array([1.0, 1j])
    return float(np.angle(np.vdot(true, own)))


class Watching:
    """An estimator that shows what it was given."""

    spec = EstimatorSpec("watching", smooths=True, uses_plan=True)
    given: ClassVar[list[DeviceMeasurements]] = []  # of the class: the pipeline works on a copy of the object

    def estimate(self, devices: Sequence[DeviceMeasurements], *rest: Any) -> Track:
        self.given[:] = devices
        return estimator_named("dead-reckoning").estimate(devices, *rest)


class Unaware(Watching):
    """The same for an estimator that knows no plans."""

    spec = EstimatorSpec("unaware", smooths=True)


def plans_given_to(estimator: Watching, plan: FloorPlan | None) -> list[FloorPlan]:
    pipeline.smooth_recording(office().recording, START, parts=Parts(estimator=estimator), plan=plan)
    return [m for device in estimator.given for m in device.measurements if isinstance(m, FloorPlan)]


def test_only_estimators_that_use_plans_get_one() -> None:
    plan = hall()
    assert plans_given_to(Watching(), plan) == [plan]
    assert plans_given_to(Watching(), None) == []
    assert plans_given_to(Unaware(), plan) == []


def test_a_walk_along_the_walls_takes_its_direction_from_them() -> None:
    without = pipeline.smooth_recording(office().recording, START)
    assert heading_error_rad(without.track) == pytest.approx(WRONG_BY_RAD, abs=0.05)
    with_plan = pipeline.smooth_recording(office().recording, START, plan=hall())
    assert heading_error_rad(with_plan.track) == pytest.approx(0.0, abs=0.03)
    turned = pipeline.smooth_recording(office().recording, START, plan=hall(turn_rad=0.3))
    assert heading_error_rad(turned.track) == pytest.approx(0.3, abs=0.03)


def test_walls_that_the_walk_does_not_follow_change_nothing() -> None:
    diagonal = pipeline.smooth_recording(office().recording, START, plan=hall(turn_rad=WRONG_BY_RAD + np.pi / 4.0))
    assert heading_error_rad(diagonal.track) == pytest.approx(WRONG_BY_RAD, abs=0.05)


def test_a_direction_that_is_not_known_stays_so() -> None:
    unknown = replace(START, start=StartParams())
    plain = pipeline.smooth_recording(office().recording, unknown).track
    with_plan = pipeline.smooth_recording(office().recording, unknown, plan=hall(turn_rad=0.4)).track
    np.testing.assert_allclose(with_plan.position_m, plain.position_m, atol=0.05)


def test_an_estimator_that_weighs_the_walls_gets_no_headings_along_them_besides() -> None:
    weighs, guided = (START.with_estimator(name) for name in ("particle", "factor-graph"))
    assert with_plan_directions(weighs, hall(), weighs.estimator.make().spec) == weighs
    assert with_plan_directions(guided, hall(), guided.estimator.make().spec) != guided


def test_directions_of_the_settings_come_before_those_of_the_plan() -> None:
    settings = START.replace({"heading.dominant.direction_rad": 0.3})
    track = pipeline.smooth_recording(office().recording, settings, plan=hall()).track
    assert heading_error_rad(track) == pytest.approx(0.3, abs=0.03)


@pytest.mark.parametrize("name", ["factor-graph", "ekf", "dead-reckoning", "fixed-lag"])
def test_other_estimators_take_no_notice_of_a_plan_among_the_measurements(name: str) -> None:
    (walk,) = pipeline.analyse_recording(office().recording, START)
    start = START.start.pose()
    plain = pdr_est.estimate(walk.odometry, (), name, start=start)
    np.testing.assert_array_equal(
        pdr_est.estimate(walk.odometry, (), name, start=start, plan=hall()).position_m, plain.position_m
    )


@pytest.mark.parametrize(
    ("name", "words"), [("factor-graph", "only the directions of the walls from"), ("ekf", "nothing from")]
)
def test_a_plan_that_is_hardly_used_is_a_warning(name: str, words: str) -> None:
    walk = pipeline.smooth_recording(office().recording, START.with_estimator(name), plan=hall())
    assert f"{name} takes {words} the floor plan: with `particle` the track stays on the floor" in walk.warnings
    assert walk.plan is not None


def test_notes_of_the_plan_are_warnings() -> None:
    noted = replace(hall(), notes=("2 outlines cross themselves",))
    assert (
        "plan hall: 2 outlines cross themselves"
        in pipeline.smooth_recording(office().recording, START, plan=noted).warnings
    )


def test_a_start_off_the_floor_is_refused_in_words() -> None:
    outside = replace(START, start=replace(START.start, x_m=-50.0))
    with pytest.raises(FloorPlanError, match=r"start \(-50, 0\) m lies 22\.0 m outside of the .* plan hall"):
        pdr_est.smooth(office().recording, outside, plan=hall())
    nearly = replace(START, start=replace(START.start, x_m=-29.0))  # 1 m off, known to half a metre
    assert len(pdr_est.smooth(office().recording, nearly, plan=hall()))


@pytest.mark.parametrize(
    ("plan", "words"), [("plan.geojson", "is no FloorPlan: read it"), (replace(hall(), areas=()), "no walkable area")]
)
def test_what_is_no_plan_is_refused_in_words(plan: Any, words: str) -> None:
    with pytest.raises(FloorPlanError, match=words):
        pdr_est.smooth(office().recording, START, plan=plan)


def test_a_plan_in_another_map_frame_is_refused() -> None:
    recording = replace(office().recording, origin=GeoOrigin(48.1, 11.5))
    plan = replace(hall(), origin=GeoOrigin(48.2, 11.5))
    with pytest.raises(FloorPlanError, match=r"latitude 48.2.* read the plan with origin=recording.origin"):
        pdr_est.smooth(recording, START, plan=plan)


@pytest.mark.parametrize(
    ("plan", "words"),
    [
        (replace(hall(), sigma_m=np.nan), "plan hall: sigma_m = nan"),
        ([PresentFloor(0.0, hall(), 2.0)], r"plan\[0\]: probability = 2.0"),
        ("hall.geojson", "plan = 'hall.geojson': give a FloorPlan, or a PresentFloor"),
    ],
)
def test_steps_are_not_estimated_on_a_plan_of_no_use(plan: Any, words: str) -> None:
    step = pdr_est.StepOdometry("phone", 0.5, 0.0, 0.7, 0.0, 0.01 * np.eye(3))
    with pytest.raises(FloorPlanError, match=words):
        pdr_est.estimate([step], plan=plan)


@pytest.mark.parametrize(("size_m", "told"), [(30.0, False), (1.0, True)])
def test_a_track_off_its_plan_is_told(size_m: float, told: bool) -> None:
    """The plan of a single room does not hold a walk of 150 m."""
    corners = size_m * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    plan = FloorPlan("room", (WalkableArea(corners),), np.empty((0, 2, 2)), 0.2)
    walk = pipeline.smooth_recording(office().recording, START.with_estimator("particle"), plan=plan)
    assert any("does not fit this walk" in one for one in walk.warnings) == told
