"""Scenario of a simulated walk: a path, a walker, and the devices that the walker carries."""

from dataclasses import asdict
from itertools import pairwise
from typing import Annotated

from annotated_types import Ge
from pydantic import TypeAdapter, ValidationError

from pdr_est.errors import ConfigError
from pdr_est.params import params
from pdr_est.simulate.carrying.held_phone import HeldPhone
from pdr_est.simulate.carrying.mode_changes import CarriedPhone, ModeChange, check_mode_changes
from pdr_est.simulate.riding.riding_body import Ride
from pdr_est.simulate.sensors.magnetic_field import EarthField, MagneticDipole
from pdr_est.simulate.sensors.sensor_errors import SensorParams
from pdr_est.simulate.walker.step_schedule import WalkerGaitParams
from pdr_est.simulate.walker.walking_body import BodyParams
from pdr_est.simulate.walker.walking_path import PathParams


@params
class DeviceParams:
    """Parameters of one simulated device."""

    name: str = "device"
    """Name of the device in the recording."""
    carry: CarriedPhone = HeldPhone()
    """Carrying model at the start of the walk."""
    changes: tuple[ModeChange, ...] = ()
    """Changes of the carrying mode, in order of time."""
    sensors: SensorParams = SensorParams()
    """Sensors and recorder of the device."""


@params
class Scenario:
    """Parameters of a simulated walk; the same scenario gives the same samples, bit by bit."""

    path: PathParams
    """Path of the walker."""
    name: str = "simulated"
    """Name of the recording."""
    gait: WalkerGaitParams = WalkerGaitParams()
    """Steps of the walker: cadence, length, variation, pauses."""
    body: BodyParams = BodyParams()
    """Motion of the walker's trunk."""
    devices: tuple[DeviceParams, ...] = (DeviceParams(),)
    """Devices that are carried, each with a name of its own."""
    rides: tuple[Ride, ...] = ()
    """Rides during pauses of the walk, in order of the pauses."""
    earth: EarthField = EarthField()
    """Magnetic field of the Earth, for devices that have a magnetometer."""
    irons: tuple[MagneticDipole, ...] = ()
    """Magnetised bodies beside the path, for devices that have a magnetometer."""
    seed: Annotated[int, Ge(0)] = 0
    """Seed of all random numbers of the walk."""


_ADAPTER = TypeAdapter(Scenario)


def check_scenario(scenario: Scenario) -> None:
    """Raise ConfigError if a value is out of its range or contradicts another one."""
    try:
        _ADAPTER.validate_python(asdict(scenario))
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(str(part) for part in first["loc"])
        raise ConfigError(f"scenario {place} = {first['input']!r}: {first['msg']}") from error
    names = [device.name for device in scenario.devices]
    if not names or len(set(names)) < len(names):
        raise ConfigError(f"scenario devices {names}: at least one, each with a name of its own")
    pauses = [ride.pause for ride in scenario.rides]
    if any(later <= earlier for earlier, later in pairwise(pauses)):
        raise ConfigError(f"scenario rides: pauses {pauses} must rise: one ride a pause, in their order")
    for device in scenario.devices:
        check_mode_changes(device.name, device.changes)
        for start_s, end_s in device.sensors.gaps_s:
            if not start_s < end_s:
                raise ConfigError(f"scenario device {device.name}: gap from {start_s} s to {end_s} s: swap the times")
