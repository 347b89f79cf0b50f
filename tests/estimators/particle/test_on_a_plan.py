"""Walks on a floor plan: walls, doors, wrong plans and unknown starts."""

from collections.abc import Sequence
from dataclasses import replace
from math import erf

import numpy as np
import pytest
from estimator_walks import DEVICE, SIGMA_SCALE, fix, heading_prior, step, usual_covariance

import pdr_est
from pdr_est.errors import EstimationError
from pdr_est.estimators import estimate_walk
from pdr_est.estimators.particle.online_filter import ParticleOnlineFilter
from pdr_est.estimators.particle.params import ParticleParams
from pdr_est.estimators.particle.plan.nearest_walls import nearest_walls
from pdr_est.estimators.particle.plan.plan_grid import grid_of
from pdr_est.frames import Array
from pdr_est.types.findings import FindingKind
from pdr_est.types.floor_plan import FloorPlan, WalkableArea
from pdr_est.types.measurements import DeviceMeasurements, Measurement, StartPose
from pdr_est.types.steps import TurnHypothesis
from pdr_est.types.track import Track

EAST = StartPose((2.0, 0.0), 0.0, sigma_position_m=0.2, sigma_heading_rad=0.05)
NO_WALLS = np.zeros((0, 2, 2))


def plan_of(
    *rectangles: tuple[float, float, float, float], walls_m: Array = NO_WALLS, sigma_m: float = 0.1
) -> FloorPlan:
    """Rooms (west, south, east, north), which do not overlap."""
    areas = tuple(
        WalkableArea(np.array([(west, south), (east, south), (east, north), (west, north)]))
        for west, south, east, north in rectangles
    )
    return FloorPlan("test", areas, walls_m, sigma_m)


CORRIDOR = plan_of((0.0, -1.0, 60.0, 1.0))
ANGLE = FloorPlan(
    "angle",
    (WalkableArea(np.array([(0.0, -1.0), (31.0, -1.0), (31.0, 30.0), (29.0, 30.0), (29.0, 1.0), (0.0, 1.0)])),),
    NO_WALLS,
    0.1,
)


def steps(count: int, turn_rad: float = 0.0) -> list[Measurement]:
    return [step(k, turn_rad=turn_rad) for k in range(1, count + 1)]


def particles(
    measurements: Sequence[Measurement], start: StartPose = EAST, parameters: ParticleParams | None = None
) -> Track:
    devices = [DeviceMeasurements(DEVICE, 0.0, tuple(measurements))]
    return estimate_walk("particle", devices, start, SIGMA_SCALE, particle=parameters or ParticleParams())


def test_the_raster_knows_inside_outside_and_walls() -> None:
    hole = np.array([(4.0, 4.0), (6.0, 4.0), (6.0, 6.0), (4.0, 6.0)])
    square = np.array([(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)])
    wall = np.array([[(2.0, 0.0), (2.0, 3.0)]])
    grid = grid_of(FloorPlan("room", (WalkableArea(square, (hole,)),), wall, 0.0), 0.2)
    east, north = np.array([1.0, 5.0, -1.0, 99.0]), np.array([1.0, 5.0, 5.0, 5.0])
    assert grid.at(east, north).tolist() == [1.0, 0.0, 0.0, 0.0]
    ways = np.array([(1.0, 1.0, 3.0, 1.0), (1.0, 4.5, 3.0, 4.5), (3.0, 5.0, 7.0, 5.0)]).T
    free = grid.along(grid.cells(ways[:2]), grid.cells(ways[2:]))
    assert free.tolist() == [0.0, 1.0, 0.0]  # through the wall, past its end, across the hole
    assert grid.walkable.sum() * 0.2**2 == pytest.approx(96.0, rel=0.03)


def test_beside_a_wall_the_drawing_error_decides() -> None:
    grid = grid_of(replace(CORRIDOR, sigma_m=0.4), 0.1)
    inside = grid.at(np.full(3, 30.0), np.array([0.95, 0.6, 1.4]))
    assert inside == pytest.approx([0.55, 0.84, 0.16], abs=0.06)


def test_a_corridor_keeps_the_track_inside() -> None:
    drifting = steps(70, 0.006)
    outside = [
        np.abs(track.position_m[:, 1]) > 1.0 for track in (particles([*drifting, CORRIDOR]), particles(drifting))
    ]
    assert outside[0].mean() == 0.0
    assert outside[1].mean() > 0.5
    track = particles([*drifting, CORRIDOR])
    assert np.abs(track.heading_rad[10:60]).max() < 0.2
    assert track.position_m[-1, 0] == pytest.approx(2.0 + 70 * 0.7, abs=6.0)
    assert track.findings == ()


def test_a_corner_tells_the_length_of_the_steps() -> None:
    """Forty-four steps of 0.7 m lead to the corner from 28 m before it; they are of 0.64 m."""
    walk = [step(k, turn_rad=np.pi / 2.0 if k == 45 else 0.0) for k in range(1, 75)]
    track = particles([*walk, ANGLE])
    assert track.length_scale == pytest.approx(28.0 / (44 * 0.7), abs=0.04)
    assert track.sigma_length_scale < 0.6 * SIGMA_SCALE
    assert track.position_m[60:, 0] == pytest.approx(np.full(15, 30.0), abs=1.0)


@pytest.mark.parametrize("probability", [0.05, 0.4])
def test_a_closed_door_is_passed_with_the_stated_probability(probability: float) -> None:
    """The walker went straight on, through a door that is not drawn, or to the left, where it is free."""
    turns = (TurnHypothesis(0.5, 0.0, 0.03, "straight"), TurnHypothesis(0.5, np.pi / 2.0, 0.03, "corner"))
    covariance = usual_covariance(0.7)
    covariance[2, 2] = 0.03**2 + (np.pi / 4.0) ** 2
    choice = replace(step(11), heading_change_rad=np.pi / 4.0, covariance=covariance, turn_hypotheses=turns)
    walk = [*steps(10), choice, *(step(k) for k in range(12, 17))]
    corners = np.linspace((8.0, -2.6), (18.0, 7.4), 16)  # at the same angle to both ways
    wall = np.stack([corners[:-1], corners[1:]], axis=1)  # in pieces that are too short to tell where people walk
    hall = plan_of((0.0, -20.0, 30.0, 20.0), walls_m=wall, sigma_m=0.05)
    settings = ParticleParams(pass_probability=probability, most_particles=6000, least_particles=6000)
    own = ParticleOnlineFilter([DEVICE], StartPose((2.0, 0.0), 0.0, 0.05, 0.01), 0.01, settings)
    for one in (hall, *walk):
        poses = own.push(one)
    end = poses[-1]
    straight = 0.5 * (end.position_m[0] - 9.0) / 4.2 + 0.5 * (4.2 - end.position_m[1]) / 4.2
    assert straight == pytest.approx(probability / (1.0 + probability), abs=0.04)


def test_a_plan_that_has_nothing_to_do_with_the_walk_is_told_and_hardly_followed() -> None:
    rooms = plan_of(*[(4.0 * i, 4.0 * j - 10.0, 4.0 * i + 3.0, 4.0 * j - 7.0) for i in range(10) for j in range(6)])
    walk = steps(50)
    track = particles([*walk, rooms])
    assert [finding.kind for finding in track.findings] == [FindingKind.PLAN]
    assert "does not fit this walk" in track.findings[0].message
    free = particles(walk)
    assert track.findings[0].value > 0.9
    assert np.hypot(*(track.position_m - free.position_m).T).max() < 0.5
    spread = np.sqrt(np.trace(track.covariance_m2[-1]) / np.trace(free.covariance_m2[-1]))
    assert spread == pytest.approx(1.0, abs=0.15)


def test_of_several_plans_none_is_chosen() -> None:
    with pytest.raises(EstimationError, match="2 floor plans"):
        particles([*steps(3), CORRIDOR, ANGLE])


def test_a_plan_in_other_units_is_refused() -> None:
    with pytest.raises(EstimationError, match="check its units"):
        grid_of(plan_of((0.0, 0.0, 1e6, 1e6)), 0.2)
    with pytest.raises(EstimationError, match="no walkable area"):
        particles([*steps(3), FloorPlan("empty", (), NO_WALLS, 0.1)])


def test_north_and_a_corner_tell_an_unknown_start() -> None:
    """Twenty-five metres along the corridor and ten to the left fit only one place of the plan."""
    walk = [step(k, turn_rad=np.pi / 2.0 if k == 37 else 0.0) for k in range(1, 61)]
    track = particles([*walk, heading_prior(1, 0.0, 0.1), ANGLE], StartPose())
    assert track.position_m[36] == pytest.approx([30.0, 0.0], abs=1.5)
    assert track.position_m[-1, 0] == pytest.approx(30.0, abs=1.0)
    straight = particles([*steps(30), heading_prior(1, 0.0, 0.1), ANGLE], StartPose())
    assert np.trace(straight.covariance_m2[0]) > 4.0 * np.trace(track.covariance_m2[36])


def test_a_plan_tells_the_direction_of_a_walk_that_knows_its_start() -> None:
    """Of all directions, only one leads twenty-nine metres along the first corridor and then to the left."""
    walk = [step(k, turn_rad=np.pi / 2.0 if k == 41 else 0.0) for k in range(1, 71)]
    track = particles([*walk, ANGLE], StartPose((1.5, 0.0), None, 0.2))
    assert track.on_plan
    assert np.abs(track.heading_rad[5:40]).max() < 0.2
    assert track.position_m[-1, 0] == pytest.approx(30.0, abs=1.0)
    free = particles(walk, StartPose((1.5, 0.0), None, 0.2))
    assert not free.on_plan
    assert free.sigma_heading_rad[0] == 0.0  # it defines the frame


def test_the_default_of_the_public_function_uses_a_plan_and_says_nothing_of_an_unknown_direction() -> None:
    walk = [step(k, turn_rad=np.pi / 2.0 if k == 41 else 0.0) for k in range(1, 71)]
    start = StartPose((1.5, 0.0), None, 0.2)
    on_plan = pdr_est.estimate(walk, start=start, plan=ANGLE)
    assert (on_plan.estimator, on_plan.findings) == ("particle", ())
    assert on_plan.sigma_heading_rad.max() < 0.2
    without = pdr_est.estimate(walk, start=start)
    assert without.estimator == "factor-graph"
    assert [finding.kind for finding in without.findings] == [FindingKind.START_HEADING]


def test_a_fix_outside_the_walls_moves_the_track_no_further_than_its_error() -> None:
    track = particles([*steps(40), fix(40, 30.0, 3.0, 1.0), CORRIDOR])
    assert abs(track.position_m[-1, 1]) <= 1.1
    assert track.position_m[-1, 0] == pytest.approx(30.0, abs=1.0)


def test_online_the_walls_count_at_the_start_too() -> None:
    """Beside a wall, nearly half of what is known about the start lies behind it."""
    own = ParticleOnlineFilter([DEVICE], StartPose((2.0, 0.9), 0.0, 0.5, 0.05), SIGMA_SCALE, ParticleParams())
    own.push(CORRIDOR)
    begin = own.push(step(1))[0]
    below = (1.0 - 0.9) / 0.5  # of a normal distribution that ends at the wall, over its standard deviation
    share, density = 0.5 + 0.5 * erf(below / np.sqrt(2.0)), np.exp(-0.5 * below**2) / np.sqrt(2.0 * np.pi)
    assert begin.position_m[1] == pytest.approx(0.9 - 0.5 * density / share, abs=0.07)


def test_beside_a_wall_people_walk_along_it_and_at_some_distance_from_it() -> None:
    hall = plan_of((0.0, 0.0, 60.0, 40.0))
    walls = nearest_walls(hall, grid_of(hall, 0.2))
    assert walls is not None
    north_m = np.array([0.9, 0.9, 6.0, 6.0])
    places = np.array([np.full(4, 30.0), north_m, [0.0, 0.8, 0.0, 0.8]])
    along, across, along_far, across_far = walls.log_weight(places, 10.0)
    assert along - across > along_far - across_far + 0.3 > 0.5
    assert walls.log_weight(np.array([[30.0], [0.9], [-np.pi]]), 10.0)[0] == pytest.approx(along)  # in either sense
    assert walls.log_weight(places[:, [1]], 20.0)[0] == pytest.approx(2.0 * across)
    assert across > across_far + 0.3
