"""A phone that a simulated person carries in given modes, one after the other."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from pdr_est.errors import ConfigError
from pdr_est.simulate.carrying.mode_changes import CarriedPhone
from pdr_est.simulate.people.person import SimulatedPerson
from pdr_est.simulate.scenario import DeviceParams
from pdr_est.simulate.sensors.sensor_errors import SensorParams
from pdr_est.types.steps import CarryingMode


def carried_device(
    person: SimulatedPerson,
    order: Sequence[CarryingMode],
    starts_s: Sequence[float],
    rng: np.random.Generator,
    sensors: SensorParams,
    name: str = "device",
) -> DeviceParams:
    """Make a device that a person carries in some modes, one after the other.

    Parameters
    ----------
    person : SimulatedPerson
        Person who carries it.
    order : sequence of CarryingMode
        Carrying modes (HOLDING, SWING, POCKET) in order of time.
    starts_s : sequence of float
        Start of the change to each mode after the first, s.
    rng : numpy.random.Generator
        Source of the differences between the mode changes.
    sensors : SensorParams
        Sensors of the device.
    name : str
        Name of the device.

    Raises
    ------
    ConfigError
        For a mode that is not simulated.
    """
    carries = [_carry(person, mode) for mode in order]
    changes = [
        person.change(before, carry, start_s, rng)
        for (before, carry), start_s in zip(pairwise(carries), starts_s, strict=True)
    ]
    return DeviceParams(name=name, carry=carries[0], changes=tuple(changes), sensors=sensors)


def _carry(person: SimulatedPerson, mode: CarryingMode) -> CarriedPhone:
    """Select the person's carrying model of a mode."""
    carries: dict[CarryingMode, CarriedPhone] = {
        CarryingMode.HOLDING: person.held,
        CarryingMode.SWING: person.swing,
        CarryingMode.POCKET: person.pocket,
    }
    if mode not in carries:
        raise ConfigError(f"carrying mode {mode!r} is not simulated: there are HOLDING, SWING and POCKET")
    return carries[mode]
