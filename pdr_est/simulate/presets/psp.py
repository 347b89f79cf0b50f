"""The walks of PSP (Hong et al. 2013, section III): five people, a phone in either front pocket, two closed paths."""

from dataclasses import replace
from typing import Literal

import numpy as np

from pdr_est.frames import Array
from pdr_est.simulate.carrying.pocket_phone import PocketPhone
from pdr_est.simulate.people.person import SimulatedPerson, sample_person
from pdr_est.simulate.scenario import DeviceParams, Scenario
from pdr_est.simulate.sensors.magnetic_field import scatter_dipoles
from pdr_est.simulate.sensors.sensor_errors import PHONE_MAGNETOMETER, SensorParams
from pdr_est.simulate.walker.walking_body import Side
from pdr_est.simulate.walker.walking_path import PEAK_SLOPE, PathParams, WalkingPath

PspTrajectory = Literal["I", "II"]
PSP_TESTS = 25  # a trajectory: 50 tests in all

_PEOPLE = 5
_LENGTH_M: dict[PspTrajectory, float] = {"I": 204.0, "II": 290.0}
_DEPTH_M: dict[PspTrajectory, float] = {"I": 36.0, "II": 26.0}
_LAPS, _CIRCLE_RADIUS_M, _CIRCLE_CORNERS = 5, 5.0, 72
_CORNER_RADIUS_M = 0.8
_COMBINATIONS: tuple[tuple[Side, bool], ...] = (("left", True), ("left", False), ("right", True), ("right", False))
# Android gives the field less the hard iron that it knows; a few uT are left. Ours.
_SENSORS = SensorParams(rate_hz=100.0, magnetometer=replace(PHONE_MAGNETOMETER, bias_std=3.0))
_IRON_SPACING_M = 5.0


def psp_walks(trajectory: PspTrajectory, tests: int = PSP_TESTS, seed: int = 0) -> tuple[Scenario, ...]:
    """Make the tests of PSP on one trajectory.

    The paper has 50 tests of five people on two trajectories and does not tell which. Here each person walks both
    ways round with the phone in either pocket, 20 tests, and one of these four a second time, with the phone put in
    anew: 25. Any five tests in a row are of the five people. The walk starts with a straight part to the east, which
    is a direction of the building. The phone stands nearly straight, upper edge up, its axis leaning by 5 degrees
    (standard deviation each way), and is recorded at 100 Hz with its magnetometer.

    Parameters
    ----------
    trajectory : {"I", "II"}
        Trajectory of the paper.
    tests : int
        Number of tests, the first ones of the 25.
    seed : int
        Seed of the people, the magnetised bodies in the building, and the sensors.
    """
    people = [sample_person(np.random.default_rng([seed, 3, number])) for number in range(_PEOPLE)]
    return tuple(_walk(trajectory, people[number % _PEOPLE], number, seed) for number in range(tests))


def psp_path(trajectory: PspTrajectory, clockwise: bool) -> PathParams:
    """Make a closed path of 204.0 m (I) or 290.0 m (II), from the middle of a side, to the east.

    Fig. 3 is not in the text that we have. I is a rectangle of 66 m by 36 m. II is one of 40 m by 26 m; in the middle
    of the side across from the start the walker goes round a circle of 5 m radius five times, turning as the
    rectangle does. In a stride he turns by 16 degrees there, above the threshold of eq. 2, as he must for the paper's
    statement that HDE suspends its action on the circle.
    """
    guess = _around(trajectory, half_m=20.0)
    half_m = 20.0 + (_LENGTH_M[trajectory] - WalkingPath(guess).length_m) / 4.0
    path = _around(trajectory, half_m)
    return replace(path, vertices_m=tuple((x, -y) for x, y in path.vertices_m)) if clockwise else path


def _around(trajectory: PspTrajectory, half_m: float) -> PathParams:
    """Make the path counter-clockwise around a rectangle 2 half_m wide, with the circle of trajectory II."""
    depth_m = _DEPTH_M[trajectory]
    before = ((0.0, 0.0), (half_m, 0.0), (half_m, depth_m))
    after = ((-half_m, depth_m), (-half_m, 0.0), (0.0, 0.0))
    circle = _circle(depth_m) if trajectory == "II" else np.empty((0, 2))
    edge_m = 2.0 * _CIRCLE_RADIUS_M * np.tan(np.pi / _CIRCLE_CORNERS)
    # what the smooth corners may cut off: a little less than half of the edge at either end
    smooth_m = 0.99 * edge_m / (PEAK_SLOPE * 2.0 * np.pi / _CIRCLE_CORNERS)
    corner, round_m = (_CORNER_RADIUS_M,) * 2, (float(smooth_m),) * len(circle)
    return PathParams(
        vertices_m=(*before, *((float(x), float(y)) for x, y in circle), *after),
        corner_radii_m=(*corner, *round_m, *corner),
    )


def _circle(depth_m: float) -> Array:
    """Make the corners (n, 2) of a polygon around the circle, lap after lap.

    The circle touches the side at depth_m.
    """
    step_rad = 2.0 * np.pi / _CIRCLE_CORNERS
    angle = np.pi / 2.0 + step_rad * (0.5 + np.arange(_LAPS * _CIRCLE_CORNERS))
    corner_m = _CIRCLE_RADIUS_M / np.cos(step_rad / 2.0)
    centre = np.array([0.0, depth_m - _CIRCLE_RADIUS_M])
    circle: Array = centre + corner_m * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return circle


def _walk(trajectory: PspTrajectory, person: SimulatedPerson, number: int, seed: int) -> Scenario:
    """Make one test of a person."""
    who = number % _PEOPLE
    side, clockwise = _COMBINATIONS[(number // _PEOPLE + who) % len(_COMBINATIONS)]
    rng = np.random.default_rng([seed, 4, int(trajectory == "II"), number])
    path = psp_path(trajectory, clockwise)
    device = DeviceParams(carry=_pocketed(person, side, rng), sensors=_SENSORS)
    sense = "clockwise" if clockwise else "counterclockwise"
    return Scenario(
        name=f"psp_{trajectory}_person{who + 1}_{side}_{sense}_{number + 1:02d}",
        path=path,
        gait=person.gait,
        body=person.body,
        devices=(device,),
        irons=scatter_dipoles(WalkingPath(path), _IRON_SPACING_M, int(rng.integers(2**31))),
        seed=int(rng.integers(2**31)),
    )


def _pocketed(person: SimulatedPerson, side: Side, rng: np.random.Generator) -> PocketPhone:
    """Put the phone nearly straight into that pocket of the person; the trousers decide where the screen points."""
    facing_rad = person.pocket.facing_rad if person.pocket.side == side else -person.pocket.facing_rad
    spin_rad, tip_rad = np.deg2rad(5.0) * rng.standard_normal(2)
    return replace(person.pocket, side=side, facing_rad=facing_rad, spin_rad=float(spin_rad), tip_rad=float(tip_rad))
