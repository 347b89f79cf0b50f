"""The trials of Robust DR (Jin et al., WCNC 2011, section V): two pocket phones on a path through a laboratory."""

from dataclasses import replace

import numpy as np

from pdr_est.frames import Array
from pdr_est.simulate.carrying.pocket_phone import PocketPhone
from pdr_est.simulate.people.person import SimulatedPerson, sample_person
from pdr_est.simulate.scenario import DeviceParams, Scenario
from pdr_est.simulate.sensors.magnetic_field import scatter_dipoles
from pdr_est.simulate.sensors.sensor_errors import PHONE_MAGNETOMETER, SensorParams
from pdr_est.simulate.walk import SimulatedWalk
from pdr_est.simulate.walker.walking_body import Side
from pdr_est.simulate.walker.walking_path import PathParams, WalkingPath

ROBUST_DR_TRIALS = 10

_LENGTH_M = 90.0
# The waypoints in the order of passing, in units of the grid of aisles: ten places, each passed twice or thrice.
_FIRST_LAP = ((0, 0), (1, 0), (1, 1), (2, 1), (2, 0), (3, 0), (3, 2), (2, 2), (2, 1), (1, 1), (1, 2), (0, 2))
_SECOND_LAP = ((0, 0), (1, 0), (2, 0), (3, 0), (3, 2), (2, 2), (1, 2), (0, 2))
_ROUTE = (*_FIRST_LAP, *_SECOND_LAP, (1, 1), (2, 1))
_CORNER_BEFORE_LAST_AISLE = (0, 1)  # of no waypoint
_CADENCE = 0.75  # of the usual one: the paper's 90 m take about 2 minutes
_IRON_SPACING_M = 3.0  # "numerous desktop computers and metal cabinets": closer than in the corridors of PSP
_HARD_IRON_UT = 3.0  # what the phone's own calibration leaves, as in the walks of PSP
# Hard iron of trials with opposed compasses. Of the left phone, uT along each level axis of the body, a quarter of
# the Earth's level field; the angle, rad, and the logarithm of the factor between it and the opposite of the other.
# Ours.
_OPPOSED_UT, _OPPOSED_RAD, _OPPOSED_LOG_RATIO = 5.0, 0.5, 0.5


def robust_dr_trials(
    seed: int = 0, trials: int = ROBUST_DR_TRIALS, opposed_compasses: bool = False
) -> tuple[Scenario, ...]:
    """Make the trials of section V, each of another person; more trials leave the first ones as they are.

    A laboratory of 14 m by 10 m has aisles between its benches. 90 m of them are walked in about 2 minutes, with
    turns to both sides; ten waypoints are passed 22 times (`waypoint_passes`). Figure 2 is not in the text that we
    have: the path is ours. One phone is in the left and one in the right trouser pocket, each put in a little
    differently. They sample at 24 to 25 Hz. Their clocks agree at the start, as those of the paper do by messages,
    and the right one runs faster or slower by 20 ppm. Magnetised bodies stand beside the path every 3 m. The phones
    also have a gyroscope, which the paper's had not, because our front end needs one to know what is level. All
    errors are those of the simulated phones; none is set for the sake of the paper's figure.

    The paper's two phones err in opposite senses in the trials that it shows. With `opposed_compasses` so do those
    here. Iron that goes along in the left pocket disturbs that compass by a level field with a standard deviation of
    5 uT forward and to the left, in axes of the body. The field in the right pocket is the opposite one, turned by an
    angle of 0.5 rad (standard deviation) and multiplied by exp(0.5 n), where n is standard normal: the errors are
    about equal in some trials and very different in others. Which way a phone errs changes with the walking
    direction, and the other phone errs the other way. Everything else is as in the trials without.

    Parameters
    ----------
    seed : int
        Seed of people, magnetised bodies and sensors.
    trials : int
        Number of trials.
    opposed_compasses : bool
        True for compasses that are disturbed in opposite senses.
    """
    plain = [_trial(seed, number) for number in range(trials)]
    if not opposed_compasses:
        return tuple(plain)
    return tuple(_opposed(trial, seed, number) for number, trial in enumerate(plain))


def waypoint_passes(walk: SimulatedWalk) -> tuple[Array, Array]:
    """Find when the walker was nearest to each waypoint.

    Returns
    -------
    time_s : Array
        True times of the passes, (22,), s.
    position_m : Array
        True positions at these times, (22, 2), m.
    """
    path = WalkingPath(walk.scenario.path)
    along_m = np.arange(0.0, path.length_m, 0.01)
    line = path.at(along_m).position_m
    grid_m = float(np.max(walk.scenario.path.vertices_m)) / float(np.max(_corners()))
    line_m = np.cumsum([0.0, *(np.abs(np.diff(_corners(), axis=0)).sum(axis=1))])
    nearest = []
    for k, (x, y) in enumerate(_ROUTE):
        expected_m = line_m[_row_of(k)] * path.length_m / line_m[-1]
        rows = np.flatnonzero(np.abs(along_m - expected_m) < 0.5 * grid_m)
        away_m = np.hypot(*(line[rows] - grid_m * np.array([x, y])).T)
        nearest.append(along_m[rows[np.argmin(away_m)]])
    time_s = np.maximum(walk.body.time_at(np.array(nearest)), 0.0)  # the first one is the start
    return time_s, walk.position_at(time_s)


def _row_of(number: int) -> int:
    """Find the row of a waypoint pass among the corners."""
    return number + (number >= len(_ROUTE) - 2)


def _corners() -> Array:
    """List the route with its corner that is no waypoint, (23, 2), in units of the grid."""
    return np.array([*_ROUTE[:-2], _CORNER_BEFORE_LAST_AISLE, *_ROUTE[-2:]], dtype=np.float64)


def _path() -> PathParams:
    """Make the path without the points in the middle of straight parts, enlarged to the paper's length."""
    corners = _corners()
    legs = np.sign(np.diff(corners, axis=0))
    bends = [0, *(1 + np.flatnonzero(np.any(legs[1:] != legs[:-1], axis=1))), len(corners) - 1]
    grid_m = _LENGTH_M / float(np.abs(np.diff(corners, axis=0)).sum())
    for _ in range(3):  # rounded corners are shorter
        path = PathParams(vertices_m=tuple((grid_m * x, grid_m * y) for x, y in corners[bends].tolist()))
        grid_m *= _LENGTH_M / WalkingPath(path).length_m
    return path


def _trial(seed: int, number: int) -> Scenario:
    """Make one trial."""
    rng = np.random.default_rng([seed, 5, number])
    person = sample_person(rng)
    gait = replace(person.gait, cadence_hz=_CADENCE * person.gait.cadence_hz)
    path = _path()
    return Scenario(
        name=f"robust_dr_trial_{number + 1:02d}",
        path=path,
        gait=gait,
        body=person.body,
        devices=(_phone("left", person, rng), _phone("right", person, rng)),
        irons=scatter_dipoles(WalkingPath(path), _IRON_SPACING_M, int(rng.integers(2**31))),
        seed=int(rng.integers(2**31)),
    )


def _opposed(trial: Scenario, seed: int, number: int) -> Scenario:
    """Put iron into both pockets that disturbs the compasses in opposite senses."""
    rng = np.random.default_rng([seed, 6, number])
    left = complex(*(_OPPOSED_UT * rng.standard_normal(2)))
    right = -left * np.exp(_OPPOSED_LOG_RATIO * rng.standard_normal() + 1j * _OPPOSED_RAD * rng.standard_normal())
    devices = tuple(_disturbed(device, field) for device, field in zip(trial.devices, (left, right), strict=True))
    return replace(trial, name=f"{trial.name}_opposed", devices=devices)


def _disturbed(device: DeviceParams, field_ut: complex) -> DeviceParams:
    """Add a field, forward + 1j left in axes of the body, to what the magnetometer of a pocket phone shows."""
    carry, magnetometer = device.carry, device.sensors.magnetometer
    if not isinstance(carry, PocketPhone) or magnetometer is None:
        return device
    x, y, z = carry.mount().inv().apply([field_ut.real, field_ut.imag, 0.0]).tolist()
    return replace(device, sensors=replace(device.sensors, magnetometer=replace(magnetometer, bias=(x, y, z))))


def _phone(side: Side, person: SimulatedPerson, rng: np.random.Generator) -> DeviceParams:
    """Put a phone into that pocket; the trousers decide where the screen points, the hand how it was put in."""
    pocket = person.pocket
    facing_rad = pocket.facing_rad if pocket.side == side else -pocket.facing_rad
    put_rad = np.array([0.15, 0.1, 0.05]) * rng.standard_normal(3)
    sensors = SensorParams(
        rate_hz=float(rng.uniform(24.0, 25.0)),
        magnetometer=replace(PHONE_MAGNETOMETER, bias_std=_HARD_IRON_UT),
        clock_skew=float(2e-5 * rng.choice([-1.0, 1.0])) if side == "right" else 0.0,
    )
    carry = replace(
        pocket,
        side=side,
        facing_rad=facing_rad + float(put_rad[0]),
        spin_rad=pocket.spin_rad + float(put_rad[1]),
        tip_rad=pocket.tip_rad + float(put_rad[2]),
    )
    return DeviceParams(name=side, carry=carry, sensors=sensors)
