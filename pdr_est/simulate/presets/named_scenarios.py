"""Scenarios that are known by a name, for the demonstration and for experiment files."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from difflib import get_close_matches
from types import MappingProxyType

from pdr_est.errors import ConfigError
from pdr_est.simulate.presets.floors import walk_over_floors
from pdr_est.simulate.presets.mmpdr import mmpdr_indoor, park_348
from pdr_est.simulate.presets.riding import commute, riding_walk
from pdr_est.simulate.presets.uptime import uptime_trip
from pdr_est.simulate.riding.vehicles import bus, car, escalator, lift, train
from pdr_est.simulate.scenario import Scenario
from pdr_est.simulate.walker.step_schedule import Pause, WalkerGaitParams
from pdr_est.simulate.walker.walking_path import PathParams
from pdr_est.types.steps import CarryingMode

_RECTANGLE = ((0.0, 0.0), (24.0, 0.0), (24.0, 28.0), (-24.0, 28.0), (-24.0, 0.0), (0.0, 0.0))

PRESETS: Mapping[str, Callable[[], Scenario]] = MappingProxyType(
    {
        "office_loop": lambda: Scenario(
            name="office_loop",
            path=PathParams(vertices_m=_RECTANGLE),
            gait=WalkerGaitParams(pauses=(Pause(at_m=90.0, duration_s=6.0),)),
        ),
        "straight": lambda: Scenario(name="straight", path=PathParams(vertices_m=((0.0, 0.0), (80.0, 0.0)))),
        "l_shape": lambda: Scenario(
            name="l_shape", path=PathParams(vertices_m=((0.0, 0.0), (30.0, 0.0), (30.0, 20.0)))
        ),
        "mmpdr_indoor_holding": lambda: mmpdr_indoor(CarryingMode.HOLDING),
        "mmpdr_indoor_swing": lambda: mmpdr_indoor(CarryingMode.SWING),
        "mmpdr_indoor_pocket": lambda: mmpdr_indoor(CarryingMode.POCKET),
        "mmpdr_indoor_multi": lambda: replace(
            mmpdr_indoor(CarryingMode.HOLDING, CarryingMode.SWING, CarryingMode.HOLDING, CarryingMode.POCKET),
            name="mmpdr_indoor_multi",
        ),
        "park_348": park_348,
        "uptime_gaits": lambda: uptime_trip("gaits"),
        "uptime_compound": lambda: uptime_trip("compound"),
        "uptime_building": lambda: uptime_trip("building"),
        "uptime_stairs": lambda: uptime_trip("stairs"),
        "ride_bus": lambda: riding_walk(bus()),
        "ride_car": lambda: riding_walk(car(), posture="sitting", place="pocket"),
        "ride_train": lambda: riding_walk(train(), posture="sitting"),
        "ride_lift": lambda: riding_walk(lift()),
        "ride_escalator": lambda: riding_walk(escalator(), ride_s=40.0),
        "commute": commute,
        "floors": walk_over_floors,
    }
)
"""Functions that make the scenarios, by name; making one at the import would cost the validation of its records."""


def preset(name: str) -> Scenario:
    """Return the scenario of that name, one of PRESETS.

    Raises
    ------
    ConfigError
        For another name; the message suggests the nearest one.
    """
    if name not in PRESETS:
        near = get_close_matches(name, PRESETS, n=1)
        hint = f"did you mean {near[0]}?" if near else f"there are {', '.join(PRESETS)}"
        raise ConfigError(f"no simulated walk is called {name!r}: {hint}")
    return PRESETS[name]()
