"""The walks of MMPDR: straight ones with free mode changes, an office corridor, and a path through a park."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from pdr_est.errors import ConfigError
from pdr_est.simulate.people.carried_device import carried_device
from pdr_est.simulate.people.person import SimulatedPerson, sample_person
from pdr_est.simulate.scenario import Scenario
from pdr_est.simulate.sensors.sensor_errors import SensorParams
from pdr_est.simulate.walker.step_schedule import mean_speed_mps
from pdr_est.simulate.walker.walking_path import PathParams, WalkingPath
from pdr_est.types.steps import CarryingMode

MMPDR_PEOPLE, MMPDR_CHANGES = 17, 106  # MMPDR section IV-B

_SENSORS = SensorParams(rate_hz=50.0)  # section III-A
_CLEAR_CORRIDOR_M = ((0.0, 0.0), (45.0, 0.0), (45.0, 5.0), (73.0, 5.0), (73.0, 0.0), (86.3, 0.0))
# where the changes are, by the number of modes
_CLEAR_OF_CORNERS_M = {1: (), 2: (22.0,), 3: (22.0, 63.0), 4: (12.0, 31.0, 63.0)}
_SINGLE_MODE_FROM_M = 3.0
_PAPER_HABIT = 0.022
_MODES = (CarryingMode.HOLDING, CarryingMode.SWING, CarryingMode.POCKET)


def mmpdr_mode_walks(people: int = MMPDR_PEOPLE, seed: int = 0) -> tuple[Scenario, ...]:
    """Make the walks of MMPDR section IV-B: each person walks 80 m straight and changes the carrying mode freely.

    They start in HOLDING; 17 people make 106 changes in all, as in the paper, each after at least 4 s in a mode.

    Parameters
    ----------
    people : int
        Number of people, one walk each.
    seed : int
        Seed of the people and of their mode changes.
    """
    rng = np.random.default_rng([seed, people])
    return tuple(
        _mode_walk(number, MMPDR_CHANGES * (number + 1) // MMPDR_PEOPLE - MMPDR_CHANGES * number // MMPDR_PEOPLE, rng)
        for number in range(people)
    )


def mmpdr_indoor(*modes: CarryingMode, seed: int = 0) -> Scenario:
    """Make a walk along the corridor of MMPDR section IV-D: 96.33 m, 45 m straight at first, 4 turns of 90 degrees.

    The walker is drawn with the seed, except for height and gender, which are those of the paper's first walks.

    Parameters
    ----------
    *modes : CarryingMode
        HOLDING, SWING or POCKET in order of time, changed at equal distances. The walks of Table VIII have one mode,
        those of Table IX for example (HOLDING, SWING, HOLDING, POCKET). Without any, HOLDING.
    seed : int
        Seed of the walker and the sensors.

    Raises
    ------
    ConfigError
        For another mode.
    """
    rng = np.random.default_rng([seed, 1])
    person = sample_person(rng)
    person = replace(person, gait=replace(person.gait, height_m=1.73, gender="male"))
    corridor = PathParams(vertices_m=((0.0, 0.0), (45.0, 0.0), (45.0, 14.0), (60.0, 14.0), (60.0, 6.0), (75.0, 6.0)))
    order = modes or (CarryingMode.HOLDING,)
    name = "_".join(["mmpdr_indoor", *(mode.name.lower() for mode in order)])
    return _evenly_changed(name, _scaled(corridor, 96.33), person, order, rng, seed)


def mmpdr_published(*modes: CarryingMode, seed: int = 0) -> Scenario:
    """Make a walk of MMPDR section IV-D under the paper's own assumptions, for its Tables VIII to X.

    It differs from `mmpdr_indoor` in what the paper's method takes for granted:

    * Every walk begins with the phone held in front. In a walk of one other mode it is put there 3 m behind the
      start.
    * Changes of the mode are at least 10 m away from every corner. The corridor of 96.33 m therefore has other legs
      behind the first 45 m; they are ours in both walks, since the paper gives no lengths.
    * The walker's steps are as near to eq. 9 as those of the paper's people. The distances and counts of the nine
      walks in its Tables VIII and IX give factors of 0.958 to 1.031, standard deviation 0.022.

    Parameters
    ----------
    *modes : CarryingMode
        Up to four of HOLDING, SWING or POCKET in order of time; several begin with HOLDING. Without any, HOLDING.
    seed : int
        Seed of the walker and the sensors; the walker is that of `mmpdr_indoor`.

    Raises
    ------
    ConfigError
        For another mode, too many of them, or several that do not begin with HOLDING.
    """
    rng = np.random.default_rng([seed, 1])
    person = sample_person(rng)
    habit = 1.0 + _PAPER_HABIT * float(np.clip(rng.standard_normal(), -2.5, 2.5))
    person = replace(person, gait=replace(person.gait, height_m=1.73, gender="male", length_habit=habit))
    order = modes or (CarryingMode.HOLDING,)
    name = "_".join(["mmpdr_published", *(mode.name.lower() for mode in order)])
    single = len(order) == 1 and order[0] is not CarryingMode.HOLDING
    carried = (CarryingMode.HOLDING, *order) if single else order
    if carried[0] is not CarryingMode.HOLDING or len(order) not in _CLEAR_OF_CORNERS_M:
        raise ConfigError(f"{name}: the walk has up to four modes and begins HOLDING: put HOLDING first")
    places_m = (_SINGLE_MODE_FROM_M,) if single else _CLEAR_OF_CORNERS_M[len(order)]
    starts_s = person.gait.lead_in_s + np.array(places_m) / mean_speed_mps(person.gait)
    device = carried_device(person, carried, starts_s.tolist(), rng, _SENSORS)
    path = _scaled(PathParams(vertices_m=_CLEAR_CORRIDOR_M), 96.33)
    return Scenario(name=name, path=path, gait=person.gait, body=person.body, devices=(device,), seed=seed)


def park_348(*modes: CarryingMode, seed: int = 0) -> Scenario:
    """Make a walk along a closed park path of 348 m that bends both ways all along, as in MMPDR Fig. 15.

    The walker is drawn with the seed, and walks as briskly as the paper's, who took 4 minutes.

    Parameters
    ----------
    *modes : CarryingMode
        As for `mmpdr_indoor`; without any HOLDING, SWING, POCKET, in the order of the paper.
    seed : int
        Seed of the walker and the sensors.
    """
    rng = np.random.default_rng([seed, 2])
    person = sample_person(rng)
    person = replace(person, gait=replace(person.gait, height_m=1.73, gender="male", cadence_hz=458.0 / 240.0))
    garden = PathParams(vertices_m=_garden_path(), corner_radius_m=3.0)
    return _evenly_changed("park_348", _scaled(garden, 348.0), person, modes or _MODES, rng, seed)


def _garden_path() -> tuple[tuple[float, float], ...]:
    """Draw a closed line with bays, through points at equal distances."""
    angle = np.linspace(0.0, 2.0 * np.pi, 2001)
    radius_m = 45.0 * (1.0 + 0.22 * np.cos(2.0 * angle + 0.5) + 0.13 * np.cos(5.0 * angle))
    line = np.stack([radius_m * np.cos(angle), radius_m * np.sin(angle)])
    along_m = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line)))])
    points_m = np.linspace(0.0, along_m[-1], 41)
    east, north = (np.interp(points_m, along_m, coordinate) for coordinate in line)
    return tuple((float(x), float(y)) for x, y in zip(east, north, strict=True))


def _evenly_changed(
    name: str,
    path: PathParams,
    person: SimulatedPerson,
    order: Sequence[CarryingMode],
    rng: np.random.Generator,
    seed: int,
) -> Scenario:
    """Make a walk in some modes, one after the other, each for about the same distance."""
    duration_s = WalkingPath(path).length_m / mean_speed_mps(person.gait)
    starts_s = person.gait.lead_in_s + duration_s * np.arange(1, len(order)) / len(order)
    device = carried_device(person, order, starts_s.tolist(), rng, _SENSORS)
    return Scenario(name=name, path=path, gait=person.gait, body=person.body, devices=(device,), seed=seed)


def _mode_walk(number: int, changes: int, rng: np.random.Generator) -> Scenario:
    """Make one walk of section IV-B with that number of mode changes."""
    person = sample_person(rng)
    duration_s = 80.0 / mean_speed_mps(person.gait)
    apart_s = (duration_s - 9.0) / changes
    starts_s = person.gait.lead_in_s + 4.0 + apart_s * (np.arange(changes) + rng.uniform(0.0, 0.35, changes))
    order = [CarryingMode.HOLDING]
    for _ in range(changes):
        order.append(rng.choice([mode for mode in _MODES if mode != order[-1]]))
    return Scenario(
        name=f"mmpdr_mode_walk_{number + 1:02d}",
        path=PathParams(vertices_m=((0.0, 0.0), (80.0, 0.0))),
        gait=person.gait,
        body=person.body,
        devices=(carried_device(person, order, starts_s.tolist(), rng, _SENSORS),),
        seed=int(rng.integers(2**31)),
    )


def _scaled(path: PathParams, length_m: float) -> PathParams:
    """Enlarge the path about the origin to a length; the corners keep their radius and what they cut off."""
    legs_m = float(np.hypot(*np.diff(np.array(path.vertices_m), axis=0).T).sum())
    scale = 1.0 + (length_m - WalkingPath(path).length_m) / legs_m
    return replace(path, vertices_m=tuple((scale * east, scale * north) for east, north in path.vertices_m))
