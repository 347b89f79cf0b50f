"""Named scenarios: simple walks, and the set-ups of the papers' experiments."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from difflib import get_close_matches
from itertools import pairwise
from types import MappingProxyType

import numpy as np

from pdr_est.errors import ConfigError
from pdr_est.simulate.carrying.mode_changes import AnyPhone
from pdr_est.simulate.people.person import Person, sample_person
from pdr_est.simulate.scenario import DeviceParams, Scenario
from pdr_est.simulate.sensors.errors import SensorParams
from pdr_est.simulate.walker.path import Path, PathParams
from pdr_est.simulate.walker.step_schedule import GaitParams, Pause, usual_speed_mps
from pdr_est.types.steps import CarryingMode

MMPDR_PEOPLE, MMPDR_CHANGES = 17, 106  # MMPDR section IV-B

_MMPDR_SENSORS = SensorParams(rate_hz=50.0)  # section III-A
_MODES = (CarryingMode.HOLDING, CarryingMode.SWING, CarryingMode.POCKET)
_RECTANGLE = ((0.0, 0.0), (24.0, 0.0), (24.0, 28.0), (-24.0, 28.0), (-24.0, 0.0), (0.0, 0.0))


def mmpdr_mode_walks(people: int = MMPDR_PEOPLE, seed: int = 0) -> tuple[Scenario, ...]:
    """The walks of MMPDR section IV-B: each of some people walks 80 m straight and changes the mode freely.

    They start HOLDING; 17 people make 106 changes in all, as in the paper, each after at least 4 s in a mode.
    """
    rng = np.random.default_rng([seed, people])
    return tuple(
        _mode_walk(number, MMPDR_CHANGES * (number + 1) // MMPDR_PEOPLE - MMPDR_CHANGES * number // MMPDR_PEOPLE, rng)
        for number in range(people)
    )


def mmpdr_indoor(*modes: CarryingMode, seed: int = 0) -> Scenario:
    """The corridor of MMPDR section IV-D: 96.33 m, 45 m straight at first, with 4 turns of 90 degrees.

    modes: HOLDING, SWING, POCKET in the order of carrying, changed at equal distances: one for the walks of Table
    VIII, (HOLDING, SWING, HOLDING, POCKET) for example for those of Table IX; none means HOLDING. The walker is
    drawn with the seed, but for height and gender of the first walks. Raise ConfigError for another mode.
    """
    rng = np.random.default_rng([seed, 1])
    person = sample_person(rng)
    person = replace(person, gait=replace(person.gait, height_m=1.73, gender="male"))
    corridor = PathParams(vertices_m=((0.0, 0.0), (45.0, 0.0), (45.0, 14.0), (60.0, 14.0), (60.0, 6.0), (75.0, 6.0)))
    order = modes or (CarryingMode.HOLDING,)
    name = "_".join(["mmpdr_indoor", *(mode.name.lower() for mode in order)])
    return _evenly_changed(name, _scaled(corridor, 96.33), person, order, rng, seed)


def park_348(*modes: CarryingMode, seed: int = 0) -> Scenario:
    """A closed park path of 348 m that bends both ways all along, as that of MMPDR Fig. 15.

    modes: as of `mmpdr_indoor`; none means HOLDING, SWING, POCKET, in the order of the paper. The walker is drawn
    with the seed, and walks as briskly as the paper's, who took 4 minutes.
    """
    rng = np.random.default_rng([seed, 2])
    person = sample_person(rng)
    person = replace(person, gait=replace(person.gait, height_m=1.73, gender="male", cadence_hz=458.0 / 240.0))
    garden = PathParams(vertices_m=_garden_path(), corner_radius_m=3.0)
    return _evenly_changed("park_348", _scaled(garden, 348.0), person, modes or _MODES, rng, seed)


def _garden_path() -> tuple[tuple[float, float], ...]:
    """A closed line with bays, through points at equal distances."""
    angle = np.linspace(0.0, 2.0 * np.pi, 2001)
    radius_m = 45.0 * (1.0 + 0.22 * np.cos(2.0 * angle + 0.5) + 0.13 * np.cos(5.0 * angle))
    line = np.stack([radius_m * np.cos(angle), radius_m * np.sin(angle)])
    along_m = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line)))])
    points_m = np.linspace(0.0, along_m[-1], 41)
    east, north = (np.interp(points_m, along_m, coordinate) for coordinate in line)
    return tuple((float(x), float(y)) for x, y in zip(east, north, strict=True))


def _evenly_changed(
    name: str, path: PathParams, person: Person, order: Sequence[CarryingMode], rng: np.random.Generator, seed: int
) -> Scenario:
    """A walk in some modes, one after the other, each for the same distance about."""
    duration_s = Path(path).length_m / usual_speed_mps(person.gait)
    starts_s = person.gait.lead_in_s + duration_s * np.arange(1, len(order)) / len(order)
    device = carried_device(person, order, starts_s.tolist(), rng)
    return Scenario(name=name, path=path, gait=person.gait, body=person.body, devices=(device,), seed=seed)


def _mode_walk(number: int, changes: int, rng: np.random.Generator) -> Scenario:
    person = sample_person(rng)
    duration_s = 80.0 / usual_speed_mps(person.gait)
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
        devices=(carried_device(person, order, starts_s.tolist(), rng),),
        seed=int(rng.integers(2**31)),
    )


def carried_device(
    person: Person,
    order: Sequence[CarryingMode],
    starts_s: Sequence[float],
    rng: np.random.Generator,
    sensors: SensorParams = _MMPDR_SENSORS,
    name: str = "device",
) -> DeviceParams:
    """A phone in some modes, one after the other; starts_s: when the change to each mode after the first begins.

    Raise ConfigError for a mode that is not simulated.
    """
    carries = [_carry(person, mode) for mode in order]
    changes = [
        person.change(before, carry, start_s, rng)
        for (before, carry), start_s in zip(pairwise(carries), starts_s, strict=True)
    ]
    return DeviceParams(name=name, carry=carries[0], changes=tuple(changes), sensors=sensors)


def _carry(person: Person, mode: CarryingMode) -> AnyPhone:
    carries: dict[CarryingMode, AnyPhone] = {
        CarryingMode.HOLDING: person.held,
        CarryingMode.SWING: person.swing,
        CarryingMode.POCKET: person.pocket,
    }
    if mode not in carries:
        raise ConfigError(f"carrying mode {mode!r} is not simulated: there are HOLDING, SWING and POCKET")
    return carries[mode]


def _scaled(path: PathParams, length_m: float) -> PathParams:
    """The path enlarged about the origin to a length; the corners keep their radius and what they cut off."""
    legs_m = float(np.hypot(*np.diff(np.array(path.vertices_m), axis=0).T).sum())
    scale = 1.0 + (length_m - Path(path).length_m) / legs_m
    return replace(path, vertices_m=tuple((scale * east, scale * north) for east, north in path.vertices_m))


PRESETS: Mapping[str, Scenario] = MappingProxyType(
    {
        "office_loop": Scenario(
            name="office_loop",
            path=PathParams(vertices_m=_RECTANGLE),
            gait=GaitParams(pauses=(Pause(at_m=90.0, duration_s=6.0),)),
        ),
        "straight": Scenario(name="straight", path=PathParams(vertices_m=((0.0, 0.0), (80.0, 0.0)))),
        "l_shape": Scenario(name="l_shape", path=PathParams(vertices_m=((0.0, 0.0), (30.0, 0.0), (30.0, 20.0)))),
        "mmpdr_indoor_holding": mmpdr_indoor(CarryingMode.HOLDING),
        "mmpdr_indoor_swing": mmpdr_indoor(CarryingMode.SWING),
        "mmpdr_indoor_pocket": mmpdr_indoor(CarryingMode.POCKET),
        "mmpdr_indoor_multi": replace(
            mmpdr_indoor(CarryingMode.HOLDING, CarryingMode.SWING, CarryingMode.HOLDING, CarryingMode.POCKET),
            name="mmpdr_indoor_multi",
        ),
        "park_348": park_348(),
    }
)


def preset(name: str) -> Scenario:
    """The scenario of that name, one of PRESETS. Raise ConfigError for another name."""
    if name not in PRESETS:
        near = get_close_matches(name, PRESETS, n=1)
        hint = f"did you mean {near[0]}?" if near else f"there are {', '.join(PRESETS)}"
        raise ConfigError(f"no simulated walk is called {name!r}: {hint}")
    return PRESETS[name]
