"""What to simulate: a path, a walker, and the devices that the walker carries."""

from dataclasses import asdict
from typing import Annotated

from annotated_types import Ge
from pydantic import TypeAdapter, ValidationError

from pdr_est.errors import ConfigError
from pdr_est.params import params
from pdr_est.simulate.carrying.held import HeldPhone
from pdr_est.simulate.carrying.mode_changes import AnyPhone, ModeChange, check_changes
from pdr_est.simulate.sensors.errors import SensorParams
from pdr_est.simulate.sensors.magnetic_field import EarthField, Iron
from pdr_est.simulate.walker.path import PathParams
from pdr_est.simulate.walker.step_schedule import GaitParams
from pdr_est.simulate.walker.trunk import BodyParams


@params
class DeviceParams:
    """One device. carry: how it is carried at first; changes: to what the hand changes that, in order of time."""

    name: str = "device"
    carry: AnyPhone = HeldPhone()
    changes: tuple[ModeChange, ...] = ()
    sensors: SensorParams = SensorParams()


@params
class Scenario:
    """A walk to simulate. The same scenario gives the same walk, sample by sample; all randomness is from `seed`.

    earth, irons: the magnetic field, for devices that have a magnetometer.
    """

    path: PathParams
    name: str = "simulated"
    gait: GaitParams = GaitParams()
    body: BodyParams = BodyParams()
    devices: tuple[DeviceParams, ...] = (DeviceParams(),)
    earth: EarthField = EarthField()
    irons: tuple[Iron, ...] = ()
    seed: Annotated[int, Ge(0)] = 0


_ADAPTER = TypeAdapter(Scenario)


def check(scenario: Scenario) -> None:
    """Raise ConfigError if a value is out of its range."""
    try:
        _ADAPTER.validate_python(asdict(scenario))
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(str(part) for part in first["loc"])
        raise ConfigError(f"scenario {place} = {first['input']!r}: {first['msg']}") from error
    names = [device.name for device in scenario.devices]
    if not names or len(set(names)) < len(names):
        raise ConfigError(f"scenario devices {names}: at least one, each with a name of its own")
    for device in scenario.devices:
        check_changes(device.name, device.changes)
        for start_s, end_s in device.sensors.gaps_s:
            if not start_s < end_s:
                raise ConfigError(f"scenario device {device.name}: gap from {start_s} s to {end_s} s: swap the times")
