"""Frequency of each carrying mode in a walk."""

from dataclasses import dataclass

import numpy as np

from pdr_est.evaluate.carrying_modes import mode_shares
from pdr_est.pipeline import DeviceWalk
from pdr_est.types.steps import CarryingMode


@dataclass(frozen=True)
class ModeStatistics:
    """Frequency of one carrying mode of one device.

    Attributes
    ----------
    device : str
        Name of the device.
    mode : CarryingMode
        Carrying mode.
    steps : int
        Number of steps in this mode.
    walking_time_share : float
        Fraction of the time of all steps, 0 to 1; NaN if they took no time.
    mean_probability : float
        Mean probability that the recogniser gave to the mode, over its steps.
    """

    device: str
    mode: CarryingMode
    steps: int
    walking_time_share: float
    mean_probability: float


def mode_statistics(device: DeviceWalk) -> list[ModeStatistics]:
    """Count the modes that occur in the steps of a device, the most frequent first."""
    events = [step.event for step in device.steps]
    shares = mode_shares(device.steps)
    probability = np.array([event.mode_probability for event in events])
    mode = np.array([event.mode for event in events], dtype=np.int8)
    found = [
        ModeStatistics(
            device.device,
            CarryingMode(int(value)),
            int(of_mode.sum()),
            shares[CarryingMode(int(value))],
            float(probability[of_mode].mean()),
        )
        for value in np.unique(mode)
        for of_mode in [mode == value]
    ]
    return sorted(found, key=lambda use: -use.steps)
