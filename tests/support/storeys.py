"""A walk through three storeys, by stairs and by lift, and the plan of each of them."""

from dataclasses import replace
from functools import cache

import numpy as np

from pdr_est.config import Config, StartParams
from pdr_est.frames import Array
from pdr_est.simulate import DeviceParams, PathParams, Pause, Scenario, SensorParams, WalkerGaitParams, simulate_walk
from pdr_est.simulate.riding.riding_body import LEAST_RIDE_S, Ride
from pdr_est.simulate.riding.vehicles import lift
from pdr_est.simulate.sensors.sensor_errors import PHONE_BAROMETER
from pdr_est.simulate.walk import SimulatedWalk
from pdr_est.simulate.walker.gait_stretches import StairStretch
from pdr_est.types.floor_plan import BuildingPlan, FloorPlan, WalkableArea
from pdr_est.types.track import Track

TREAD_M, RISE_M, FLIGHT_M = 0.29, 0.175, 20 * 0.29  # a storey of 3.5 m, as by the lift
UP_AT_M, LIFT_AT_M, DOWN_AT_M = 36.0, 120.0, 190.0
TURNED = Config(start=StartParams(x_m=0.0, y_m=0.0, heading_rad=0.1, sigma_heading_rad=0.1))
"""The walk begins in a direction that is wrong by 6 degrees, which is its standard deviation."""

_GROUND = [[(-3.0, -1.5), (37.0, -1.5), (37.0, 1.5), (-3.0, 1.5)]]
_FIRST = [
    [(40.0, -1.5), (61.5, -1.5), (61.5, 31.5), (28.0, 31.5), (28.0, 28.5), (58.5, 28.5), (58.5, 1.5), (40.0, 1.5)],
    [(54.0, 58.5), (83.0, 58.5), (83.0, 61.5), (54.0, 61.5)],
]
_SECOND = [
    [(18.5, 28.5), (32.0, 28.5), (32.0, 31.5), (21.5, 31.5), (21.5, 58.5), (51.0, 58.5), (51.0, 61.5), (18.5, 61.5)]
]


@cache
def over_three_storeys(barometer: bool = True, seed: int = 3) -> SimulatedWalk:
    """On the ground floor, up the stairs, up by lift, and down the stairs to the other end of the first floor."""
    up, down = (
        StairStretch(from_m=at_m, to_m=at_m + FLIGHT_M, direction=direction, tread_m=TREAD_M, rise_m=RISE_M)
        for at_m, direction in ((UP_AT_M, "up"), (DOWN_AT_M, "down"))
    )
    sensors = SensorParams(barometer=PHONE_BAROMETER) if barometer else SensorParams()
    scenario = Scenario(
        name="storeys",
        path=PathParams(vertices_m=((0.0, 0.0), (60.0, 0.0), (60.0, 30.0), (20.0, 30.0), (20.0, 60.0), (80.0, 60.0))),
        gait=WalkerGaitParams(stretches=(up, down), pauses=(Pause(at_m=LIFT_AT_M, duration_s=LEAST_RIDE_S + 0.1),)),
        devices=(DeviceParams(name="phone", sensors=sensors),),
        rides=(Ride(pause=0, vehicle=replace(lift(), speed_mps=1.3)),),
        seed=seed,
    )
    return simulate_walk(scenario)


def floor_plan(name: str, outlines: list[list[tuple[float, float]]]) -> FloorPlan:
    areas = tuple(WalkableArea(np.array(outline)) for outline in outlines)
    return FloorPlan(name, areas, np.zeros((0, 2, 2)), 0.2, name)


GROUND, FIRST, SECOND = (
    floor_plan(name, outlines) for name, outlines in (("0", _GROUND), ("1", _FIRST), ("2", _SECOND))
)
BUILDING = BuildingPlan("building", (GROUND, FIRST, SECOND), (0, 1, 2), start=0)


def error_m(track: Track, walk: SimulatedWalk) -> Array:
    """Distance of each pose from where the walker was."""
    true_m = np.column_stack([np.interp(track.time_s, walk.truth_time_s, axis) for axis in walk.truth_position_m.T])
    return np.asarray(np.hypot(*(track.position_m - true_m).T))
