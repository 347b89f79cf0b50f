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
PspLegs = Literal["paper", "planar", "circling"]
PSP_TESTS = 25  # a trajectory: 50 tests in all
PSP_GYROSCOPE_BIAS_RADPS = float(np.deg2rad(0.14))
"""Size of the bias of the one phone's gyroscope, rad/s, with which the bare gyroscope errs as the paper's does."""

_PEOPLE = 5
_LENGTH_M: dict[PspTrajectory, float] = {"I": 204.0, "II": 290.0}
_DEPTH_M: dict[PspTrajectory, float] = {"I": 12.0, "II": 25.0}
_LAPS, _CIRCLE_RADIUS_M, _CIRCLE_CORNERS = 5, 4.0, 72
_CORNER_RADIUS_M = 0.8
_COMBINATIONS: tuple[tuple[Side, bool], ...] = (("left", True), ("left", False), ("right", True), ("right", False))
# Android gives the field less the hard iron that it knows; a few uT are left. Ours.
_SENSORS = SensorParams(rate_hz=100.0, magnetometer=replace(PHONE_MAGNETOMETER, bias_std=3.0))
_IRON_SPACING_M = 5.0
# Legs "paper": swing of the phone with the thigh, rad, relative range between people, and lean as it is put in, rad.
_SWING_RAD, _SWING_RANGE, _LEAN_RAD = 0.22, 0.1, float(np.deg2rad(2.0))
_OTHER_LEAN_RAD = float(np.deg2rad(5.0))


def psp_walks(
    trajectory: PspTrajectory,
    tests: int = PSP_TESTS,
    seed: int = 0,
    legs: PspLegs = "paper",
    gyroscope_bias_radps: float = PSP_GYROSCOPE_BIAS_RADPS,
) -> tuple[Scenario, ...]:
    """Make the tests of PSP on one trajectory.

    The paper has 50 tests of five people on two trajectories and does not tell which. Here each person walks both
    ways round with the phone in either pocket, 20 tests, and one of these four a second time, with the phone put in
    anew: 25. Any five tests in a row are of the five people. The walk starts with a straight part to the east, which
    is a direction of the building. The phone stands nearly straight, upper edge up, and is recorded at 100 Hz with
    its magnetometer.

    Legs "paper" are such that the bare gyroscope errs as the paper's own line says, 10.07 % of the way on trajectory
    I and 7.62 % on II, in the mean over many tests; this was fitted with seeds 101 to 104, which give 10.2 and 7.4
    %. The phone swings by 0.22 rad forward and back (10 % more or less from person to person), in a plane, and leans
    by 2 degrees (standard deviation each way). Its y axis then shows 98 % of a turn; in three pockets of OxIOD it
    shows 97 to 98 %. All else of the pocket, jolts and unrest, is that of `sample_person`, which was fitted to real
    pockets.

    All tests of a seed are made with one phone, as those of the paper. Its gyroscope has a bias of 0.14 degrees per
    second about each axis, whose signs are drawn; each test adds a bias of its own, drawn as `SensorParams` says.

    Parameters
    ----------
    trajectory : {"I", "II"}
        Trajectory of the paper.
    tests : int
        Number of tests, the first ones of the 25.
    seed : int
        Seed of the people, the magnetised bodies in the building, and the sensors.
    legs : {"paper", "planar", "circling"}
        Swing of the phone: that of the paper's gyroscope; that of `sample_person`, but in a plane; or all of it,
        which circles, and turns the phone about its long axis on and on. The last two lean by 5 degrees.
    gyroscope_bias_radps : float
        Size of the bias of the phone's gyroscope about each axis, rad/s.
    """
    people = [sample_person(np.random.default_rng([seed, 3, number])) for number in range(_PEOPLE)]
    signs = np.random.default_rng([seed, 8]).choice([-1.0, 1.0], 3)
    bias_radps = tuple(float(sign) * gyroscope_bias_radps for sign in signs)
    sensors = replace(_SENSORS, gyroscope=replace(_SENSORS.gyroscope, bias=bias_radps))
    walkers = [(person, _swing_rad(seed, number)) for number, person in enumerate(people)]
    return tuple(
        _walk(trajectory, *walkers[number % _PEOPLE], number, seed, legs, sensors) for number in range(tests)
    )


def psp_path(trajectory: PspTrajectory, clockwise: bool) -> PathParams:
    """Make a closed path of 204.0 m (I) or 290.0 m (II), that begins to the east.

    Fig. 3 is not in the text that we have. I is a rectangle 12 m deep and about 90 m long, from a corner. II is one
    of about 58 m by 25 m, from the middle of a side; in the middle of the side across from the start the walker goes
    round a circle of 4 m radius five times, turning as the rectangle does. In a stride he turns by 20 degrees there,
    above the threshold of eq. 2, as he must for the paper's statement that HDE suspends its action on the circle. The
    gyroscope's bias that gives the paper's error on trajectory I is the smaller, the farther from its start the path
    goes.
    """
    make = _from_corner if trajectory == "I" else _with_circle
    guess = make(_DEPTH_M[trajectory], 40.0)
    path = make(_DEPTH_M[trajectory], 40.0 + (_LENGTH_M[trajectory] - WalkingPath(guess).length_m) / 2.0)
    return replace(path, vertices_m=tuple((x, -y) for x, y in path.vertices_m)) if clockwise else path


def _from_corner(depth_m: float, width_m: float) -> PathParams:
    """Make the path counter-clockwise around a rectangle from its south-west corner."""
    corners = ((0.0, 0.0), (width_m, 0.0), (width_m, depth_m), (0.0, depth_m), (0.0, 0.0))
    return PathParams(vertices_m=corners, corner_radii_m=(_CORNER_RADIUS_M,) * 3)


def _with_circle(depth_m: float, width_m: float) -> PathParams:
    """Make the path counter-clockwise around a rectangle from the middle of its south side, with the circle."""
    half_m = 0.5 * width_m
    before = ((0.0, 0.0), (half_m, 0.0), (half_m, depth_m))
    after = ((-half_m, depth_m), (-half_m, 0.0), (0.0, 0.0))
    circle = _circle(depth_m)
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


def _swing_rad(seed: int, number: int) -> float:
    """Draw the swing of the phone of a person with legs "paper"."""
    return _SWING_RAD * (1.0 + np.random.default_rng([seed, 7, number]).uniform(-_SWING_RANGE, _SWING_RANGE))


def _walk(
    trajectory: PspTrajectory,
    person: SimulatedPerson,
    swing_rad: float,
    number: int,
    seed: int,
    legs: PspLegs,
    sensors: SensorParams,
) -> Scenario:
    """Make one test of a person."""
    who = number % _PEOPLE
    side, clockwise = _COMBINATIONS[(number // _PEOPLE + who) % len(_COMBINATIONS)]
    rng = np.random.default_rng([seed, 4, int(trajectory == "II"), number])
    path = psp_path(trajectory, clockwise)
    carry = _pocketed(person, side, _LEAN_RAD if legs == "paper" else _OTHER_LEAN_RAD, rng)
    device = DeviceParams(carry=_swung(carry, legs, swing_rad), sensors=sensors)
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


def _pocketed(person: SimulatedPerson, side: Side, lean_rad: float, rng: np.random.Generator) -> PocketPhone:
    """Put the phone nearly straight into that pocket of the person; the trousers decide where the screen points."""
    facing_rad = person.pocket.facing_rad if person.pocket.side == side else -person.pocket.facing_rad
    spin_rad, tip_rad = lean_rad * rng.standard_normal(2)
    return replace(person.pocket, side=side, facing_rad=facing_rad, spin_rad=float(spin_rad), tip_rad=float(tip_rad))


def _swung(carry: PocketPhone, legs: PspLegs, swing_rad: float) -> PocketPhone:
    """Swing the phone as these legs do."""
    if legs == "circling":
        return carry
    planar = replace(carry, twist_rad=0.0, spread_rad=0.0)
    return planar if legs == "planar" else replace(planar, amplitude_rad=swing_rad)
