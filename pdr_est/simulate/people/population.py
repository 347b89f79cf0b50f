"""Many walks of many people: drawn from a seed, each with a path, a walker and phones of its own."""

from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np
from annotated_types import Ge, Le, Len

from pdr_est.params import params
from pdr_est.simulate.people.carried_device import carried_device
from pdr_est.simulate.people.person import SimulatedPerson, sample_person
from pdr_est.simulate.scenario import DeviceParams, Scenario
from pdr_est.simulate.sensors.sensor_errors import PHONE_MAGNETOMETER, SensorParams
from pdr_est.simulate.walker.step_schedule import mean_speed_mps
from pdr_est.simulate.walker.walking_path import PathParams
from pdr_est.types.steps import CarryingMode

CarryingName = Literal["HOLDING", "SWING", "POCKET"]
CarryingOrder = Annotated[tuple[CarryingName, ...], Len(1)]

_LEG_M = (8.0, 28.0)  # corridors of office buildings, our choice
_STRAIGHT_ON = 0.2  # share of the corners that bend by 45 degrees only
_PERSON, _WALK = 0, 1  # purposes of random numbers


@params
class PopulationParams:
    """Parameters of a population of simulated walks."""

    number: Annotated[int, Ge(1), Le(100_000)] = 12
    """Number of walks."""
    people: Annotated[int, Ge(1), Le(10_000)] = 6
    """Number of people, who take turns in walking."""
    duration_s: Annotated[float, Ge(20.0), Le(36_000.0)] = 60.0
    """Approximate duration of each walk, s."""
    carrying: Annotated[tuple[CarryingOrder, ...], Len(1)] = (("HOLDING",),)
    """Carrying modes of the phone, one after the other and changed at equal times; the walks take the entries in
    turn.
    """
    second_phone: CarryingOrder | None = None
    """Carrying modes of a second phone, the same in all walks; null for walks with one phone."""
    magnetometer: bool = False
    """Record the magnetic field."""
    record_attitude: bool = False
    """Record the phones' own attitude."""
    rate_hz: Annotated[float, Ge(25.0), Le(500.0)] = 100.0
    """Sampling rate, Hz."""
    seed: Annotated[int, Ge(0)] | None = None
    """Seed of the population; null takes that of the experiment."""


@dataclass(frozen=True)
class PopulationWalk:
    """One walk of a population.

    Attributes
    ----------
    scenario : Scenario
        Parameters of the walk.
    person : int
        Number of the walker, counted from 1.
    carrying : tuple of str
        Carrying modes of the first phone, in order of time.
    """

    scenario: Scenario
    person: int
    carrying: tuple[CarryingName, ...]


def sample_population(parameters: PopulationParams, seed: int = 0) -> tuple[PopulationWalk, ...]:
    """Draw the walks of a population.

    Each walk depends on the seed and its own number only, so that more walks leave the first ones as they are.

    Parameters
    ----------
    parameters : PopulationParams
        Number and kind of the walks.
    seed : int
        Seed where the parameters have none.

    Returns
    -------
    tuple of PopulationWalk
        Walks in order of their number.
    """
    chosen = seed if parameters.seed is None else parameters.seed
    return tuple(_member(parameters, chosen, number) for number in range(parameters.number))


def _member(parameters: PopulationParams, seed: int, number: int) -> PopulationWalk:
    """Draw one walk."""
    who = number % parameters.people
    person = sample_person(np.random.default_rng([seed, _PERSON, who]))
    rng = np.random.default_rng([seed, _WALK, number])
    carrying = parameters.carrying[number % len(parameters.carrying)]
    orders = [carrying] if parameters.second_phone is None else [carrying, parameters.second_phone]
    names = ["device"] if len(orders) == 1 else ["phone1", "phone2"]
    walking_s = parameters.duration_s - person.gait.lead_in_s - person.gait.lead_out_s
    scenario = Scenario(
        name=f"walk_{number + 1:04d}",
        path=_corridors(walking_s * mean_speed_mps(person.gait), rng),
        gait=person.gait,
        body=person.body,
        devices=tuple(_phone(parameters, person, *phone, rng) for phone in zip(names, orders, strict=True)),
        seed=int(rng.integers(2**31)),
    )
    return PopulationWalk(scenario, who + 1, carrying)


def _corridors(length_m: float, rng: np.random.Generator) -> PathParams:
    """Draw corridors with corners of 90 and sometimes 45 degrees, to the left as often as to the right."""
    point, heading = np.zeros(2), 0.0
    vertices, left_m = [(0.0, 0.0)], length_m
    while left_m > 0.0:
        leg_m = rng.uniform(*_LEG_M)
        if left_m - leg_m < _LEG_M[0]:
            leg_m = left_m  # no leg too short for its corner
        point = point + leg_m * np.array([np.cos(heading), np.sin(heading)])
        vertices.append((float(point[0]), float(point[1])))
        left_m -= leg_m
        turn = np.pi / 4.0 if rng.random() < _STRAIGHT_ON else np.pi / 2.0
        heading += turn * rng.choice([-1.0, 1.0])
    return PathParams(vertices_m=tuple(vertices))


def _phone(
    parameters: PopulationParams, person: SimulatedPerson, name: str, order: CarryingOrder, rng: np.random.Generator
) -> DeviceParams:
    walking_s = parameters.duration_s - person.gait.lead_in_s - person.gait.lead_out_s
    starts_s = person.gait.lead_in_s + walking_s * np.arange(1, len(order)) / len(order)
    sensors = SensorParams(
        rate_hz=parameters.rate_hz,
        magnetometer=PHONE_MAGNETOMETER if parameters.magnetometer else None,
        record_attitude=parameters.record_attitude,
    )
    return carried_device(person, [CarryingMode[mode] for mode in order], starts_s.tolist(), rng, sensors, name)
