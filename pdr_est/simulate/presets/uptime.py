"""Trips of UPTIME (Alzantot and Youssef 2012, section IV): 470 m on a campus, 623 m around houses, 95 m indoors."""

from dataclasses import replace
from typing import Literal

import numpy as np

from pdr_est.errors import ConfigError
from pdr_est.simulate.people.carried_device import carried_device
from pdr_est.simulate.people.person import sample_person
from pdr_est.simulate.scenario import Scenario
from pdr_est.simulate.sensors.sensor_errors import SensorParams
from pdr_est.simulate.walker.gait_stretches import GaitStretch, RunningStretch, StairStretch
from pdr_est.simulate.walker.step_schedule import Pause
from pdr_est.simulate.walker.walking_path import PathParams
from pdr_est.types.steps import CarryingMode

UptimeTrip = Literal["gaits", "compound", "building", "stairs"]

_JOG_MPS, _RUN_MPS = (2.4, 3.0), (3.8, 5.0)  # ours; Table II has 1.01 and 1.70 m a step, 2.8 and 5.2 m/s here
_COMPOUND = ((0.0, 0.0), (120.0, 0.0), (120.0, 90.0), (40.0, 90.0), (40.0, 194.15), (0.0, 194.15), (0.0, 0.0))
_BUILDING = ((0.0, 0.0), (32.0, 0.0), (32.0, 30.0), (0.0, 30.0), (0.0, 27.75))
_FLOOR = ((0.0, 0.0), (20.0, 0.0), (20.0, 4.1), (0.0, 4.1), (-10.0, 4.1))


def uptime_trip(trip: UptimeTrip, seed: int = 0, carrying: CarryingMode = CarryingMode.HOLDING) -> Scenario:
    """Make a trip of a random person.

    * `gaits`, figure 7: 470 m in different gaits with the phone in the hand. Jogged and run for 150 m, walked
      otherwise, with three stops so that it takes about the paper's 6.3 minutes.
    * `compound`, figure 8: 623 m around a residential compound, with two stretches of jogging.
    * `building`, figure 9: 95 m inside a building of 48 m by 45 m, walked.
    * `stairs`, not in the paper: a corridor, a flight up and down again, and a few metres jogged.

    The shapes of the paths are ours, because the figures are not in the text that we have, and so is where the gaits
    change.

    Parameters
    ----------
    trip : str
        Name of the trip.
    seed : int
        Seed of the person, of the speeds and of the walk.
    carrying : CarryingMode
        Carrying mode of the phone.

    Raises
    ------
    ConfigError
        For another trip, or a mode that is not simulated.
    """
    rng = np.random.default_rng([seed, 8])
    person = sample_person(rng)
    jog_mps, run_mps = float(rng.uniform(*_JOG_MPS)), float(rng.uniform(*_RUN_MPS))
    path, stretches, pauses = _plan(trip, jog_mps, run_mps)
    return Scenario(
        name=f"uptime_{trip}",
        path=path,
        gait=replace(person.gait, stretches=stretches, pauses=pauses),
        body=person.body,
        devices=(carried_device(person, [carrying], [], rng, SensorParams()),),
        seed=int(rng.integers(2**31)),
    )


def _plan(
    trip: UptimeTrip, jog_mps: float, run_mps: float
) -> tuple[PathParams, tuple[GaitStretch, ...], tuple[Pause, ...]]:
    """Lay out the path, the gaits and the stops of a trip."""

    def jog(from_m: float, to_m: float) -> RunningStretch:
        return RunningStretch(kind="jogging", from_m=from_m, to_m=to_m, speed_mps=jog_mps)

    match trip:
        case "gaits":
            run = RunningStretch(kind="running", from_m=330.0, to_m=390.0, speed_mps=run_mps)
            stops = tuple(Pause(at_m=at_m, duration_s=30.0) for at_m in (80.0, 240.0, 420.0))
            return PathParams(vertices_m=((0.0, 0.0), (470.0, 0.0))), (jog(100.0, 190.0), run), stops
        case "compound":
            return PathParams(vertices_m=_COMPOUND, corner_radius_m=2.0), (jog(140.0, 190.0), jog(430.0, 520.0)), ()
        case "building":
            return PathParams(vertices_m=_BUILDING), (), ()
        case "stairs":
            up = StairStretch(from_m=6.0, to_m=9.48, direction="up")
            down = StairStretch(from_m=26.0, to_m=29.48, direction="down")
            return PathParams(vertices_m=_FLOOR), (up, down, jog(36.0, 50.0)), ()
    raise ConfigError(f"no trip of UPTIME is called {trip!r}: there are gaits, compound, building and stairs")
