"""Walks over several floors: each has walls of its own, and between two of them there are none."""

from collections.abc import Sequence
from math import inf

import numpy as np
import pytest
from estimator_walks import DEVICE, SIGMA_SCALE, step

from pdr_est.errors import EstimationError
from pdr_est.estimators import estimate_walk
from pdr_est.estimators.particle.online_filter import ParticleOnlineFilter
from pdr_est.estimators.particle.params import ParticleParams
from pdr_est.estimators.particle.plan.plans_in_time import PlanModels
from pdr_est.frames import Array
from pdr_est.types.floor_plan import FloorPlan, WalkableArea
from pdr_est.types.measurements import DeviceMeasurements, Measurement, PresentFloor, StartPose
from pdr_est.types.track import Track

EAST = StartPose((2.0, 0.0), 0.0, sigma_position_m=0.2, sigma_heading_rad=0.05)
TURN_RAD = 0.006  # of every step that the gyroscope errs by
CHANGE_S = step(40).time_s


def corridor(name: str, south_m: float, north_m: float) -> FloorPlan:
    outline = np.array([(0.0, south_m), (70.0, south_m), (70.0, north_m), (0.0, north_m)])
    return FloorPlan(name, (WalkableArea(outline),), np.zeros((0, 2, 2)), 0.1)


GROUND, FIRST = corridor("ground", -1.0, 1.0), corridor("first", -1.0, 6.0)


def walk(*more: Measurement) -> list[Measurement]:
    return [*(step(k, turn_rad=TURN_RAD) for k in range(1, 81)), *more]


def particles(measurements: Sequence[Measurement]) -> Track:
    return estimate_walk("particle", [DeviceMeasurements(DEVICE, 0.0, tuple(measurements))], EAST, SIGMA_SCALE)


def north_of(track: Track) -> Array:
    return np.asarray(track.position_m[:, 1])


def test_the_walls_of_the_present_floor_count() -> None:
    """In the narrow corridor of the ground floor the track stays straight; on the first floor there is room."""
    north_m = north_of(particles(walk(PresentFloor(-inf, GROUND), PresentFloor(CHANGE_S, FIRST))))
    assert np.abs(north_m[:40]).max() < 1.0
    assert north_m[-1] > 1.5
    assert np.abs(north_of(particles(walk(GROUND)))).max() < 1.1
    wrong = north_of(particles(walk(PresentFloor(-inf, FIRST), PresentFloor(CHANGE_S, GROUND))))
    assert np.abs(wrong[41:]).max() < 1.1


def test_between_floors_there_are_no_walls() -> None:
    free = particles(walk(PresentFloor(-inf, GROUND), PresentFloor(CHANGE_S, None)))
    assert np.abs(north_of(free)[:40]).max() < 1.0
    assert north_of(free)[-1] > 1.5
    open_m, no_floor_m = (particles(one).position_m for one in (walk(), walk(PresentFloor(-inf, None))))
    assert (open_m == no_floor_m).all()


def test_a_way_that_leads_onto_a_floor_beside_its_ground_is_drawn_there() -> None:
    """The corridor of the next floor lies 1.5 m to the north: the walker drifted there on the stairs."""
    floors = PresentFloor(-inf, GROUND), PresentFloor(step(36).time_s, None)
    track = particles(walk(*floors, PresentFloor(CHANGE_S, corridor("first", 1.5, 3.5))))
    assert ((north_of(track)[42:] > 1.4) & (north_of(track)[42:] < 3.6)).all()


def test_walls_of_an_uncertain_floor_are_as_permeable_as_it_is_improbable() -> None:
    models = PlanModels(ParticleParams(pass_probability=0.02))
    through = np.array([[30.0], [0.0]]), np.array([[30.0], [2.0]])
    for probability in (1.0, 0.5, 0.0):
        model = models.of(PresentFloor(0.0, GROUND, probability))
        assert model is not None
        passing = np.exp(model.log_way(*through)[0])
        assert passing == pytest.approx(1.0 - probability * 0.98, abs=1e-6)


def test_online_the_present_floor_is_pushed_when_it_changes() -> None:
    own = ParticleOnlineFilter([DEVICE], EAST, SIGMA_SCALE, ParticleParams())
    north_m = []
    for one in (PresentFloor(-inf, FIRST), PresentFloor(-inf, GROUND), *walk()):
        if one.time_s == CHANGE_S:
            assert own.push(PresentFloor(CHANGE_S, FIRST)) == []
        north_m += [pose.position_m[1] for pose in own.push(one)]
    assert np.abs(north_m[:40]).max() < 1.0
    assert north_m[-1] > 1.5


def test_a_plan_for_the_whole_walk_and_one_for_a_floor_contradict_each_other() -> None:
    with pytest.raises(EstimationError, match="PresentFloor for each time"):
        particles(walk(GROUND, PresentFloor(CHANGE_S, FIRST)))
