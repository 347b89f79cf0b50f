"""Floor plans while the walk is recorded: the filter gets them first, and each change of floor when it is known."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from storeys import BUILDING, FIRST, TURNED, error_m, over_three_storeys
from two_phones import KNOWN_START, push_all, recorded, slices

from pdr_est import pipeline
from pdr_est.errors import ConfigError, FloorPlanError
from pdr_est.estimators import estimator_named
from pdr_est.online import Tracker, track_of
from pdr_est.types.floor_plan import FloorPlan, WalkableArea
from pdr_est.types.track import Track

PARTICLE = KNOWN_START.with_estimator("particle")
OUTLINE = [(-2, -1), (15, -1), (15, 10), (-2, 10), (-2, 8), (13, 8), (13, 1), (-2, 1)]
CORRIDORS = FloorPlan("corridors", (WalkableArea(np.array(OUTLINE, dtype=float)),), np.zeros((0, 2, 2)), 0.1)


@cache
def tracked(every_s: float, on_plans: bool = True, restored: bool = False) -> Track:
    recording = over_three_storeys().recording
    tracker = Tracker(TURNED.with_estimator("particle"), ["phone"], plan=BUILDING if on_plans else None)
    blocks = slices(recording, [np.arange(every_s, 250.0, every_s)])
    found = []
    for number, (name, block) in enumerate(blocks):
        if restored and number % 700 == 699:
            tracker = Tracker.restore(tracker.state())
        found += tracker.push(name, block)
    return track_of([*found, *tracker.flush()])


def test_a_tracker_with_a_plan_is_the_filter_that_gets_the_plan_first() -> None:
    recording = recorded(1)
    tracker = Tracker(PARTICLE, [recording.devices[0].name], plan=CORRIDORS)
    track = track_of(push_all(tracker, slices(recording, [np.arange(0.5, 60.0, 0.5)])))
    (walk,) = pipeline.analyse_recording(recording, PARTICLE, at_the_end=False)
    own = estimator_named("particle").begin(
        [walk.device], PARTICLE.start.pose(), PARTICLE.odometry.sigma_length_scale
    )
    poses = [pose for one in (CORRIDORS, *walk.odometry) for pose in own.push(one)] + own.flush()
    last = {pose.time_s: pose for pose in poses}
    assert len(track) > 40
    for time_s, position_m in zip(track.time_s.tolist(), track.position_m, strict=True):
        assert (position_m == last[time_s].position_m).all()
    assert CORRIDORS.contains(track.position_m).mean() > 0.98


def test_the_plan_of_the_floor_by_the_air_pressure_counts() -> None:
    walk = over_three_storeys()
    on_plans, free = (error_m(tracked(1.0, known), walk) for known in (True, False))
    assert on_plans.mean() < 0.5 * free.mean()  # both take the steps on stairs for longer ones
    assert on_plans.max() < 0.7 * free.max()


def test_how_the_recording_is_cut_and_whether_it_is_saved_changes_nothing() -> None:
    whole = tracked(1.0)
    other = tracked(0.37, restored=True)
    assert (other.time_s == whole.time_s).all()
    assert (other.position_m == whole.position_m).all()


def test_the_floor_at_the_start_must_be_known() -> None:
    with pytest.raises(FloorPlanError, match=r"shows the floors 0, 1, 2.*--floor"):
        Tracker(PARTICLE, plan=replace(BUILDING, start=None))


def test_a_plan_that_nobody_uses_is_refused() -> None:
    with pytest.raises(ConfigError, match="ekf makes no use of the floor plan corridors: track with particle"):
        Tracker(KNOWN_START, plan=CORRIDORS)
    with pytest.raises(FloorPlanError, match="outside of the walkable area"):
        Tracker(PARTICLE, plan=FIRST)
    with pytest.raises(FloorPlanError, match="is no FloorPlan"):
        Tracker(PARTICLE, plan="office.geojson")  # type: ignore[arg-type]
